// Whole runs whose agents move: who hears whom follows from where they are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
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

/// Walks a square of 100 m at 10 m/s, then stops for good; says when it turns.
class Walker final : public Agent {
 public:
  explicit Walker(Context& own) : Agent(own) {}
  void start() override {
    if (context().steered()) spawn(walk());
  }
  void finish() override {
    context().record_final("x", context().position()[0]);
    context().record_final("y", context().position()[1]);
    context().record_final("turned_s", turned_s_);
  }

 private:
  Process walk() {
    for (const std::array<double, 2>& corner :
         {std::array{100.0, 0.0}, {100.0, 100.0}, {0.0, 100.0}, {0.0, 0.0}}) {
      co_await context().sleep_until(context().go_to(corner, 10.0));
    }
    turned_s_ = context().now().seconds();
    context().go_to({500.0, 0.0}, 10.0);
    co_await context().sleep(2500_ms);
    context().stay();
  }
  double turned_s_ = 0.0;
};

TEST_F(MovingRun, AnAgentGoesWhereItDecides) {
  write("s.toml",
        "duration_s = 60\n[radio]\ntopology = \"disk\"\nrange_m = 50\n[[agents]]\nkind "
        "= \"walker\"\nposition_m = [0, 0]\nmotion = { kind = \"steered\" }\n"
        "[[agents]]\nkind = \"walker\"\nposition_m = [7, 8]\n");
  Catalog catalog;
  catalog.add_agent<Walker>("walker", "walks a square");
  LogCache logs;
  hearsay::Run run(prepare(load_scenario("s.toml", {}, known_names(catalog)), catalog, logs),
                   catalog, {.seed = 1});
  const RunEnd end = run.run();
  ASSERT_TRUE(end.ok()) << end.message;
  std::map<std::string, double> values;
  for (const ScalarRow& row : run.record().scalars()) {
    if (row.agent == 0) values[std::string(run.record().text(row.name))] = row.value;
  }
  EXPECT_EQ(values.at("turned_s"), 40.0);
  EXPECT_NEAR(values.at("x"), 25.0, 1e-9);
  EXPECT_NEAR(values.at("y"), 0.0, 1e-9);
}

TEST_F(MovingRun, WhoIsNotSteeredCannotGoAnywhere) {
  class Stubborn final : public Agent {
   public:
    explicit Stubborn(Context& own) : Agent(own) {}
    void start() override { context().go_to({1.0, 0.0}, 1.0); }
  };
  write("s.toml",
        "duration_s = 1\n[[agents]]\nkind = \"stubborn\"\nposition_m = [0, 0]\n"
        "motion = { kind = \"hover\" }\n");
  Catalog catalog;
  catalog.add_agent<Stubborn>("stubborn", "goes where it must not");
  LogCache logs;
  hearsay::Run run(prepare(load_scenario("s.toml", {}, known_names(catalog)), catalog, logs),
                   catalog, {.seed = 1});
  EXPECT_THAT(run.run().message, testing::HasSubstr("that is not steered cannot go anywhere"));
}

}  // namespace
}  // namespace hearsay
