// Parameters of published systems, as data: what each says, and what it leaves open.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace hearsay::trails {

/// When crumbs are told, and where they lead (laying.hpp).
enum class Laying : std::uint8_t {
  at_once,    ///< ReturnTrail: crumb by crumb, back to the last event
  completed,  ///< TemporaryTrail: at an event, to it
};
/// What d counts.
enum class Distance : std::uint8_t { time, steps_without_turns };
/// Where positions come from.
enum class Frame : std::uint8_t { odometry, views, true_positions };
/// How far the chance of a random move falls.
enum class Fading : std::uint8_t { per_iteration, per_success };

/// How crumbs are found among views (Shamshirdar 2019, section 4.2.5). Similarities are cosines.
struct ViewSearch {
  int nearest = 10;                            ///< N: crumbs looked at in each trail
  double similarity_min = 0.0;                 ///< of these
  std::optional<double> again_similarity_min;  ///< of crumbs matched before; else all are searched
  double ahead_similarity_min = 0.0;           ///< of the crumbs that follow
  int ahead_max = 0;                           ///< how many of them
};
/// Local search: now and then a random move instead of the crumb's.
struct LocalSearch {
  double random_chance = 0.0;  ///< at first
  double falls_by = 0.0;
  Fading fading = Fading::per_iteration;
};

/// Nothing where the source says nothing.
struct ParameterSet {
  std::string_view name;
  std::string_view source;
  Frame frame = Frame::odometry;
  Laying laying = Laying::at_once;
  Distance distance = Distance::time;
  std::optional<double> sense_radius_m;   ///< r
  std::optional<double> interval_s;       ///< S; nothing: a crumb a step
  std::optional<std::size_t> crumbs_max;  ///< L of a temporary trail
  std::optional<double> age_max_s;        ///< a
  std::optional<int> life_arrivals;       ///< instead of an age
  std::optional<double> speed_mps;        ///< cruising
  std::optional<double> event_radius_m;   ///< an event is told within
  std::optional<double>
      trail_end;  ///< d ≤ this, in its unit: leave the trail, search for the event
  std::optional<double> goal_similarity;  ///< views: the goal is reached
  std::optional<ViewSearch> views;
  std::optional<LocalSearch> local_search;
};

/// By name; "lost-2002", "thesis-2019-text", "thesis-2019-code".
std::span<const ParameterSet> parameter_sets();
/// Nothing for a name that is not there.
const ParameterSet* parameter_set(std::string_view name);

}  // namespace hearsay::trails
