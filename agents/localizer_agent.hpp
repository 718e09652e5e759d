// The localizer agent: a robot that keeps its own pose from odometry, landmarks it knows and
// companions it meets, with an extended Kalman filter, and tells companions where it thinks that it
// is and where it saw them.
//
// A message is a StampedGaussianMessage (filters/gaussian/codec.hpp) of one belief about a position
// (2-D) at its stamp; the subject is the agent whose position it is. Every tick the agent says one
// about itself now, and one about every companion it saw since the last tick, as of when it saw it.
// What it hears about itself it takes in as of then; what a companion says of itself it keeps until
// it sees it, and takes it for the less the older it is.
#pragma once

#include <optional>
#include <vector>

#include "agents/agent.hpp"
#include "agents/dead_reckoning.hpp"
#include "agents/journey.hpp"
#include "agents/pose_mind.hpp"
#include "agents/talk/periodic.hpp"
#include "filters/gaussian/codec.hpp"
#include "filters/localization/relative.hpp"

namespace hearsay {

class LocalizerAgent final : public Agent, public PoseMind {
 public:
  struct Options {
    localization::PoseFilter::Options filter;  ///< of one robot
    std::span<const Drive> drives;             ///< they outlive the agent, as do the next two
    std::span<const Encounter> encounters;
    std::span<const Eigen::Vector2d> landmarks;  ///< by number; those beyond are unknown to it
    double sigma_range_m = 0.15;                 ///< of encounters, > 0
    double sigma_bearing_rad = 0.08;             ///< > 0
    /// How a companion moves meanwhile: standard deviation an axis of its mean velocity, ≥ 0
    double companion_speed_m_per_s = 0.1;
    Duration memory;                             ///< > 0: how old may be what is told of it
    gaussian::Rule rule = gaussian::Rule::none;  ///< one that fuses by weight and keeps no memory
    std::optional<PeriodicTalk> talk;            ///< nothing: never talks
  };
  /// `account` outlives the agent.
  LocalizerAgent(Context& context, SightingAccount& account, Options options);

  void start() override;
  void on_packet(const Packet& packet) override;
  /// One that lost its memory forgets what companions said; where it is it still knows.
  void on_up(bool forgets) override;
  /// Leaves what it counted.
  void finish() override;

  std::optional<PoseBelief> own_pose() override;
  /// Up to the present.
  const localization::PoseFilter& filter();

 private:
  struct Companion {
    AgentId id;
    std::optional<localization::Place> seen;  // since the last talk
    Time seen_at;
    std::optional<localization::Place> said;  // of itself
    Time said_at;
    std::optional<Time> last_told;  // newest thing it said about this agent
  };
  struct Counts {
    std::uint64_t measurements = 0, fusions = 0, skipped = 0, outside_gate = 0, refused = 0,
                  late = 0;
  };

  Companion& companion(AgentId id);
  Process look();
  void meet(const Encounter& encounter);
  void meet_companion(const Encounter& encounter, const localization::RelativeSighting& seen);
  Process talk();
  void say(std::uint64_t tick, AgentId about, Time when, const localization::Place& place);
  void told_of_sender(Companion& from, Time when, const localization::Place& place);
  void told_of_self(Companion& from, Time when, const localization::Place& place);
  void count(localization::Taken taken);
  localization::Fusion fusion() const { return {options_.rule, options_.filter.gate}; }

  SightingAccount& account_;
  Options options_;
  localization::PoseFilter filter_;
  DeadReckoning reckoning_;
  Odometer odometer_;
  NameId message_kind_;
  std::vector<Companion> companions_;  // by number
  gaussian::StampedMessage message_;
  std::vector<std::byte> bytes_;
  std::uint32_t next_count_ = 1;
  Counts counts_;
};

}  // namespace hearsay
