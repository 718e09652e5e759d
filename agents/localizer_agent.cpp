#include "agents/localizer_agent.hpp"

#include <algorithm>
#include <utility>

namespace hearsay {
namespace {

using localization::Place;
using localization::RelativeSighting;
using localization::Taken;

constexpr Duration reckoning_step = 50_ms;

Place position_of(const localization::PoseFilter& filter) {
  const localization::Pose& pose = filter.pose(0);
  return {{pose.x_m, pose.y_m}, filter.covariance(0).topLeftCorner<2, 2>()};
}

/// The position that a message is about; nothing unless it is one.
std::optional<Place> place_in(const gaussian::Belief& belief) {
  if (belief.dimension() != 2) return std::nullopt;
  const auto mean = gaussian::state(belief);
  const auto covariance = gaussian::covariance(belief);
  if (!mean || !covariance || !mean->allFinite()) return std::nullopt;
  return Place{mean->head<2>(), covariance->topLeftCorner<2, 2>()};
}

}  // namespace

LocalizerAgent::LocalizerAgent(Context& context, SightingAccount& account, Options options)
    : Agent(context),
      account_(account),
      options_(std::move(options)),
      filter_(options_.filter),
      reckoning_(options_.memory, reckoning_step),
      odometer_(options_.drives),
      message_kind_(context.simulation().record().name("position")) {}

std::optional<PoseBelief> LocalizerAgent::own_pose() {
  const localization::PoseFilter& own = filter();
  return PoseBelief{own.pose(0), own.covariance(0)};
}

const localization::PoseFilter& LocalizerAgent::filter() {
  odometer_.advance(context().now(), [this](Time until, double forward, double turn, double dt_s) {
    filter_.drive(0, forward, turn, dt_s);
    reckoning_.drive(until, forward, turn, dt_s);
  });
  return filter_;
}

void LocalizerAgent::start() {
  if (!options_.encounters.empty()) spawn(look());
  if (options_.talk && options_.rule != gaussian::Rule::none) spawn(talk());
}

LocalizerAgent::Companion& LocalizerAgent::companion(AgentId id) {
  const auto at =
      std::lower_bound(companions_.begin(), companions_.end(), id,
                       [](const Companion& c, AgentId wanted) { return c.id < wanted; });
  if (at != companions_.end() && at->id == id) return *at;
  return *companions_.insert(at, Companion{.id = id});
}

Process LocalizerAgent::look() {
  const Time begin = context().now();
  for (const Encounter& encounter : options_.encounters) {
    if (encounter.time < begin) continue;  // it was not there
    if (encounter.time > context().now()) {
      co_await context().sleep_until(encounter.time, Phase::measure);
    }
    if (context().up()) meet(encounter);
  }
}

void LocalizerAgent::meet(const Encounter& encounter) {
  const RelativeSighting seen{encounter.range_m, encounter.bearing_rad, options_.sigma_range_m,
                              options_.sigma_bearing_rad};
  filter();
  const auto subject = static_cast<std::size_t>(encounter.subject);
  if (encounter.companion) {
    meet_companion(encounter, seen);
  } else if (subject < options_.landmarks.size()) {
    ++counts_.measurements;
    account_.saw_place(context().id(), options_.landmarks[subject], seen);
    const localization::Use use = filter_.saw_place(0, options_.landmarks[subject], seen);
    if (use == localization::Use::outside_gate) ++counts_.outside_gate;
    if (use == localization::Use::no_direction) ++counts_.skipped;
  }
}

void LocalizerAgent::meet_companion(const Encounter& encounter, const RelativeSighting& seen) {
  ++counts_.measurements;
  account_.saw_robot(context().id(), encounter.subject, seen);
  if (options_.rule == gaussian::Rule::none) return;
  Companion& other = companion(encounter.subject);
  if (other.said) {
    const double age_s = (context().now() - other.said_at).seconds();
    const double moved_m = options_.companion_speed_m_per_s * age_s;
    Place place = *other.said;
    place.covariance += moved_m * moved_m * Eigen::Matrix2d::Identity();
    count(localization::take_sighting(filter_, fusion(), place, seen));
  }
  other.seen = localization::place_of(filter_.pose(0), filter_.covariance(0), seen);
  other.seen_at = context().now();
}

Process LocalizerAgent::talk() {
  for (std::uint64_t tick = options_.talk->next_tick(context().now());; ++tick) {
    co_await context().sleep_until(options_.talk->tick(tick));
    if (!context().up()) continue;
    say(tick, context().id(), context().now(), position_of(filter()));
    for (Companion& other : companions_) {
      if (other.seen) say(tick, other.id, other.seen_at, *other.seen);
      other.seen.reset();
    }
  }
}

void LocalizerAgent::say(std::uint64_t tick, AgentId about, Time when, const Place& place) {
  message_.stamp = when.nanoseconds();
  message_.message.incarnation = 0;
  message_.message.count = next_count_++;
  message_.message.beliefs.resize(1);
  gaussian::BeliefEntry& entry = message_.message.beliefs.front();
  entry.subject = static_cast<std::uint32_t>(about);
  entry.belief = gaussian::Belief::from_moments(place.mean, place.covariance);
  gaussian::encode(message_, bytes_);
  Outgoing packet;
  packet.kind = message_kind_;
  packet.bytes = bytes_;
  packet.tick = tick;
  // What was said before of the same one is old news.
  packet.subject = static_cast<std::uint64_t>(context().id()) << 32U | entry.subject;
  context().send(packet);
}

void LocalizerAgent::on_packet(const Packet& packet) {
  if (packet.kind != message_kind_ || options_.rule == gaussian::Rule::none) return;
  const bool whole =
      gaussian::decode(packet.bytes, message_) && message_.message.beliefs.size() == 1;
  const Time when = whole ? Time::nanoseconds(message_.stamp) : Time();
  const auto place =
      whole ? place_in(message_.message.beliefs.front().belief) : std::optional<Place>();
  if (!place || when < Time() || when > context().now()) {
    ++counts_.refused;
    return;
  }
  const auto about = static_cast<AgentId>(message_.message.beliefs.front().subject);
  Companion& from = companion(packet.sender);
  if (about == context().id()) {
    told_of_self(from, when, *place);
  } else if (about == packet.sender) {
    told_of_sender(from, when, *place);
  }
}

void LocalizerAgent::told_of_sender(Companion& from, Time when, const Place& place) {
  if (from.said && when <= from.said_at) {  // twice, or overtaken
    ++counts_.refused;
    return;
  }
  from.said = place;
  from.said_at = when;
}

void LocalizerAgent::told_of_self(Companion& from, Time when, const Place& place) {
  if (from.last_told && when <= *from.last_told) {  // twice, or overtaken
    ++counts_.refused;
    return;
  }
  from.last_told = when;
  filter();
  const auto behind = reckoning_.behind(when);
  if (!behind) {
    ++counts_.late;
    return;
  }
  count(localization::take_position(filter_, fusion(), place, *behind,
                                    (context().now() - when).seconds(), options_.filter.odometry));
}

void LocalizerAgent::on_up(bool forgets) {
  if (forgets) companions_.clear();
}

void LocalizerAgent::count(Taken taken) {
  if (taken == Taken::fused) ++counts_.fusions;
  if (taken == Taken::skipped) ++counts_.skipped;
  if (taken == Taken::outside_gate) ++counts_.outside_gate;
}

void LocalizerAgent::finish() {
  const auto leave = [&](const char* name, std::uint64_t value) {
    context().record_final(name, static_cast<double>(value));
  };
  leave("measurements", counts_.measurements);
  leave("fusions", counts_.fusions);
  leave("fusions_skipped", counts_.skipped);
  leave("outside_gate", counts_.outside_gate);
  leave("news_late", counts_.late);
  leave("messages_refused", counts_.refused);
}

}  // namespace hearsay
