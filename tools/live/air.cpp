#include "tools/live/air.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "agents/trail_message.hpp"
#include "filters/gaussian/message_forms.hpp"
#include "filters/gaussian/trajectory_codec.hpp"
#include "filters/gaussian/trajectory_factor.hpp"
#include "filters/grid/codec.hpp"
#include "filters/trails/codec.hpp"
#include "scenarios/estimators.hpp"
#include "scenarios/explorers.hpp"

namespace hearsay::fleet {
namespace {

using gaussian::Belief;
using gaussian::Definiteness;
using gaussian::MessageForm;

/// The kind of what is known to those who say it alone.
constexpr const char* octets = "octets";

bool is_sound(const Belief& belief) {
  const Definiteness kind = gaussian::definiteness(belief);
  return belief.xi.allFinite() && belief.omega.allFinite() &&
         (kind == Definiteness::positive || kind == Definiteness::singular);
}

std::optional<MessageForm> form_named(std::string_view kind) {
  for (const MessageForm form :
       {MessageForm::plain, MessageForm::split, MessageForm::consensus, MessageForm::hybrid,
        MessageForm::diagonal, MessageForm::quantised}) {
    if (kind == message_kind(form)) return form;
  }
  return std::nullopt;
}

bool is_sound(MessageForm form, bool moving, std::span<const std::byte> bytes) {
  gaussian::StampedMessage message;
  gaussian::MessageExtras extras;
  const bool decoded = moving ? gaussian::decode(form, bytes, message, extras)
                              : gaussian::decode(form, bytes, message.message, extras);
  if (!decoded) return false;
  const auto sound = [](const Belief& belief) { return is_sound(belief); };
  // Rounding may leave a part that is hardly anything a little indefinite.
  const auto finite = [](const Belief& belief) {
    return belief.xi.allFinite() && belief.omega.allFinite();
  };
  const auto& beliefs = message.message.beliefs;
  return std::all_of(beliefs.begin(), beliefs.end(),
                     [&](const gaussian::BeliefEntry& entry) { return sound(entry.belief); }) &&
         std::all_of(extras.fresh.begin(), extras.fresh.end(), finite);
}

/// Of a whole trajectory, of which each step tells how it hangs together with the next, all blocks
/// as one matrix count.
bool is_sound_chain(const gaussian::TrajectoryEntry& entry) {
  const int n = entry.steps.front().information.dimension();
  gaussian::Trajectory trajectory(n, entry.steps.front().stamp);
  trajectory.update(0, entry.steps.front().information);
  for (std::size_t k = 1; k < entry.steps.size(); ++k) {
    const gaussian::TrajectoryStep& before = entry.steps[k - 1];
    const gaussian::TrajectoryStep& step = entry.steps[k];
    if (step.information.dimension() != n || before.next.rows() != n) return false;
    if (step.stamp <= before.stamp) return false;
    trajectory.append(step.stamp, before.next, step.information);
  }
  if (entry.steps.back().next.size() != 0) return false;
  const Definiteness kind = gaussian::TrajectoryFactor().factor(trajectory);
  return kind == Definiteness::positive || kind == Definiteness::singular;
}

bool is_sound_trails(std::span<const std::byte> bytes) {
  gaussian::TrajectoryMessage message;
  std::vector<tracking::Report> tracks;
  if (!gaussian::decode(bytes, message) || !take_tracks(message, tracks)) return false;
  return std::all_of(tracks.begin(), tracks.end(), [](const tracking::Report& track) {
    if (!is_sound(track.belief)) return false;
    if (!track.trail) return true;
    const Definiteness kind = gaussian::TrajectoryFactor().factor(*track.trail);
    return kind == Definiteness::positive || kind == Definiteness::singular;
  });
}

bool is_sound_trajectory(std::span<const std::byte> bytes) {
  gaussian::TrajectoryMessage message;
  if (!gaussian::decode(bytes, message)) return false;
  for (const gaussian::TrajectoryEntry& entry : message.trajectories) {
    for (const gaussian::TrajectoryStep& step : entry.steps) {
      if (!is_sound(step.information) || !step.next.allFinite()) return false;
    }
    const bool chained = std::any_of(entry.steps.begin(), entry.steps.end(),
                                     [](const auto& step) { return step.next.size() != 0; });
    if (chained && !is_sound_chain(entry)) return false;
  }
  return true;
}

}  // namespace

Tongue tongue_of(const PreparedScenario& prepared, AgentId id) {
  const AgentSpec& spec = *prepared.specs[static_cast<std::size_t>(id)];
  if (spec.kind == "forager") return {"trail", live::States::still};
  if (spec.kind == "localizer") return {"position", live::States::moving};
  if (spec.kind == "explorer") {
    return {.kind = "grid",
            .states = live::States::still,
            .cells = area_of(prepared.scenario.world).cells(),
            .layers = spec.grid.belief == "beta" ? std::size_t{2} : std::size_t{1}};
  }
  if (spec.kind == "tracker") {
    return {spec.tracker.trail_s ? "trails" : "tracks", live::States::moving};
  }
  if (spec.kind != "estimator") return {octets, live::States::still};
  if (spec.estimator.kind == "trajectory-gaussian") {
    return {message_kind(MessageForm::plain), live::States::trajectory};
  }
  return {message_kind(message_form_of(spec)),
          prepared.motion ? live::States::moving : live::States::still};
}

std::vector<Tongue> tongues_of(const PreparedScenario& prepared) {
  std::vector<Tongue> tongues;
  for (std::size_t i = 0; i < prepared.specs.size(); ++i) {
    tongues.push_back(tongue_of(prepared, static_cast<AgentId>(i)));
  }
  return tongues;
}

bool is_sound(const Tongue& tongue, std::span<const std::byte> message) {
  if (tongue.kind == "trail") return trails::MetricPacket::parse(message).has_value();
  if (tongue.kind == "trails") return is_sound_trails(message);
  if (tongue.kind == "grid") {
    return grid::Packet::parse(message, {tongue.cells, tongue.layers}).has_value();
  }
  if (tongue.kind == "tracks" || tongue.kind == "position") {
    return is_sound(MessageForm::plain, true, message);
  }
  const std::optional<MessageForm> form = form_named(tongue.kind);
  if (!form) return true;
  if (tongue.states == live::States::trajectory) return is_sound_trajectory(message);
  return is_sound(*form, tongue.states == live::States::moving, message);
}

std::string said_partition(const std::string& fleet, AgentId agent) {
  return live::agent_partition(fleet, static_cast<std::uint32_t>(agent)) + ".said";
}

AirOut::AirOut(live::Port& port, std::string partition)
    : port_(port), partition_(std::move(partition)) {}

bool AirOut::write(const Tongue& tongue, const Parcel& parcel) {
  const live::TopicId topic = live::air_topic(tongue.kind, tongue.states, parcel.message);
  auto found = writers_.find(topic.name);
  if (found == writers_.end()) {
    found = writers_.emplace(topic.name, port_.writer(topic, partition_)).first;
  }
  if (tongue.kind != octets) return found->second.write_packet(parcel.envelope, parcel.message);
  live::pack_octets(parcel.envelope, parcel.kind, parcel.message, bytes_);
  return found->second.write(bytes_);
}

AirIn::AirIn(live::Port& port, const std::string& partition, const std::vector<Tongue>& tongues) {
  for (const Tongue& tongue : std::set<Tongue>(tongues.begin(), tongues.end())) {
    for (const live::TopicId& topic : live::air_topics(tongue.kind, tongue.states)) {
      ears_.push_back({tongue, port.reader(topic, partition)});
    }
  }
}

bool AirIn::take(Parcel& parcel) {
  for (Ear& ear : ears_) {
    if (ear.tongue.kind == octets ? hear_octets(ear, parcel) : hear(ear, parcel)) return true;
  }
  return false;
}

bool AirIn::hear(Ear& ear, Parcel& parcel) {
  while (ear.reader.take_packet(parcel.envelope, parcel.message)) {
    parcel.kind = ear.tongue.kind;
    if (is_sound(ear.tongue, parcel.message)) return true;
    ++dropped_;
  }
  return false;
}

bool AirIn::hear_octets(Ear& ear, Parcel& parcel) {
  while (ear.reader.take(bytes_)) {
    std::span<const std::byte> message;
    if (live::unpack_octets(bytes_, parcel.envelope, parcel.kind, message)) {
      parcel.message.assign(message.begin(), message.end());
      return true;
    }
    ++dropped_;
  }
  return false;
}

std::uint64_t AirIn::dropped() const {
  std::uint64_t sum = dropped_;
  for (const Ear& ear : ears_) sum += ear.reader.malformed();
  return sum;
}

}  // namespace hearsay::fleet
