// Cameras and range-bearing sensors in scenario files, and runs with them.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "scenarios/run.hpp"
#include "temp_files.hpp"

namespace hearsay {
namespace {

using Values = std::map<std::string, double>;

class SensorRun : public InTempDirectory {
 protected:
  static Scenario load(const std::string& text) {
    write("s.toml", text);
    return load_scenario("s.toml", {}, known_names(Catalog()));
  }
  static std::string error(const std::string& text) {
    return error_of([&] { load(text); });
  }
  /// Scalars of agent 0, and the last value of each series.
  static Values values(const std::string& text, std::uint64_t seed = 1) {
    LogCache logs;
    const Catalog catalog;
    hearsay::Run run(prepare(load(text), catalog, logs), catalog, {.seed = seed});
    const RunEnd end = run.run();
    EXPECT_TRUE(end.ok()) << end.message;
    Values found;
    const Record& record = run.record();
    for (const ScalarRow& row : record.scalars()) {
      if (row.agent == 0) found[record.text(row.name)] = row.value;
    }
    for (const SeriesRow& row : record.series()) {
      if (row.agent == 0) found[record.text(row.name)] = row.value;
    }
    return found;
  }
};

// 100 looks from 40 m high and 30 m off: 50 m far.
const std::string world =
    "duration_s = 99.5\nworld = { targets = [{ name = \"t\", position_m = [30, 0] }] }\n"
    "record = { series = [\"rms_error_m\", \"claimed_sigma_m\", \"nees\"] }\n"
    "[[agents]]\nposition_m = [0, 0]\n";
const std::string hover = "motion = { kind = \"hover\", altitude_m = 40 }\n";
const std::string camera = "sensor = { kind = \"camera\", sigma_position_m = 0.5";

TEST_F(SensorRun, ACameraFindsItsTargetAsWellAsItClaims) {
  const Values found = values(world + hover + camera + " }\n");
  EXPECT_EQ(found.at("measurements"), 100.0);
  EXPECT_EQ(found.at("looks_missed"), 0.0);
  // One look: √(σ_position² + (40σ_attitude/cos²θ)² + pixel …) along, with cos θ = 4/5 …
  const double along = found.at("look_sigma_along_m"), across = found.at("look_sigma_across_m");
  EXPECT_NEAR(along, std::sqrt(0.25 * (1 + 9.0 / 16) + std::pow(0.8 * 25 / 16, 2)), 0.05);
  EXPECT_NEAR(across, std::sqrt(0.25 + 1.0), 0.03);
  // … and a hundred of them: a tenth of that an axis.
  const double claimed = found.at("claimed_sigma_m");
  EXPECT_NEAR(claimed, 0.1 * std::sqrt((along * along + across * across) / 2), 0.1 * claimed);
  EXPECT_LT(found.at("rms_error_m"), 4 * claimed);
  EXPECT_GT(found.at("nees"), 0.0);
}

TEST_F(SensorRun, AReferenceChangesNothingButWhatItIsComparedWith) {
  const Values without = values(world + hover + camera + " }\n");
  const Values with = values(world + hover + camera + ", reference_draws = 500 }\n");
  EXPECT_TRUE(std::isnan(without.at("look_kl_nats")));
  EXPECT_GT(with.at("look_kl_nats"), 0.0);
  EXPECT_GT(with.at("look_variance_gap"), 0.0);
  for (const char* same : {"rms_error_m", "nees", "look_sigma_along_m", "distance_error_m"}) {
    EXPECT_EQ(with.at(same), without.at(same)) << same;
  }
}

TEST_F(SensorRun, EveryPropagationSeesTheSameNoise) {
  const double unscented = values(world + hover + camera + " }\n").at("rms_error_m");
  for (const char* other : {"linearised", "monte-carlo"}) {
    const Values found = values(world + hover + camera + ", propagation = \"" + other + "\" }\n");
    EXPECT_NEAR(found.at("rms_error_m"), unscented, 0.03) << other;  // a fifth of its σ
    EXPECT_NE(found.at("rms_error_m"), unscented) << other;
  }
}

TEST_F(SensorRun, PastTheHorizonACameraMeasuresNothing) {
  const Values found = values(
      "duration_s = 9.5\nworld = { targets = [{ name = \"t\", position_m = [1e6, 0] }] }\n"
      "[[agents]]\nposition_m = [0, 0]\n" +
      hover + camera + " }\n");
  EXPECT_EQ(found.at("measurements"), 0.0);
  EXPECT_EQ(found.at("looks_missed"), 10.0);
  EXPECT_TRUE(std::isnan(found.at("look_sigma_along_m")));
}

TEST_F(SensorRun, ACameraLooksFromWhereItsAgentIsNow) {
  // It flies over the target: along the view as sharp as across it, when just above.
  const Values found = values(
      "duration_s = 9.5\nworld = { targets = [{ name = \"t\", position_m = [0, 0] }] }\n"
      "[[agents]]\nposition_m = [-40, 0]\nmotion = { kind = \"waypoints\", altitude_m = 40, "
      "points_m = [[40, 0]], speed_m_per_s = 10 }\n"
      "sensor = { kind = \"camera\", start_s = 4, end_s = 4 }\n");
  EXPECT_EQ(found.at("measurements"), 1.0);
  EXPECT_NEAR(found.at("look_sigma_along_m") / found.at("look_sigma_across_m"), 1.0, 0.02);
}

TEST_F(SensorRun, RangesAndBearingsFindTheTargetAsWellAsTheyClaim) {
  const Values found =
      values(world +
             "sensor = { kind = \"range-bearing\", sigma_range_m = 0.3, sigma_bearing_rad = 0.01, "
             "sigma_heading_rad = 0.005, sigma_position_m = 0.1 }\n");
  EXPECT_EQ(found.at("measurements"), 100.0);
  // σ_range² along, 30²·(0.01² + 0.005²) across, σ_position² on both; a hundred of them.
  const double claimed = found.at("claimed_sigma_m");
  EXPECT_NEAR(claimed, 0.1 * std::sqrt((0.09 + 0.1125) / 2 + 0.01), 0.02 * claimed);
  EXPECT_LT(found.at("rms_error_m"), 4 * claimed);
}

TEST_F(SensorRun, WhatSensorsNeedToKnowIsAskedFor) {
  EXPECT_EQ(error(world + camera + " }\n"),
            "s.toml:6: agents[0].sensor.kind: \"camera\" needs to know how high over the ground "
            "(z = 0) the agent flies, as motion = { kind = \"hover\", altitude_m = 40 }");
  EXPECT_EQ(error("duration_s = 1\n[[agents]]\nsensor.kind = \"range-bearing\"\n"),
            "s.toml:3: agents[0].sensor.kind: \"range-bearing\" needs at least one target in "
            "world.targets");
  EXPECT_EQ(error("duration_s = 1\nworld = { targets = [{ position_m = [1, 2] }] }\n"
                  "[[agents]]\nsensor.kind = \"range-bearing\"\n"),
            "s.toml:4: agents[0].sensor.kind: \"range-bearing\" needs to know where the agent "
            "stands: position_m, circle or motion");
  EXPECT_NE(error(world + hover + camera + ", sigma_pixel = 0 }\n").find("sigma_pixel"),
            std::string::npos);
  EXPECT_NE(error(world + hover + camera + ", focal_px = [0, 1] }\n").find("focal_px"),
            std::string::npos);
  EXPECT_NE(error(world + hover + camera + ", kappa = -8 }\n").find("kappa"), std::string::npos);
  EXPECT_NE(error(world + hover + camera + ", draws = 1 }\n").find("draws"), std::string::npos);
  EXPECT_NE(error(world + hover + camera + ", propagation = \"unsented\" }\n")
                .find("did you mean 'unscented'"),
            std::string::npos);
}

}  // namespace
}  // namespace hearsay
