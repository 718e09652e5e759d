#include "tools/live/own_time.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <utility>

namespace hearsay::fleet {
namespace {

using namespace std::chrono_literals;
using remote::Order;
using remote::OrderKind;

constexpr auto patience = 100ms;  ///< the longest it sleeps
/// Rows that a report takes; more wait for the next.
constexpr std::size_t report_rows_max = 1000;

std::string own_partition(const AgentOptions& options) {
  return live::agent_partition(options.fleet.fleet, static_cast<std::uint32_t>(options.id));
}

std::string air_out_partition(const AgentOptions& options) {
  return options.direct ? live::air_partition(options.fleet.fleet)
                        : said_partition(options.fleet.fleet, options.id);
}

std::string air_in_partition(const AgentOptions& options) {
  return options.direct ? live::air_partition(options.fleet.fleet) : own_partition(options);
}

}  // namespace

OwnTime::OwnTime(std::shared_ptr<const PreparedScenario> prepared, const AgentOptions& options,
                 const live::Welcome& welcome, live::Port& port, Reactor& reactor,
                 live::Reader& orders, live::Writer& answers, remote::MemoryStore* memory)
    : prepared_(std::move(prepared)),
      options_(options),
      welcome_(welcome),
      reactor_(reactor),
      line_(orders, answers, reactor, options.id,
            [this](const Order& order) { look_around(order); }),
      memory_(memory),
      tongue_(tongue_of(*prepared_, options.id)),
      air_out_(port, air_out_partition(options)),
      air_in_(port, air_in_partition(options), tongues_of(*prepared_)),
      measurements_(port.reader(live::measurement_topic(), own_partition(options))),
      clock_(port.reader(live::clock_topic(), live::fleet_partition(options.fleet.fleet))),
      reports_(port.writer(live::report_topic(), own_partition(options))),
      begin_(WallClock::now()) {
  workspace_.measured_at.resize(prepared_->subjects.size());
  report_.agent = static_cast<std::uint32_t>(options.id);
}

OwnTime::~OwnTime() = default;

std::string OwnTime::serve(const Catalog& catalog,
                           const std::function<void(const std::string&)>& status) {
  const std::string gone = fmt::format("the world of fleet '{}' is gone", options_.fleet.fleet);
  WallTime next_status;
  while (!reactor_.stopped()) {
    while (clock_.take(bytes_)) {
      live::Clock clock;
      if (live::decode(bytes_, clock) && clock.state == live::Clock::State::running) {
        set_clock(clock.now_ns);
      }
    }
    const std::uint64_t asked = line_.asked();
    if (solo_) catch_up();
    if (!take_orders(catalog) || reactor_.stopped()) return {};
    if (solo_) {
      take_measurements();
      take_packets();
      if (line_.life_over()) continue;
      if (reactor_.stopped()) return {};
      if (solo_->simulation().failed()) return line_.gone() ? gone : failure();
      if (memory_) memory_->save(solo_->agent());
    }
    line_.tell();
    if (line_.gone()) return gone;
    // While it waited for answers other news may have come, of which nobody wakes it again.
    if (line_.asked() != asked) continue;
    if (WallClock::now() >= next_status) {
      next_status = WallClock::now() + 500ms;
      status(status_text());
    }
    WallTime until = WallClock::now() + patience;
    if (solo_ && solo_->simulation().next_time() <= prepared_->end) {
      const double left_s = (solo_->simulation().next_time() - now()).seconds();
      until = std::min(until, WallClock::now() + wall(std::max(left_s, 0.0) / welcome_.speed));
    }
    reactor_.wait(until);
  }
  return {};
}

// A clock that comes late makes the fleet's time seem earlier than it is: the earliest counts.
void OwnTime::set_clock(std::int64_t now_ns) {
  const double since_s = std::chrono::duration<double>(WallClock::now() - begin_).count();
  ahead_s_ = std::max(ahead_s_, static_cast<double>(now_ns) * 1e-9 - since_s * welcome_.speed);
}

Time OwnTime::now() {
  const double since_s = std::chrono::duration<double>(WallClock::now() - begin_).count();
  const double now_s = std::max(0.0, since_s * welcome_.speed + ahead_s_);
  const Time time = std::min(prepared_->end, Time::at(Duration::seconds(now_s)));
  return solo_ ? std::max(time, solo_->simulation().now()) : time;
}

void OwnTime::look_around(const Order& order) {
  if (order.surroundings.neighbours) neighbours_ = *order.surroundings.neighbours;
  around_ = order.surroundings;
}

bool OwnTime::take_orders(const Catalog& catalog) {
  Order order;
  while (line_.take(order)) {
    if (!obey(catalog, order)) return false;
  }
  return true;
}

void OwnTime::begin(const Catalog& catalog, const Order& order) {
  set_clock(order.now.nanoseconds());
  // Above those of the process that had its place before.
  number_ = std::max(number_, std::uint64_t{order.lives} << 32);
  RecordTap* const tap = this;
  // Who is there from the beginning misses nothing of it.
  began_ = order.lives == 0 ? order.now : now();
  const Solo::Options own{
      .id = options_.id, .seed = welcome_.seed, .now = began_, .tap = tap, .plans = nullptr};
  believer_ = nullptr;
  solo_.reset();
  set_out();
  try {
    remote::DistantWorld& world = *this;
    solo_ = std::make_unique<Solo>(prepared_, catalog, world, own);
  } catch (const remote::WorldGone&) {
    solo_.reset();  // it asked something before it began
    return;
  }
  // Not at once, but when it begins: catch_up() sees to the rest.
  try {
    remote::begin_life(solo_->agent(), memory_, order.lives);
  } catch (...) {
    solo_->simulation().fail(options_.id, std::current_exception());
  }
}

void OwnTime::set_out() {
  leg_.reset();
  motion_.reset();
  const bool moves = has_motion(prepared_->scenario) && !is_steered(*prepared_, options_.id);
  if (!moves) return;
  const auto i = static_cast<std::size_t>(options_.id);
  motion_ = make_motion(*prepared_->specs[i], prepared_->places[i], options_.id, welcome_.seed);
  leg_ = motion_->next();
}

bool OwnTime::obey(const Catalog& catalog, const Order& order) {
  if (order.kind == OrderKind::dismiss) return false;
  if (order.kind == OrderKind::start) {
    begin(catalog, order);
  } else if (solo_) {
    Agent& agent = solo_->agent();
    switch (order.kind) {
      case OrderKind::down:
        at_once([&agent] { agent.on_down(); });
        break;
      case OrderKind::up:
        at_once([&agent, &order] { agent.on_up(order.yes); });
        break;
      case OrderKind::report:
        report(false);
        break;
      case OrderKind::finish:
        at_once([&agent] { agent.finish(); });
        report(true);
        break;
      default:
        break;  // of lockstep, or news of its surroundings alone
    }
  }
  return true;
}

void OwnTime::at_once(const std::function<void()>& happening) {
  Simulation& simulation = solo_->simulation();
  catch_up();
  if (simulation.failed()) return;
  simulation.advance(std::min(now(), simulation.next_time()));
  try {
    happening();
  } catch (...) {
    simulation.fail(options_.id, std::current_exception());
  }
}

void OwnTime::catch_up() {
  Simulation& simulation = solo_->simulation();
  // Not for ever, where a step takes longer than the time that it is for.
  for (const Time at = now(); !simulation.failed() && simulation.next_time() <= at;) {
    const double late_s = (now() - simulation.next_time()).seconds() / welcome_.speed;
    if (late_s > deadline_s) ++missed_;
    simulation.happen();
  }
}

void OwnTime::take_measurements() {
  live::Measurement measured;
  while (measurements_.take(bytes_)) {
    if (!live::decode(bytes_, measured) || measured.agent != report_.agent) continue;
    const bool fits = solo_->receiver() && measured.subject < prepared_->subjects.size();
    if (!fits || !around_.up) continue;
    at_once([&] {
      solo_->receiver()->on_measurement({.subject = static_cast<int>(measured.subject),
                                         .information = measured.information,
                                         .index = measured.number});
    });
  }
}

void OwnTime::take_packets() {
  Parcel parcel;
  while (air_in_.take(parcel)) {
    if (!around_.up) continue;
    if (options_.direct) {
      if (parcel.envelope.sender == report_.agent) continue;
      const bool mine =
          parcel.envelope.receiver == live::everybody || parcel.envelope.receiver == report_.agent;
      if (!mine) continue;
    }
    std::uint64_t& last = heard_[options_.direct ? parcel.envelope.sender : live::everybody];
    if (parcel.envelope.number <= last) {
      ++old_;
      continue;
    }
    last = parcel.envelope.number;
    hear(parcel);
  }
}

void OwnTime::hear(const Parcel& parcel) {
  const Packet packet{.sender = static_cast<AgentId>(parcel.envelope.sender),
                      .receiver = options_.id,
                      .kind = solo_->simulation().record().name(parcel.kind),
                      .bytes = parcel.message,
                      .sent = Time::nanoseconds(parcel.envelope.sent_ns)};
  at_once([&] { solo_->agent().on_packet(packet); });
}

bool OwnTime::send(AgentId sender, const Outgoing& packet) {
  if (!around_.up) return false;
  Parcel parcel;
  parcel.envelope = {.sender = static_cast<std::uint32_t>(sender),
                     .receiver = packet.receiver == no_agent
                                     ? live::everybody
                                     : static_cast<std::uint32_t>(packet.receiver),
                     .number = ++number_,
                     .sent_ns = solo_->simulation().now().nanoseconds(),
                     .tick = packet.tick ? static_cast<std::int64_t>(*packet.tick) : -1,
                     .subject = packet.subject};
  parcel.kind = solo_->simulation().record().text(packet.kind);
  parcel.message.assign(packet.bytes.begin(), packet.bytes.end());
  line_.tell();  // what was noted comes first
  return air_out_.write(tongue_, parcel);
}

Point OwnTime::position(AgentId) const {
  if (leg_) {
    const Time now = solo_ ? solo_->simulation().now() : began_;
    while (motion_ && leg_->end <= now) leg_ = motion_->next();
    return leg_->at(std::min(now, leg_->end));
  }
  require(around_.position_m.has_value(), "radio: nobody knows where agents stand");
  return *around_.position_m;
}

void OwnTime::steer(AgentId, const Leg& leg) {
  leg_ = leg;
  Packer out = asking_.begin(remote::Question::steer);
  remote::put(out, leg);
  asking_.note();
}

std::span<const std::byte> OwnTime::ask(std::span<const std::byte> question) {
  return line_.ask(question).content;
}

// Nobody here knows the truth.
double OwnTime::distance_error_m(int, const gaussian::Belief&) {
  return std::numeric_limits<double>::quiet_NaN();
}

// By its own clock, which may be a little ahead of the world's.
std::int64_t OwnTime::stamp_now() {
  return prepared_->motion ? prepared_->motion->stamp_at(solo_->simulation().now()) : 0;
}

void OwnTime::report(bool last) {
  at_once([&] {
    if (solo_->reporter()) {
      Packer out(line_.report());
      solo_->reporter()->report(out);
      line_.tell();
    }
    if (!believer_) return;
    believer_->advance(stamp_now());
    report_.beliefs.clear();
    for (std::size_t s = 0; s < prepared_->subjects.size(); ++s) {
      report_.beliefs.push_back({.subject = static_cast<std::uint32_t>(s),
                                 .belief = believer_->tracked(static_cast<int>(s)).belief});
    }
    const EstimatorCounts& counts = believer_->counts();
    report_.counts = {.measurements = counts.measurements,
                      .fusions = counts.fusions,
                      .skipped = counts.skipped,
                      .refused = counts.refused + air_in_.dropped() + old_,
                      .late = counts.late,
                      .fusion_gain_max = counts.fusion_gain_max};
  });
  report_.now_ns = solo_->simulation().now().nanoseconds();
  report_.last = last;
  report_.missed = missed_;
  std::vector<live::Row> later;
  if (report_.rows.size() > report_rows_max && !last) {
    later.assign(report_.rows.begin() + report_rows_max, report_.rows.end());
    report_.rows.resize(report_rows_max);
  }
  live::encode(report_, bytes_);
  reports_.write(bytes_);
  report_.rows = std::move(later);
}

void OwnTime::on_scalar(const ScalarRow& row, Origin) {
  const Simulation& simulation = solo_->simulation();
  report_.rows.push_back({.kind = live::Row::Kind::scalar,
                          .now_ns = simulation.now().nanoseconds(),
                          .name = simulation.record().text(row.name),
                          .text = {},
                          .value = row.value});
}

void OwnTime::on_series(const SeriesRow& row, Origin) {
  const Record& record = static_cast<const Simulation&>(solo_->simulation()).record();
  report_.rows.push_back({.kind = live::Row::Kind::series,
                          .now_ns = row.time.nanoseconds(),
                          .name = record.text(row.name),
                          .text = record.text(row.subject),
                          .value = row.value});
}

void OwnTime::on_event(Time time, AgentId, std::string_view kind, std::string_view detail) {
  report_.rows.push_back({.kind = live::Row::Kind::event,
                          .now_ns = time.nanoseconds(),
                          .name = std::string(kind),
                          .text = std::string(detail)});
}

std::string OwnTime::failure() const {
  return solo_->simulation().end_now(EndReason::agent_failed).message;
}

std::string OwnTime::status_text() {
  if (!solo_) return "waits for the others";
  std::string text = fmt::format("{:.1f} s", now().seconds());
  if (believer_) {
    const EstimatorCounts& counts = believer_->counts();
    text += fmt::format(", {} measurements, {} fusions, {} refused", counts.measurements,
                        counts.fusions, counts.refused + air_in_.dropped() + old_);
  }
  if (missed_ > 0) text += fmt::format(", {} deadlines missed", missed_);
  return text;
}

}  // namespace hearsay::fleet
