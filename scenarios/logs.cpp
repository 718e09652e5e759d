#include "scenarios/logs.hpp"

#include <algorithm>
#include <string>

#include "scenarios/localizers.hpp"
#include "scenarios/sensors.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

bool believes_in_robots(const PreparedScenario& prepared) {
  return prepared.scenario.world.log->subjects == "robots";
}

mrclam::Odometry odometry_for(const Scenario& scenario) {
  return has_localizers(scenario) ? mrclam::Odometry::read : mrclam::Odometry::skip;
}

gaussian::Belief information_of(const mrclam::PoseSample& pose, double range_m, double bearing_rad,
                                const SensorSpec& spec) {
  const gaussian::PositionMeasurement measured = gaussian::range_bearing_to_position(
      {pose.x_m, pose.y_m, pose.heading_rad}, range_m, bearing_rad, range_bearing_noise_of(spec));
  const gaussian::Matrix identity = gaussian::Matrix::Identity(2, 2);
  return gaussian::measurement_information(identity, measured.S, measured.z);
}

constexpr double steps_max = 1e6;  // of a run

/// Sightings of landmarks that nobody believes in, or that the robot does not know.
std::size_t unused_landmarks(const mrclam::Robot& robot, const AgentSpec& spec, bool robots) {
  if (spec.kind != "localizer") return robots ? robot.sightings.size() : 0;
  const auto& known = spec.localizer.landmarks_known;
  return static_cast<std::size_t>(
      std::count_if(robot.sightings.begin(), robot.sightings.end(),
                    [&](const auto& seen) { return known && seen.landmark >= *known; }));
}

/// The robot whose truth ends first.
const mrclam::Robot& first_to_end(const mrclam::Dataset& log) {
  return *std::min_element(log.robots.begin(), log.robots.end(), [](const auto& a, const auto& b) {
    return a.truth.back().time < b.truth.back().time;
  });
}

/// @throws InputError unless every robot's truth is known at the start.
void require_truth(const PreparedScenario& prepared) {
  for (const mrclam::Robot& robot : prepared.log->robots) {
    if (mrclam::pose_at(robot.truth, Time())) continue;
    throw InputError(
        prepared.scenario.file, 0,
        "world.log.subjects = \"robots\" believes in robots from the start on, but the "
        "truth of robot " +
            std::to_string(robot.subject) + " is not known then");
  }
}

void set_end(PreparedScenario& prepared) {
  const Time span = Time::at(prepared.log->span);
  if (!believes_in_robots(prepared)) {
    if (!prepared.scenario.duration_s) prepared.end = span;
    return;
  }
  require_truth(prepared);
  const mrclam::Robot& first = first_to_end(*prepared.log);
  if (!prepared.scenario.duration_s) prepared.end = std::min(span, first.truth.back().time);
  if (prepared.end <= first.truth.back().time) return;
  throw InputError(prepared.scenario.file, 0,
                   "duration_s: with world.log.subjects = \"robots\" a run cannot go on beyond the "
                   "truth of a robot; that of robot " +
                       std::to_string(first.subject) + " ends after " +
                       std::to_string(first.truth.back().time.seconds()) + " s");
}

/// Position and velocity at stamps 0, 1, 2, …: of the velocity the mean over the second around.
std::vector<double> states_of(const mrclam::Robot& robot, Duration period, Time end) {
  const std::vector<mrclam::PoseSample>& truth = robot.truth;
  const auto at = [&](Time time) {
    return *mrclam::pose_at(truth, std::clamp(time, truth.front().time, truth.back().time));
  };
  std::vector<double> states;
  for (Time time; time <= end; time = time + period) {
    const mrclam::PoseSample here = at(time), before = at(time - 500_ms), after = at(time + 500_ms);
    const double span_s = (after.time - before.time).seconds();
    const double per_s = span_s > 0.0 ? 1.0 / span_s : 0.0;  // 0: the truth is a single instant
    states.insert(states.end(), {here.x_m, here.y_m, (after.x_m - before.x_m) * per_s,
                                 (after.y_m - before.y_m) * per_s});
  }
  return states;
}

void add_landmarks(PreparedScenario& prepared) {
  for (const mrclam::Landmark& landmark : prepared.log->landmarks) {
    prepared.subjects.push_back(
        {"landmark" + std::to_string(landmark.subject), {landmark.x_m, landmark.y_m}});
  }
  for (std::size_t i = 0; i < prepared.specs.size(); ++i) {
    for (const mrclam::Sighting& seen : prepared.log->robots[i].sightings) {
      prepared.observations[i].push_back(
          {.time = seen.time,
           .subject = seen.landmark,
           .information = information_of(seen.pose, seen.range_m, seen.bearing_rad,
                                         prepared.specs[i]->sensor)});
    }
  }
}

void add_robots(PreparedScenario& prepared) {
  const Duration period = Duration::seconds(prepared.scenario.world.step_s.value());
  if (prepared.end.seconds() / period.seconds() > steps_max) {
    throw InputError(prepared.scenario.file, 0,
                     "world.step_s: the run would have more than 1000000 steps");
  }
  for (const mrclam::Robot& robot : prepared.log->robots) {
    prepared.subjects.push_back(
        {"robot" + std::to_string(robot.subject), states_of(robot, period, prepared.end)});
  }
  for (std::size_t i = 0; i < prepared.specs.size(); ++i) {
    for (const mrclam::CompanionSighting& seen : prepared.log->robots[i].companions) {
      prepared.observations[i].push_back(
          {.time = seen.time,
           .subject = seen.robot,
           .information = information_of(seen.pose, seen.range_m, seen.bearing_rad,
                                         prepared.specs[i]->sensor)});
    }
  }
}

}  // namespace

std::shared_ptr<const mrclam::Dataset> LogCache::get(const std::string& directory, int robots,
                                                     Duration truth_gap_max,
                                                     mrclam::Odometry odometry) {
  const std::scoped_lock lock(mutex_);
  const std::string key = directory + "|" + std::to_string(robots) + "|" +
                          std::to_string(truth_gap_max.nanoseconds()) +
                          (odometry == mrclam::Odometry::read ? "|odometry" : "");
  std::shared_ptr<const mrclam::Dataset>& dataset = datasets_[key];
  if (!dataset) {
    dataset = std::make_shared<const mrclam::Dataset>(
        mrclam::load(directory, robots, truth_gap_max, odometry));
  }
  return dataset;
}

void prepare_log(PreparedScenario& prepared, LogCache& logs) {
  const LogSpec& spec = *prepared.scenario.world.log;
  prepared.log = logs.get(spec.directory, static_cast<int>(prepared.specs.size()),
                          Duration::seconds(spec.truth_gap_max_s), odometry_for(prepared.scenario));
  set_end(prepared);
  if (believes_in_robots(prepared)) {
    add_robots(prepared);
  } else {
    add_landmarks(prepared);
  }
  if (!has_localizers(prepared.scenario)) return;
  prepared.journeys =
      journeys_of(*prepared.log, Duration::seconds(prepared.scenario.record.series_period_s),
                  prepared.end, prepared.scenario.file);
  prepared.landmarks = landmarks_of(*prepared.log);
}

std::unique_ptr<PoseWitness> make_pose_witness(const PreparedScenario& prepared,
                                               Simulation& simulation) {
  // The central filter believes of odometry what the first localizer does.
  const auto first = std::find_if(prepared.specs.begin(), prepared.specs.end(),
                                  [](const AgentSpec* spec) { return spec->kind == "localizer"; });
  simulation.record().agent(central_agent, "central", "central");
  return std::make_unique<PoseWitness>(
      simulation,
      PoseWitness::Options{
          .names = prepared.names,
          .journeys = prepared.journeys,
          .central = pose_filter_options((*first)->localizer, prepared.journeys),
          .series = prepared.series,
          .series_period = Duration::seconds(prepared.scenario.record.series_period_s)});
}

void record_log(const PreparedScenario& prepared, Record& record) {
  const bool robots = believes_in_robots(prepared);
  for (std::size_t i = 0; i < prepared.specs.size(); ++i) {
    const mrclam::Robot& robot = prepared.log->robots[i];
    const bool both = prepared.specs[i]->kind == "localizer";
    const auto leave = [&](const char* name, std::uint64_t lines) {
      record.scalar(static_cast<AgentId>(i), record.name(name), static_cast<double>(lines));
    };
    leave("log_skipped_truth_gap", robot.skips.truth_gap);
    leave("log_skipped_unknown_barcode", robot.skips.unknown_barcode);
    leave("log_skipped_robot_sighting",
          robot.skips.robot_sighting + (robots || both ? 0 : robot.companions.size()));
    leave("log_skipped_landmark_sighting", unused_landmarks(robot, *prepared.specs[i], robots));
    leave("log_skipped_bad_range", robot.skips.bad_range);
  }
}

}  // namespace hearsay
