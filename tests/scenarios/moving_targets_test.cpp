// Whole runs about targets that move, and what their files may say.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <string>

#include "filters/gaussian/transition.hpp"
#include "scenarios/run.hpp"
#include "scenarios/targets.hpp"
#include "sim/kernel/error.hpp"
#include "tests/scenarios/temp_files.hpp"

namespace hearsay {
namespace {

const std::string scenario = R"(duration_s = 12
[world]
step_s = 0.5
[[world.targets]]
name = "object"
position_m = [5, -3]
[world.targets.motion]
kind = "white-noise-acceleration"
velocity_m_per_s = [2, 1]
acceleration_psd_m2_per_s3 = 0.4
[radio]
topology = "ring"
latency_s = 0.7
[record]
series = ["rms_error_m", "nees", "claimed_sigma_m", "true_sigma_m", "ledger_nees",
          "ledger_anees", "kl_to_central_nats"]
series_period_s = 12
[[agents]]
count = 3
position_m = [0, 0]
sensor = { kind = "position", period_s = 1, sigma_m = 2 }
estimator = { kind = "moving-gaussian", fusion = "RULE", acceleration_psd_m2_per_s3 = 0.4 }
talk = { period_s = 2 }
)";

class MovingTargets : public InTempDirectory {
 protected:
  std::shared_ptr<const PreparedScenario> prepared(const std::string& text) {
    write("s.toml", text);
    return prepare(load_scenario("s.toml", {}, known_names(catalog_)), catalog_, logs_);
  }
  std::shared_ptr<const PreparedScenario> with_rule(const std::string& rule) {
    std::string text = scenario;
    return prepared(text.replace(text.find("RULE"), 4, rule));
  }
  // Last values of the series of an agent.
  std::map<std::string, double> last(const std::shared_ptr<const PreparedScenario>& what,
                                     std::uint64_t seed, AgentId agent) {
    hearsay::Run run(what, catalog_, {.seed = seed});
    const RunEnd end = run.run();
    EXPECT_TRUE(end.ok()) << end.message;
    std::map<std::string, double> values;
    for (const SeriesRow& row : run.record().series()) {
      if (row.agent == agent) values[std::string(run.record().text(row.name))] = row.value;
    }
    return values;
  }
  // Sums of the scalars of a run over its agents.
  std::map<std::string, double> sums(const std::shared_ptr<const PreparedScenario>& what) {
    hearsay::Run run(what, catalog_, {.seed = 7});
    const RunEnd end = run.run();
    EXPECT_TRUE(end.ok()) << end.message;
    std::map<std::string, double> sums;
    for (const ScalarRow& row : run.record().scalars()) {
      if (row.agent >= 0) sums[std::string(run.record().text(row.name))] += row.value;
    }
    return sums;
  }
  // Three agents under ci-det with 61 periods of talk each, who look until 12 s.
  std::shared_ptr<const PreparedScenario> that_talk(const std::string& policy) {
    std::string text = scenario;
    text.replace(text.find("RULE"), 4, "ci-det");
    text.replace(text.find("duration_s = 12"), 15, "duration_s = 30");
    text.replace(text.find("series_period_s = 12"), 20, "series_period_s = 30");
    text.replace(text.find("sensor = {"), 10, "sensor = { end_s = 12,");
    return prepared(
        text.replace(text.find("period_s = 2 }"), 14, "period_s = 0.5, " + policy + " }"));
  }
  // Agent 0 looks and speaks; 1 and 2 know what they hear alone.
  std::shared_ptr<const PreparedScenario> one_that_says(const std::string& content) {
    std::string text = scenario;
    text.replace(text.find("RULE"), 4, "ci-det");
    std::string listeners = text.substr(text.find("[[agents]]"));
    const auto sensor = listeners.find("sensor");
    listeners.erase(sensor, listeners.find("estimator") - sensor);
    listeners.replace(listeners.find("count = 3"), 9, "count = 2");
    listeners.replace(listeners.find("period_s = 2"), 12, "policy = \"never\", " + content);
    text.replace(text.find("count = 3"), 9, "count = 1");
    text.replace(text.find("period_s = 2 }"), 14, "period_s = 0.5, " + content + " }");
    return prepared(text + listeners);
  }
  std::string error(const std::string& from, const std::string& to) {
    std::string text = scenario;
    text.replace(text.find("RULE"), 4, "ci-det");
    text.replace(text.find(from), from.size(), to);
    try {
      prepared(text);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }
  Catalog catalog_;
  LogCache logs_;
};

// A textbook Kalman filter in covariance form, from a first guess that knows next to nothing.
TEST_F(MovingTargets, AloneAnAgentIsAKalmanFilter) {
  const auto what = with_rule("none");
  const gaussian::Transition t = gaussian::white_noise_acceleration(2, 0.5, 0.4);
  Eigen::Matrix4d P = 1e9 * Eigen::Matrix4d::Identity();
  Eigen::Matrix<double, 2, 4> H = Eigen::Matrix<double, 2, 4>::Identity();
  for (int k = 0; k <= 24; ++k) {
    if (k > 0) P = t.A * P * t.A.transpose() + t.R;
    if (k % 2 != 0) continue;
    const Eigen::Matrix2d S = H * P * H.transpose() + 4.0 * Eigen::Matrix2d::Identity();
    P -= P * H.transpose() * S.inverse() * H * P;
  }
  auto values = last(what, 1, 0);
  EXPECT_NEAR(values["claimed_sigma_m"], std::sqrt(P(0, 0)), 1e-6);
  EXPECT_NEAR(values["true_sigma_m"], values["claimed_sigma_m"], 1e-12);
  EXPECT_NEAR(values["ledger_anees"], 1.0, 1e-12);
}

// Errors of many runs against the covariance that the ledger gives in each of them.
TEST_F(MovingTargets, TheLedgerKnowsTheTrueCovariance) {
  const int runs = 400;
  for (const char* rule :
       {"none", "naive", "local-update", "channel", "channel-robust", "ci-det", "ellipsoidal"}) {
    const auto what = with_rule(rule);
    double sum = 0, claimed = 0;
    for (int seed = 1; seed <= runs; ++seed) {
      auto values = last(what, static_cast<std::uint64_t>(seed), 1);
      sum += values["ledger_nees"];
      claimed += values["nees"];
    }
    EXPECT_NEAR(sum / runs, 4.0, 4 * std::sqrt(2.0 * 4 / runs)) << rule;
    if (rule == std::string("naive")) {
      EXPECT_GT(claimed / runs, 5.0);
    }
    if (rule == std::string("ci-det")) {
      EXPECT_LT(claimed / runs, 4.0);
    }
  }
}

TEST_F(MovingTargets, WhoHearsEverythingAtOnceIsTheCentralFilter) {
  std::string text = scenario;
  text.replace(text.find("RULE"), 4, "local-update");
  text.replace(text.find("\"ring\""), 6, "\"full\"");
  text.replace(text.find("latency_s = 0.7"), 15, "latency_s = 0.0");
  text.replace(text.find("period_s = 2"), 12, "period_s = 0.5, phase = \"together\"");
  auto values = last(prepared(text), 3, 2);
  // Its own last words are on the air when the run ends, and so are those of the others.
  EXPECT_GT(values["kl_to_central_nats"], 0.0);
  text.replace(text.find("sensor = { kind"), 15, "sensor = { end_s = 11, kind");
  values = last(prepared(text), 3, 2);
  EXPECT_LT(values["kl_to_central_nats"], 1e-10);
}

// Words of the last 12 s come late, twice around, or not at all: whoever keeps the trajectory has
// them all in the end, and each once; a filter has forgotten when they were true.
TEST_F(MovingTargets, OnALineTrajectoriesAreTheCentralFilterAndFiltersAreNot) {
  std::string text = scenario;
  text.replace(text.find("\"ring\""), 6, "\"line\"");
  text.replace(text.find("latency_s = 0.7"), 15,
               "latency_s = 1.7\nloss = { model = \"bernoulli\", probability = 0.3 }");
  text.replace(text.find("duration_s = 12"), 15, "duration_s = 60");
  text.replace(text.find("series_period_s = 12"), 20, "series_period_s = 60");
  text.replace(text.find("sensor = { kind"), 15, "sensor = { end_s = 20, kind");
  text.replace(text.find("RULE"), 4, "channel-robust");
  const auto filters = prepared(text);
  text.replace(text.find("\"moving-gaussian\""), 17, "\"trajectory-gaussian\", window_s = 40");
  const auto trajectories = prepared(text);
  for (const AgentId agent : {0, 1, 2}) {
    EXPECT_LT(last(trajectories, 5, agent)["kl_to_central_nats"], 1e-9);
    // Not even a number: what is taken away after a prediction was not in there any more.
    EXPECT_FALSE(last(filters, 5, agent)["kl_to_central_nats"] < 1e-4);
  }
}

TEST_F(MovingTargets, EventTriggeredAgentsSpeakWhileOthersCannotPredictWhatTheyKnow) {
  const std::string triggered = "policy = \"event-triggered\", divergence_nats = ";
  const double always = sums(that_talk("policy = \"periodic\"")).at("packets");
  const double often = sums(that_talk(triggered + "0.01")).at("packets");
  const double seldom = sums(that_talk(triggered + "0.5")).at("packets");
  EXPECT_GT(always, 3 * 59);
  EXPECT_LT(often, 3 * 30);  // silent from 12 s on, though the belief fades
  EXPECT_LT(seldom, often);
  EXPECT_GE(seldom, 3 * 2);
  auto values = last(that_talk(triggered + "0.01"), 7, 0);
  EXPECT_GT(values.at("claimed_sigma_m"), 0.0);
  EXPECT_TRUE(std::isnan(values.at("true_sigma_m")));  // sending depends on what was measured
}

TEST_F(MovingTargets, SmallerContentsCostLessAndClaimLess) {
  const int runs = 200;
  struct Heard {
    double claimed_m = 0, nees = 0;
    int exact = 0;
  };
  const auto heard = [&](const std::string& content, double bytes) {
    const auto what = one_that_says(content);
    const auto ended = sums(what);
    EXPECT_GT(ended.at("packets"), 20) << content;
    EXPECT_EQ(ended.at("bytes_sent"), ended.at("packets") * bytes) << content;
    EXPECT_EQ(ended.at("messages_refused"), 0) << content;
    Heard mean;
    for (int seed = 1; seed <= runs; ++seed) {
      auto values = last(what, static_cast<std::uint64_t>(seed), 1);
      mean.claimed_m += values.at("claimed_sigma_m") / runs;
      mean.nees += values.at("nees") / runs;
      mean.exact += values.at("true_sigma_m") > 0.0 ? 1 : 0;
    }
    return mean;
  };
  const Heard whole = heard("content = \"belief\"", 156);
  const Heard quantised = heard("content = \"quantised\", bits = 8", 66);
  const Heard diagonal = heard("content = \"diagonal\"", 108);
  EXPECT_LT(whole.claimed_m, quantised.claimed_m);
  EXPECT_LT(quantised.claimed_m, diagonal.claimed_m);
  EXPECT_EQ(whole.exact, runs);
  EXPECT_EQ(diagonal.exact, runs);
  EXPECT_EQ(quantised.exact, 0);
  // The mean of n = 4 over the runs has the standard deviation √(2n/runs).
  EXPECT_NEAR(whole.nees, 4.0, 4 * std::sqrt(8.0 / runs));
  EXPECT_LT(quantised.nees, whole.nees);
  EXPECT_LT(diagonal.nees, quantised.nees);
}

TEST_F(MovingTargets, OutOfRangeNothingIsSeen) {
  std::string text = scenario;
  text.replace(text.find("RULE"), 4, "none");
  text.replace(text.find("sigma_m = 2"), 11, "sigma_m = 2, range_max_m = 8");
  text.replace(text.find("acceleration_psd_m2_per_s3 = 0.4\n"), 33,
               "acceleration_psd_m2_per_s3 = 0.0\n");
  hearsay::Run run(prepared(text), catalog_, {.seed = 1});
  ASSERT_TRUE(run.run().ok());
  // |(5 + 2t, t − 3)| ≤ 8 at t = 0 and 1 s (7.28 m), not at 2 s (9.06 m).
  for (const ScalarRow& row : run.record().scalars()) {
    if (run.record().text(row.name) != std::string("measurements") || row.agent < 0) continue;
    EXPECT_EQ(row.value, 2.0);
  }
}

TEST_F(MovingTargets, ATargetOnAPathIsFollowedAndItsTrueCovarianceIsUnknown) {
  std::string text = scenario;
  text.replace(text.find("RULE"), 4, "ci-det");
  const auto from = text.find("kind ="), to = text.find("[radio]");
  text.replace(from, to - from, "kind = \"waypoints\"\npoints_m = [[50, 40]]\nspeed_m_per_s = 3\n");
  auto values = last(prepared(text), 1, 0);
  EXPECT_LT(values["rms_error_m"], 4.0);
  EXPECT_TRUE(std::isnan(values["true_sigma_m"]));
}

TEST_F(MovingTargets, WhatDoesNotGoTogetherIsRefused) {
  EXPECT_EQ(error("step_s = 0.5\n", ""),
            "s.toml:6: world.targets[0].motion: needs world.step_s: how often agents look at "
            "targets that move and believe in them");
  EXPECT_EQ(error("moving-gaussian", "static-gaussian"),
            "s.toml:22: agents[0].estimator.acceleration_psd_m2_per_s3: not for kind = "
            "\"static-gaussian\", whose states stand still");
  EXPECT_EQ(error("\"moving-gaussian\", fusion = \"ci-det\", acceleration_psd_m2_per_s3 = 0.4",
                  "\"static-gaussian\""),
            "s.toml:22: agents[0].estimator.kind: \"static-gaussian\" believes that targets stand "
            "still, but \"object\" moves; take \"moving-gaussian\" or \"trajectory-gaussian\"");
  EXPECT_EQ(error("\"ci-det\", acceleration_psd_m2_per_s3 = 0.4", "\"ci-det\""),
            "s.toml:22: agents[0].estimator: kind \"moving-gaussian\" needs "
            "acceleration_psd_m2_per_s3: how much it expects targets to turn and change speed");
  EXPECT_EQ(error("period_s = 1,", "period_s = 0.75,"),
            "s.toml:21: agents[0].sensor.period_s: must be a multiple of world.step_s (0.5 s), for "
            "targets that move are looked at and believed in there alone");
  EXPECT_EQ(error("fusion = \"ci-det\"", "window_s = 20"),
            "s.toml:22: agents[0].estimator.window_s: only for kind = \"trajectory-gaussian\"; "
            "found \"moving-gaussian\"");
  EXPECT_EQ(error("\"moving-gaussian\", fusion = \"ci-det\"",
                  "\"trajectory-gaussian\", fusion = \"ellipsoidal\""),
            "s.toml:22: agents[0].estimator.fusion: \"ellipsoidal\" does not go with kind = "
            "\"trajectory-gaussian\"; allowed: none, local-update, naive, channel, channel-robust, "
            "ci-det, ci-half");
  EXPECT_EQ(error("position_m = [5, -3]\n", ""),
            "s.toml:4: world.targets[0].position_m: missing; where it begins");
  EXPECT_EQ(error("\"white-noise-acceleration\"", "\"track\""),
            "s.toml:8: world.targets[0].motion.kind: \"track\" is for agents, not for targets");
  EXPECT_EQ(
      error("position_m = [0, 0]\n",
            "motion = { kind = \"white-noise-acceleration\", "
            "acceleration_psd_m2_per_s3 = 1 }\n"),
      "s.toml:20: agents[0].motion.kind: \"white-noise-acceleration\" is for targets, not for "
      "agents");
  EXPECT_EQ(error("step_s = 0.5", "step_s = 1e-6"),
            "s.toml:3: world.step_s: the run would have more than 1000000 steps");
  EXPECT_EQ(error("position_m = [0, 0]\nsensor = {", "sensor = { range_max_m = 5,"),
            "s.toml:20: agents[0].sensor.range_max_m: needs to know where the agent stands: "
            "position_m, circle or motion");
}

TEST_F(MovingTargets, WhatIsSaidGoesWithWhatIsBelieved) {
  const std::string talk = "talk = { period_s = 2 }";
  const std::string triggered = "talk = { policy = \"event-triggered\", divergence_nats = 0.1 }";
  const std::string diagonal = "talk = { content = \"diagonal\" }";
  const std::string filter =
      "\"moving-gaussian\", fusion = \"ci-det\", acceleration_psd_m2_per_s3 = 0.4 }\n";
  const std::string trajectory =
      "\"trajectory-gaussian\", fusion = \"ci-det\", acceleration_psd_m2_per_s3 = 0.4 }\n";
  EXPECT_EQ(error(talk, triggered), "no error");
  EXPECT_EQ(error(talk, diagonal), "no error");
  EXPECT_EQ(error(filter + talk, trajectory + "talk = { policy = \"on-update\" }"), "no error");
  EXPECT_EQ(error(filter + talk, trajectory + triggered),
            "s.toml:23: agents[0].talk.policy: \"event-triggered\" goes with kinds "
            "\"static-gaussian\" and \"moving-gaussian\" alone; found \"trajectory-gaussian\"");
  EXPECT_EQ(error(filter + talk, trajectory + diagonal),
            "s.toml:23: agents[0].talk.content: \"diagonal\" goes with kinds \"static-gaussian\" "
            "and \"moving-gaussian\" alone; found \"trajectory-gaussian\"");
  for (const std::string rule : {"split-ci", "ci-batch", "consensus-information"}) {
    EXPECT_EQ(error("\"ci-det\"", "\"" + rule + "\""),
              "s.toml:22: agents[0].estimator.fusion: \"" + rule +
                  "\" goes with kind \"static-gaussian\" alone; found \"moving-gaussian\"");
  }
  // A stamp, four means and ten entries.
  EXPECT_EQ(error("latency_s = 0.7", "queue_bytes_max = 155"),
            "s.toml:13: radio.queue_bytes_max = 155: smaller than one packet: a message of all "
            "beliefs, or a summary, takes 156 bytes with headers");
  EXPECT_EQ(error("latency_s = 0.7", "queue_bytes_max = 156"), "no error");
}

}  // namespace
}  // namespace hearsay
