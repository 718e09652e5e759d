#include "scenarios/motion.hpp"

#include <algorithm>
#include <cstddef>
#include <string>

#include "sim/kernel/error.hpp"
#include "sim/world/target_states.hpp"

namespace hearsay {
namespace {

using Place = std::optional<std::array<double, 2>>;

Duration seconds(const std::optional<double>& s) { return Duration::seconds(s.value_or(0.0)); }

motion::Rectangle area_of(const MotionSpec& spec) {
  const auto& a = spec.area_m.at(0);
  const auto& b = spec.area_m.at(1);
  return {{std::min(a[0], b[0]), std::min(a[1], b[1])},
          {std::max(a[0], b[0]), std::max(a[1], b[1])}};
}

motion::Repeat repeat_of(const std::string& name) {
  if (name == "loop") return motion::Repeat::loop;
  return name == "once" ? motion::Repeat::once : motion::Repeat::back_and_forth;
}

motion::Waypoints waypoints_of(const MotionSpec& spec, const Place& start_m) {
  return {.points_m = spec.points_m,
          .speed_m_per_s = spec.speed_m_per_s.value(),
          .pause = seconds(spec.pause_s),
          .repeat = repeat_of(spec.repeat.value_or("once")),
          .start_m = start_m,
          .altitude_m = spec.altitude_m};
}

motion::LawnMower lawn_mower_of(const MotionSpec& spec, const Place& start_m) {
  return {.area = area_of(spec),
          .lane_spacing_m = spec.lane_spacing_m.value(),
          .speed_m_per_s = spec.speed_m_per_s.value(),
          .repeat = repeat_of(spec.repeat.value_or("loop")),
          .start_m = start_m,
          .altitude_m = spec.altitude_m};
}

motion::RandomWaypoint random_waypoint_of(const MotionSpec& spec) {
  return {.area = area_of(spec),
          .speed_min_m_per_s = spec.speed_min_m_per_s.value(),
          .speed_max_m_per_s = spec.speed_max_m_per_s.value(),
          .pause_min = seconds(spec.pause_min_s),
          .pause_max = seconds(spec.pause_max_s),
          .altitude_m = spec.altitude_m};
}

motion::GaussMarkov gauss_markov_of(const MotionSpec& spec) {
  return {.area = area_of(spec),
          .speed_mean_m_per_s = spec.speed_mean_m_per_s.value(),
          .speed_sigma_m_per_s = spec.speed_sigma_m_per_s.value(),
          .direction_mean_rad = spec.direction_mean_rad,
          .direction_sigma_rad = spec.direction_sigma_rad.value(),
          .alpha = spec.alpha.value(),
          .update_period = Duration::seconds(spec.update_period_s.value_or(1.0)),
          .altitude_m = spec.altitude_m};
}

}  // namespace

bool has_motion(const Scenario& scenario) {
  return std::any_of(scenario.agents.begin(), scenario.agents.end(), [](const AgentSpec& agent) {
    return agent.motion.has_value() || agent.kind == "forager";
  });
}

namespace {

std::unique_ptr<Motion> motion_of(const MotionSpec& spec, const Place& place_m, AgentId id,
                                  std::uint64_t seed) {
  if (spec.kind == "waypoints") return motion::make(waypoints_of(spec, place_m));
  if (spec.kind == "lawn-mower") return motion::make(lawn_mower_of(spec, place_m));
  if (spec.kind == "random-waypoint") return motion::make(random_waypoint_of(spec), seed, id);
  if (spec.kind == "gauss-markov") return motion::make(gauss_markov_of(spec), seed, id);
  if (spec.kind == "track") {
    return motion::make(motion::Track{.samples = spec.tracks->at(static_cast<std::size_t>(id)),
                                      .altitude_m = spec.altitude_m});
  }
  if (!place_m) {
    throw InputError("agent " + std::to_string(id) + " hovers, but nobody knows where");
  }
  return motion::make(motion::Hover{.position_m = *place_m, .altitude_m = spec.altitude_m});
}

// Draws of a target's path: beside those of agents, which are numbered from 0 on.
AgentId drawn_as(int target) { return -2 - target; }

}  // namespace

std::unique_ptr<Motion> make_motion(const AgentSpec& agent, const Place& place_m, AgentId id,
                                    std::uint64_t seed) {
  return motion_of(agent.motion.value_or(MotionSpec{}), place_m, id, seed);
}

std::unique_ptr<Motion> make_motion(const TargetSpec& target, int number, std::uint64_t seed) {
  Place place_m;
  if (target.position_m) place_m = {target.position_m->at(0), target.position_m->at(1)};
  return motion_of(target.motion.value_or(MotionSpec{}), place_m, drawn_as(number), seed);
}

std::vector<std::vector<double>> target_states_of(const Scenario& scenario, Time end,
                                                  std::uint64_t seed) {
  const Duration period = Duration::seconds(scenario.world.step_s.value());
  const auto count =
      static_cast<std::size_t>(end.nanoseconds() / period.nanoseconds()) + std::size_t{1};
  std::vector<std::vector<double>> states;
  for (const TargetSpec& target : scenario.world.targets) {
    const auto number = static_cast<int>(states.size());
    if (!target.motion || target.motion->kind != "white-noise-acceleration") {
      states.push_back(target_states(*make_motion(target, number, seed), period, count));
      continue;
    }
    TargetState start{target.position_m->at(0), target.position_m->at(1), 0.0, 0.0};
    const auto& velocity = target.motion->velocity_m_per_s;
    if (velocity) std::copy_n(velocity->begin(), 2, start.begin() + 2);
    states.push_back(target_states(start, target.motion->acceleration_psd_m2_per_s3.value(), period,
                                   count, seed, number));
  }
  return states;
}

AgentPaths::AgentPaths(const Scenario& scenario, const std::vector<Place>& places_m,
                       std::uint64_t seed) {
  for (const AgentSpec& agent : scenario.agents) {
    for (int k = 0; k < agent.count; ++k) {
      const std::size_t i = motions_.size();
      // Of whom the file does not say where they are nobody asks it.
      Place place_m = places_m.at(i);
      if (!place_m && !agent.motion) place_m = {0.0, 0.0};
      motions_.push_back(make_motion(agent, place_m, static_cast<AgentId>(i), seed));
    }
  }
}

}  // namespace hearsay
