// The topics of a fleet: names, types and quality of service. What travels between two programs is
// in net/live/idl/{air,live}.idl.
//
//   hearsay_hello        Hello        agent → world    reliable, all kept
//   hearsay_welcome      Welcome      world → agents   the same
//   hearsay_order        Frame        world → agent    the same
//   hearsay_answer       Frame        agent → world    the same
//   hearsay_clock        Clock        world → agents   reliable, the last kept for who comes later
//   hearsay_measurement  Measurement  world → agent    as hello
//   hearsay_truth        Truth        world → whoever  the same
//   hearsay_report       Report       agent → world    the same
//   hearsay_air_…        packets      agent → agents   the same
//
// A packet's topic is named by its kind, as agents name it, '-' as '_'. What a kind's messages are
// made of depends on what beliefs are about, so that one name does not do for all of them:
//
//   hearsay_air_gaussian             GaussianPacket         of states that stand still
//   hearsay_air_gaussian_moving      StampedGaussianPacket  of states that move
//   hearsay_air_gaussian_trajectory  TrajectoryPacket       of states over a window of time
//   hearsay_air_gaussian_split, …    SplitPacket, …         and _moving (StampedSplitPacket, …)
//   hearsay_air_position             StampedGaussianPacket
//   hearsay_air_tracks, _trails      TrajectoryPacket
//   hearsay_air_grid_whole, _grid_changed, _grid_runs       by the form of the packet
//   hearsay_air_trail                TrailPacket
//   hearsay_air_acknowledgement      AcknowledgementPacket
//   hearsay_air_KIND                 OctetsPacket           any other kind
//
// A fleet is a DDS partition: "FLEET" (hello, welcome, clock, truth), "FLEET.3" (what is between
// the world and agent 3), "FLEET.3.said" (what agent 3 hands to the world's radio), "FLEET.air"
// (packets from agent to agent, without a world's radio).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hearsay::live {

/// The types that are topics of their own.
enum class Type : std::uint8_t {
  hello,
  welcome,
  frame,
  clock,
  measurement,
  truth,
  report,
  gaussian,
  split,
  consensus,
  hybrid,
  diagonal,
  quantised,
  stamped_gaussian,
  stamped_split,
  stamped_consensus,
  stamped_hybrid,
  stamped_diagonal,
  stamped_quantised,
  trajectory,
  whole_grid,
  changed_grid,
  grid_runs,
  trail,
  acknowledgement,
  octets,
};
inline constexpr int type_count = 26;

struct TopicId {
  Type type = Type::octets;
  std::string name;
  bool operator==(const TopicId&) const = default;
};

TopicId hello_topic();
TopicId welcome_topic();
TopicId order_topic();
TopicId answer_topic();
TopicId clock_topic();
TopicId measurement_topic();
TopicId truth_topic();
TopicId report_topic();

/// What beliefs are about; of kinds that begin with "gaussian" alone.
enum class States : std::uint8_t { still, moving, trajectory };

/// All topics that packets of a kind travel on: one, but for "grid". `kind`: not empty.
std::vector<TopicId> air_topics(std::string_view kind, States states);
/// The one of these for a message; `message`: as the kind's codec made it.
TopicId air_topic(std::string_view kind, States states, std::span<const std::byte> message);

/// 1 to 64 of: letters, digits, '-', '_'.
bool is_fleet_name(std::string_view name);

std::string fleet_partition(std::string_view fleet);
std::string agent_partition(std::string_view fleet, std::uint32_t agent);
std::string air_partition(std::string_view fleet);

}  // namespace hearsay::live
