#include "agents/tracker_agent.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace hearsay {

TrackerAgent::TrackerAgent(Context& context, Options options)
    : Agent(context),
      options_(std::move(options)),
      tracker_(options_.tracker, 0),
      message_kind_(context.simulation().record().name("tracks")) {}

void TrackerAgent::start() {
  if (options_.sensor) spawn(look());
  if (options_.talk && options_.tracker.rule != gaussian::Rule::none) spawn(talk());
}

Process TrackerAgent::look() {
  Time next = options_.sensor_start;
  for (std::uint64_t count = 0; next <= options_.sensor_end; ++count) {
    co_await context().sleep_until(next, Phase::measure);
    if (context().up()) scan(count);
    next = next + options_.sensor_period;
  }
}

void TrackerAgent::scan(std::uint64_t count) {
  const ScanSensor& sensor = *options_.sensor;
  std::array<double, 2> place_m{0.0, 0.0};
  tracking::Coverage coverage;
  if (sensor.has_place()) {
    const Point here = context().position();
    place_m = {here[0], here[1]};
    coverage.centre = gaussian::Vector(2);
    coverage.centre << place_m[0], place_m[1];
    coverage.range = sensor.options().range_max_m;
  }
  std::vector<std::array<double, 2>> targets_m;
  for (const TargetTruth& target : options_.targets)
    targets_m.push_back(target.at(context().now()));
  const auto plots =
      sensor.scan(place_m, targets_m, context().simulation().seed(), context().id(), count);
  tracker_.scan(context().now().nanoseconds(), plots, coverage);
}

Process TrackerAgent::talk() {
  for (std::uint64_t tick = 0;; ++tick) {
    const Time when = options_.talk->tick(tick);
    co_await context().sleep_until(when);
    if (context().up()) say(tick);
  }
}

void TrackerAgent::say(std::uint64_t tick) {
  tracker_.predict_to(context().now().nanoseconds());
  message_.stamp = tracker_.stamp();
  message_.message.beliefs.clear();
  for (const tracking::Report& report : tracker_.reports()) {
    message_.message.beliefs.push_back({report.label, report.belief});
  }
  if (message_.message.beliefs.empty()) return;
  message_.message.incarnation = incarnation_;
  message_.message.count = next_count_++;
  gaussian::encode(message_, bytes_);
  Outgoing packet;
  packet.kind = message_kind_;
  packet.bytes = bytes_;
  packet.tick = tick;
  packet.subject = static_cast<std::uint64_t>(context().id());
  context().send(packet);
}

void TrackerAgent::on_packet(const Packet& packet) {
  if (packet.kind != message_kind_) return;
  gaussian::StampedMessage& message = message_;
  if (!gaussian::decode(packet.bytes, message) || outdated(packet.sender, message.message)) {
    ++refused_;
    return;
  }
  reports_.clear();
  for (const gaussian::BeliefEntry& entry : message.message.beliefs) {
    reports_.push_back({entry.subject, entry.belief});
  }
  tracker_.predict_to(context().now().nanoseconds());
  const bool used =
      tracker_.heard(static_cast<std::uint32_t>(packet.sender), message.stamp, reports_);
  refused_ += used ? 0 : 1;
}

bool TrackerAgent::outdated(AgentId from, const gaussian::Message& message) {
  const auto known = std::find_if(heard_.begin(), heard_.end(),
                                  [&](const Heard& heard) { return heard.from == from; });
  if (known == heard_.end()) {
    heard_.push_back({from, message.incarnation, message.count});
    return false;
  }
  const auto order = std::pair(message.incarnation, message.count);
  if (order <= std::pair(known->incarnation, known->count)) return true;
  if (message.incarnation != known->incarnation) {
    tracker_.forget(static_cast<std::uint32_t>(from));
  }
  *known = {from, message.incarnation, message.count};
  return false;
}

void TrackerAgent::on_up(bool forgets) {
  if (!forgets) return;
  before_ += tracker_.counts();
  tracker_ = tracking::Tracker(options_.tracker, context().now().nanoseconds());
  heard_.clear();
  ++incarnation_;
  next_count_ = 1;
}

void TrackerAgent::finish() {
  tracking::Tracker::Counts counts = before_;
  counts += tracker_.counts();
  const auto leave = [&](const char* name, std::uint64_t value) {
    context().record_final(name, static_cast<double>(value));
  };
  leave("plots", counts.plots);
  leave("tracks_born", counts.born);
  leave("tracks_of_hearsay", counts.born_of_hearsay);
  leave("tracks_confirmed", counts.confirmed);
  leave("tracks_ended", counts.ended_missed + counts.ended_uncertain);
  leave("tracks_not_begun", counts.no_room);
  leave("tracks_apart", counts.apart);
  leave("tracks_buried", counts.buried);
  leave("fusions", counts.fusions);
  leave("fusions_skipped", counts.skipped + counts.refused);
  leave("messages_refused", refused_);
}

}  // namespace hearsay
