#include "scenarios/trackers.hpp"

#include <algorithm>
#include <limits>

#include "scenarios/motion.hpp"
#include "scenarios/run.hpp"
#include "scenarios/talk.hpp"

namespace hearsay {

bool has_trackers(const Scenario& scenario) {
  return std::any_of(scenario.agents.begin(), scenario.agents.end(),
                     [](const AgentSpec& agent) { return agent.kind == "tracker"; });
}

std::vector<TargetTruth> target_truths_of(const Scenario& scenario, Time end, std::uint64_t seed) {
  std::vector<TargetTruth> truths;
  for (const TargetSpec& target : scenario.world.targets) {
    TargetTruth truth{target.name, {}, Duration()};
    if (!scenario.world.step_s) {
      const std::vector<double>& place_m = target.position_m.value();
      truth.positions_m.push_back({place_m.at(0), place_m.at(1)});
    }
    truths.push_back(std::move(truth));
  }
  if (!scenario.world.step_s) return truths;
  const auto states = target_states_of(scenario, end, seed);
  for (std::size_t i = 0; i < truths.size(); ++i) {
    truths[i].period = Duration::seconds(*scenario.world.step_s);
    for (std::size_t k = 0; k + 3 < states[i].size(); k += 4) {
      truths[i].positions_m.push_back({states[i][k], states[i][k + 1]});
    }
  }
  return truths;
}

std::unique_ptr<TrackWitness> make_track_witness(const Scenario& scenario, Simulation& simulation,
                                                 const std::vector<TargetTruth>& targets) {
  const RecordSpec& record = scenario.record;
  const auto wanted = [&](const char* name) {
    return std::find(record.series.begin(), record.series.end(), name) != record.series.end();
  };
  return std::make_unique<TrackWitness>(
      simulation,
      TrackWitness::Options{.targets = targets,
                            .score = {.p = record.tracks.order, .cutoff_m = record.tracks.cutoff_m},
                            .period = Duration::seconds(record.series_period_s),
                            .gospa_m = wanted("gospa_m"),
                            .ospa_m = wanted("ospa_m"),
                            .missed_targets = wanted("missed_targets"),
                            .false_tracks = wanted("false_tracks"),
                            .double_tracks = wanted("double_tracks")});
}

std::optional<ScanSensor::Options> scan_sensor_of(const AgentSpec& spec) {
  const SensorSpec& sensor = spec.sensor;
  if (sensor.kind != "scan") return std::nullopt;
  return ScanSensor::Options{
      .sigma_along_m = sensor.sigma_m ? *sensor.sigma_m : sensor.sigma_along_m.value(),
      .sigma_across_m = sensor.sigma_m ? *sensor.sigma_m : sensor.sigma_across_m.value(),
      .range_max_m = sensor.range_max_m.value_or(std::numeric_limits<double>::infinity()),
      .detection_probability = sensor.detection_probability.value_or(1.0),
      .false_alarms_per_km2 = sensor.false_alarms_per_km2.value_or(0.0)};
}

TrackerAgent::Options tracker_options(const PreparedScenario& prepared, AgentId id,
                                      std::uint64_t seed, PlotSource* scanner) {
  const AgentSpec& spec = *prepared.specs[static_cast<std::size_t>(id)];
  const TrackerSpec& tracker = spec.tracker;
  TrackerAgent::Options options;
  options.tracker = {
      .q = tracker.acceleration_psd_m2_per_s3.value_or(0.0),
      .birth_speed_sigma = tracker.birth_speed_sigma_m_per_s,
      .gate = tracker.gate,
      .pairing = tracker.association == "optimal" ? tracking::Pairing::optimal
                                                  : tracking::Pairing::nearest,
      .confirm_hits = tracker.confirm_hits,
      .confirm_scans = tracker.confirm_scans,
      .misses_max = tracker.misses_max,
      .sigma_max = tracker.sigma_max_m,
      .tracks_max = tracker.tracks_max,
      .rule = gaussian::rule_by_name(tracker.fusion).value(),
      .apart_max = tracker.apart_max,
      .trail = tracker.trail_s ? Duration::seconds(*tracker.trail_s).nanoseconds() : 0,
  };
  if (spec.talk.policy == "periodic") options.talk = talk_of(prepared, id, seed);
  const SensorSpec& sensor = spec.sensor;
  if (!scanner) return options;
  options.scanner = scanner;
  options.sensor_period = Duration::seconds(sensor.period_s);
  options.sensor_start = Time::at(Duration::seconds(sensor.start_s));
  if (sensor.end_s) options.sensor_end = Time::at(Duration::seconds(*sensor.end_s));
  return options;
}

}  // namespace hearsay
