// Whole runs whose agents move: who hears whom follows from where they are.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "scenarios/run.hpp"
#include "tests/scenarios/temp_files.hpp"

namespace hearsay {
namespace {

class MovingRun : public InTempDirectory {
 protected:
  // Sums of fates over all links of a run.
  std::map<std::string, std::uint64_t> fates(const std::string& scenario) {
    write("s.toml", scenario);
    const Catalog catalog;
    LogCache logs;
    hearsay::Run run(prepare(load_scenario("s.toml", {}, known_names(catalog)), catalog, logs),
                     catalog, {.seed = 1});
    const RunEnd end = run.run();
    EXPECT_TRUE(end.ok()) << end.message;
    std::map<std::string, std::uint64_t> sums;
    for (const LinkRow& link : run.record().links()) {
      sums[run.record().text(link.fate)] += link.packets;
    }
    return sums;
  }
};

// Agent 1 passes agent 0 at 10 m/s, from 500 m before to 500 m behind: it is within 100 m from 40 s
// to 60 s, both inclusive, and both talk once a second on the second.
const std::string passing = R"(duration_s = 100
world = { targets = [{ name = "t", position_m = [0, 50] }] }
[[agents]]
position_m = [0, 0]
sensor = { kind = "position", sigma_m = 1 }
estimator = { fusion = "naive" }
talk = { period_s = 1, phase = "together" }
[[agents]]
position_m = [-500, 0]
motion = { kind = "waypoints", points_m = [[500, 0]], speed_m_per_s = 10 }
sensor = { kind = "position", sigma_along_m = 1, sigma_across_m = 2 }
estimator = { fusion = "naive" }
talk = { period_s = 1, phase = "together" }
)";

TEST_F(MovingRun, WhoPassesIsHeardWhileInRange) {
  const auto sums = fates(passing + "[radio]\ntopology = \"disk\"\nrange_m = 100\n");
  EXPECT_EQ(sums, (std::map<std::string, std::uint64_t>{{"delivered", 2 * 21}}));
}

TEST_F(MovingRun, AGraphDoesNotCareWhoMoves) {
  const auto sums = fates(passing + "[radio]\ntopology = \"full\"\nlatency_s = 0.5\n");
  EXPECT_EQ(sums.at("delivered"), 2 * 100u);  // those of 100 s are still under way
  EXPECT_EQ(sums.at("in_flight_at_end"), 2u);
}

TEST_F(MovingRun, AJammerHurtsWhoIsNearItNow) {
  const auto sums = fates(passing + R"([radio]
topology = "full"
jammers = [{ position_m = [0, 200], radius_m = 210 }]
)");
  // Agent 1 is within 210 m of (0, 200) where |x| ≤ √(210² − 200²) = 64.03 m: at 44 … 56 s. Agent 0
  // so all the time. What is sent at 100 s is still on the air at the end.
  EXPECT_EQ(sums.at("jammed"), 100u + 13u);
  EXPECT_EQ(sums.at("delivered"), 100u - 13u);
}

}  // namespace
}  // namespace hearsay
