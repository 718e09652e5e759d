#include "scenarios/localizers.hpp"

#include <algorithm>

#include "scenarios/run.hpp"
#include "scenarios/talk.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr std::int64_t samples_max = 1'000'000;

localization::Pose pose_of(const mrclam::PoseSample& sample) {
  return {sample.x_m, sample.y_m, sample.heading_rad};
}

std::vector<Encounter> encounters_of(const mrclam::Robot& robot) {
  std::vector<Encounter> all;
  for (const mrclam::Sighting& seen : robot.sightings) {
    all.push_back({seen.time, false, seen.landmark, seen.range_m, seen.bearing_rad});
  }
  for (const mrclam::CompanionSighting& seen : robot.companions) {
    all.push_back({seen.time, true, seen.robot, seen.range_m, seen.bearing_rad});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Encounter& a, const Encounter& b) { return a.time < b.time; });
  return all;
}

std::vector<TruePose> truth_of(const mrclam::Robot& robot, Duration period, Time end) {
  std::vector<TruePose> truth;
  const auto add = [&](Time time) {
    const auto pose = mrclam::pose_at(robot.truth, time);
    if (pose) truth.push_back({time, pose_of(*pose)});
  };
  Time time;
  for (; time <= end; time = time + period) add(time);
  if (time - period != end) add(end);
  return truth;
}

}  // namespace

bool has_localizers(const Scenario& scenario) {
  return std::any_of(scenario.agents.begin(), scenario.agents.end(),
                     [](const AgentSpec& agent) { return agent.kind == "localizer"; });
}

std::vector<Journey> journeys_of(const mrclam::Dataset& log, Duration period, Time end,
                                 const std::string& file) {
  if (end.since_start() / period > samples_max) {
    throw InputError(file, 0, "record.series_period_s: more than 1000000 samples are not taken");
  }
  std::vector<Journey> journeys;
  for (const mrclam::Robot& robot : log.robots) {
    Journey journey;
    const auto start = mrclam::pose_at(robot.truth, Time());
    if (!start) {
      throw InputError(file, 0,
                       "a localizer begins where it truly is, but the truth of robot " +
                           std::to_string(robot.subject) + " is not known at the start");
    }
    journey.start = pose_of(*start);
    for (const mrclam::OdometrySample& sample : robot.odometry) {
      journey.drives.push_back({sample.time, sample.forward_m_per_s, sample.turn_rad_per_s});
    }
    journey.encounters = encounters_of(robot);
    journey.truth = truth_of(robot, period, end);
    journeys.push_back(std::move(journey));
  }
  return journeys;
}

std::vector<Eigen::Vector2d> landmarks_of(const mrclam::Dataset& log) {
  std::vector<Eigen::Vector2d> landmarks;
  for (const mrclam::Landmark& landmark : log.landmarks) {
    landmarks.emplace_back(landmark.x_m, landmark.y_m);
  }
  return landmarks;
}

localization::PoseFilter::Options pose_filter_options(const LocalizerSpec& spec,
                                                      std::span<const Journey> journeys) {
  localization::PoseFilter::Options options{
      .start = {},
      .start_sigma_m = spec.start_sigma_m,
      .start_sigma_rad = spec.start_sigma_rad,
      .odometry = {.forward_m_per_sqrt_s = spec.forward_m_per_sqrt_s,
                   .sideways_m_per_sqrt_s = spec.sideways_m_per_sqrt_s,
                   .turn_rad_per_sqrt_s = spec.turn_rad_per_sqrt_s},
      .gate = spec.gate};
  for (const Journey& journey : journeys) options.start.push_back(journey.start);
  return options;
}

LocalizerAgent::Options localizer_options(const PreparedScenario& prepared, AgentId id,
                                          std::uint64_t seed) {
  const auto i = static_cast<std::size_t>(id);
  const AgentSpec& spec = *prepared.specs[i];
  const Journey& journey = prepared.journeys[i];
  const std::span<const Eigen::Vector2d> landmarks = prepared.landmarks;
  const LocalizerSpec& localizer = spec.localizer;
  const auto known = static_cast<std::size_t>(
      localizer.landmarks_known.value_or(static_cast<int>(landmarks.size())));
  std::optional<PeriodicTalk> talk;
  if (spec.talk.policy == "periodic") talk = talk_of(prepared, id, seed);
  return {.filter = pose_filter_options(localizer, std::span(&journey, 1)),
          .drives = journey.drives,
          .encounters = journey.encounters,
          .landmarks = landmarks.first(std::min(known, landmarks.size())),
          .sigma_range_m = spec.sensor.sigma_range_m,
          .sigma_bearing_rad = spec.sensor.sigma_bearing_rad,
          .companion_speed_m_per_s = localizer.companion_speed_m_per_s,
          .memory = Duration::seconds(localizer.memory_s),
          .rule = gaussian::rule_by_name(localizer.fusion).value(),
          .talk = talk};
}

}  // namespace hearsay
