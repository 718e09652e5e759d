#include "agents/tracker_agent.hpp"

#include <algorithm>
#include <utility>

#include "agents/trail_message.hpp"

namespace hearsay {

TrackerAgent::TrackerAgent(Context& context, Options options)
    : Agent(context),
      options_(std::move(options)),
      tracker_(options_.tracker, 0),
      tracks_kind_(context.simulation().record().name("tracks")),
      trails_kind_(context.simulation().record().name("trails")) {}

void TrackerAgent::start() {
  if (options_.scanner) spawn(look());
  if (options_.talk && options_.tracker.rule != gaussian::Rule::none) spawn(talk());
}

Process TrackerAgent::look() {
  const Time start = options_.sensor_start;
  const Duration period = options_.sensor_period;
  for (std::uint64_t count = instants_before(context().now(), start, period);; ++count) {
    const Time next = start + period * static_cast<std::int64_t>(count);
    if (next > options_.sensor_end) co_return;
    co_await context().sleep_until(next, Phase::measure);
    if (context().up()) {
      options_.scanner->scan(count, plots_);
      tracker_.scan(context().now().nanoseconds(), plots_.plots, plots_.coverage);
    }
  }
}

Process TrackerAgent::talk() {
  for (std::uint64_t tick = options_.talk->next_tick(context().now());; ++tick) {
    co_await context().sleep_until(options_.talk->tick(tick));
    if (context().up()) say(tick);
  }
}

void TrackerAgent::say(std::uint64_t tick) {
  tracker_.predict_to(context().now().nanoseconds());
  const std::vector<tracking::Report> reports = tracker_.reports();
  if (reports.empty()) return;
  const bool trails = options_.tracker.trail > 0;
  trails ? tell_with_trails(reports) : tell(reports);
  Outgoing packet;
  packet.kind = trails ? trails_kind_ : tracks_kind_;
  packet.bytes = bytes_;
  packet.tick = tick;
  packet.subject = static_cast<std::uint64_t>(context().id());
  context().send(packet);
}

void TrackerAgent::tell(std::span<const tracking::Report> reports) {
  message_.stamp = tracker_.stamp();
  message_.message.beliefs.clear();
  for (const tracking::Report& report : reports) {
    message_.message.beliefs.push_back({report.label, report.belief});
  }
  message_.message.incarnation = incarnation_;
  message_.message.count = next_count_++;
  gaussian::encode(message_, bytes_);
}

void TrackerAgent::tell_with_trails(std::span<const tracking::Report> reports) {
  put_tracks(reports, tracker_.stamp(), trails_);
  trails_.incarnation = incarnation_;
  trails_.count = next_count_++;
  gaussian::encode(trails_, bytes_);
}

void TrackerAgent::on_packet(const Packet& packet) {
  if (packet.kind != tracks_kind_ && packet.kind != trails_kind_) return;
  const auto news = told(packet);
  if (!news || outdated(packet.sender, *news)) {
    ++refused_;
    return;
  }
  tracker_.predict_to(context().now().nanoseconds());
  const bool used =
      tracker_.heard(static_cast<std::uint32_t>(packet.sender), news->stamp, reports_);
  refused_ += used ? 0 : 1;
}

std::optional<TrackerAgent::Told> TrackerAgent::told(const Packet& packet) {
  if (packet.kind == trails_kind_) {
    if (!gaussian::decode(packet.bytes, trails_)) return std::nullopt;
    const auto stamp = take_tracks(trails_, reports_);
    if (!stamp) return std::nullopt;
    return Told{trails_.incarnation, trails_.count, *stamp};
  }
  if (!gaussian::decode(packet.bytes, message_)) return std::nullopt;
  reports_.clear();
  for (const gaussian::BeliefEntry& entry : message_.message.beliefs) {
    reports_.push_back({entry.subject, entry.belief, std::nullopt});
  }
  return Told{message_.message.incarnation, message_.message.count, message_.stamp};
}

bool TrackerAgent::outdated(AgentId from, const Told& told) {
  const auto known = std::find_if(heard_.begin(), heard_.end(),
                                  [&](const Heard& heard) { return heard.from == from; });
  if (known == heard_.end()) {
    heard_.push_back({from, told.incarnation, told.count});
    return false;
  }
  const auto order = std::pair(told.incarnation, told.count);
  if (order <= std::pair(known->incarnation, known->count)) return true;
  if (told.incarnation != known->incarnation) {
    tracker_.forget(static_cast<std::uint32_t>(from));
  }
  *known = {from, told.incarnation, told.count};
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
