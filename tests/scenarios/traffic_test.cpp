// Sources in scenario files: runs without any estimator, and what is refused.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "agents/source_agent.hpp"
#include "scenarios/run.hpp"
#include "scenarios/traffic.hpp"
#include "tests/scenarios/temp_files.hpp"

namespace hearsay {
namespace {

const std::string pair_of = R"(duration_s = 10
[radio]
rate_bps = 1e6
[[agents]]
name = "sender"
kind = "source"
traffic = { arrivals = "periodic", period_s = 0.1, phase_s = 0.0, bytes = 125 }
[[agents]]
name = "sink"
kind = "source"
)";

class TrafficFile : public InTempDirectory {
 protected:
  static Scenario load(const std::vector<std::string>& settings) {
    std::vector<Override> overrides;
    for (const std::string& setting : settings) overrides.push_back(parse_set(setting));
    write("s.toml", pair_of);
    return load_scenario("s.toml", overrides, {});
  }
  static std::string error(const std::vector<std::string>& settings) {
    return error_of([&] { load(settings); });
  }
  // Final values by agent and name.
  static std::map<std::pair<AgentId, std::string>, double> values(
      const std::vector<std::string>& settings) {
    const Catalog catalog;
    LogCache logs;
    hearsay::Run run(prepare(load(settings), catalog, logs), catalog, {.seed = 1});
    const RunEnd end = run.run();
    EXPECT_TRUE(end.ok()) << end.message;
    EXPECT_TRUE(run.record().series().empty());
    std::map<std::pair<AgentId, std::string>, double> found;
    for (const ScalarRow& row : run.record().scalars()) {
      found[{row.agent, run.record().text(row.name)}] = row.value;
    }
    return found;
  }
};

TEST_F(TrafficFile, SourcesRunWithoutEstimatorsAndWithoutACentralFilter) {
  const auto found = values({"radio.latency_s=0.004"});
  EXPECT_EQ(found.at({0, "packets"}), 101.0);
  EXPECT_EQ(found.at({1, "heard_packets"}), 100.0);
  EXPECT_DOUBLE_EQ(found.at({1, "delay_mean_s"}), 0.005);
  EXPECT_DOUBLE_EQ(found.at({1, "goodput_bps"}), 10'000.0);
  EXPECT_EQ(found.at({1, "packets"}), 0.0);
  EXPECT_FALSE(found.contains({central_agent, "state_dimension"}));
}

TEST_F(TrafficFile, AnAddressedPacketGoesToItsReceiverAloneAndIsRepeatedIfItIsAcknowledged) {
  const std::string lossy = "radio.loss={model=\"bernoulli\",probability=0.5}";
  const std::string to_sink = "agents[0].traffic.receiver=\"sink\"";
  const auto plain = values({lossy, to_sink, "agents[0].traffic.service=unicast"});
  const auto safe = values({lossy, to_sink, "agents[0].traffic.service=acknowledged"});
  EXPECT_NEAR(plain.at({1, "heard_packets"}), 50.0, 20.0);  // four standard deviations
  EXPECT_EQ(plain.at({0, "frames"}), 101.0);
  // Seven attempts, each of which arrives with 1/2: less than one in a hundred does not.
  EXPECT_GE(safe.at({1, "heard_packets"}), 97.0);
  EXPECT_GT(safe.at({0, "frames"}), 150.0);
  EXPECT_GT(safe.at({1, "acknowledgements"}), 0.0);
}

TEST_F(TrafficFile, APhaseIsAtRandomUnlessItIsGiven) {
  TrafficSpec spec;
  spec.arrivals = "periodic";
  spec.period_s = 2.0;
  std::map<std::int64_t, int> halves;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Duration phase = traffic_of(spec, 0, seed).phase;
    ASSERT_GE(phase, Duration());
    ASSERT_LT(phase, Duration::seconds(2.0));
    ++halves[phase / Duration::seconds(1.0)];
  }
  EXPECT_NEAR(halves[0], 200, 40);
  EXPECT_NE(traffic_of(spec, 0, 1).phase, traffic_of(spec, 1, 1).phase);
  spec.phase_s = 0.25;
  EXPECT_EQ(traffic_of(spec, 0, 1).phase, Duration::seconds(0.25));
}

TEST_F(TrafficFile, ReadsBackWhatItWrites) {
  const std::string text =
      canonical_text(load({"agents[0].traffic.service=unicast", "agents[0].traffic.receiver=sink",
                           "agents[0].traffic.packets_max=9"}));
  write("again.toml", text);
  EXPECT_EQ(canonical_text(load_scenario("again.toml", {}, {})), text);
  EXPECT_NE(text.find("receiver = 1"), std::string::npos) << text;
}

TEST_F(TrafficFile, TrafficThatContradictsItselfIsRefused) {
  const std::string t = "agents[0].traffic.";
  const std::string whole = "agents[0].traffic=";
  EXPECT_EQ(error({t + "arrivals=saturated", t + "phase_s=0"}),
            "s.toml:7: agents[0].traffic.period_s: not for arrivals = \"saturated\": there is "
            "always a packet");
  EXPECT_NE(error({whole + "{}"}).find("period_s: missing; arrivals = \"poisson\" needs it"),
            std::string::npos);
  EXPECT_NE(error({t + "arrivals=poisson"}).find("phase_s: only for arrivals = \"periodic\""),
            std::string::npos);
  EXPECT_NE(error({t + "phase_s=0.1"}).find("phase_s: must be less than period_s (0.1 s)"),
            std::string::npos);
  EXPECT_NE(error({t + "service=unicast"}).find("receiver: missing; service = \"unicast\""),
            std::string::npos);
  EXPECT_NE(error({t + "receiver=1"}).find("receiver: not for service = \"broadcast\""),
            std::string::npos);
  EXPECT_NE(error({t + "service=unicast", t + "receiver=sinc"}).find("did you mean 'sink'?"),
            std::string::npos);
  EXPECT_NE(error({t + "service=unicast", t + "receiver=0"}).find("would send to itself"),
            std::string::npos);
  EXPECT_NE(error({"agents[1].kind=estimator", "agents[1].traffic={period_s=1}"})
                .find("agents[1].traffic: only for kind = \"source\"; found \"estimator\""),
            std::string::npos);
}

TEST_F(TrafficFile, AQueueMustHoldWhatASourceSends) {
  const std::string saturated = "agents[0].traffic={arrivals=\"saturated\",bytes=125}";
  EXPECT_EQ(error({"radio.queue_bytes_max=125"}), "no error");
  EXPECT_NE(error({"radio.queue_bytes_max=124"}).find("may take 125 bytes with headers"),
            std::string::npos)
      << error({"radio.queue_bytes_max=124"});
  EXPECT_NE(error({"radio.queue_bytes_max=1000", "agents[0].traffic.sizes=exponential"})
                .find("may take 4625"),
            std::string::npos);
  EXPECT_EQ(error({saturated, "radio.queue_bytes_max=250"}), "no error");
  EXPECT_NE(error({saturated, "radio.queue_bytes_max=249"}).find("smaller than two packets"),
            std::string::npos);
  EXPECT_NE(error({saturated, "radio.queue_packets_max=1"}).find("must be at least 2"),
            std::string::npos);
  EXPECT_NE(error({saturated, "radio.rate_bps=1e13"}).find("at least a nanosecond"),
            std::string::npos);
}

TEST_F(TrafficFile, ASourceHasNoSensorBeliefOrTalk) {
  for (const char* key : {"agents[1].sensor={kind=\"position\",sigma_m=1}",
                          "agents[1].estimator.fusion=naive", "agents[1].talk.period_s=1"}) {
    const std::string message = error({"world.targets=[{name=\"t\",position_m=[0,0]}]", key});
    EXPECT_NE(message.find("without effect: kind = \"source\""), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace hearsay
