// Whatever stands in a file, reading it ends with a scenario or an InputError.
#include <gtest/gtest.h>

#include <cstdint>
#include <string_view>

#include "scenarios/channel.hpp"
#include "scenarios/links.hpp"
#include "scenarios/motion.hpp"
#include "temp_files.hpp"

namespace hearsay {
namespace {

// A small generator of its own, so that a failure can be repeated anywhere.
class Dice {
 public:
  std::size_t below(std::size_t n) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::size_t>(state_ >> 33) % n;
  }

 private:
  std::uint64_t state_ = 2024;
};

// A few edits: a byte changed, removed or inserted; a piece repeated or cut; a telling token put
// in.
std::string mutated(std::string text, Dice& dice) {
  static constexpr std::string_view tokens[] = {"[",
                                                "]",
                                                "{",
                                                "}",
                                                "[[",
                                                "]]",
                                                "=",
                                                ".",
                                                ",",
                                                "\"",
                                                "\"\"\"",
                                                "'",
                                                "\n",
                                                "-",
                                                "1e999",
                                                "nan",
                                                "inf",
                                                "-1",
                                                "0",
                                                "99999999999999999999",
                                                "9223372036854775807",
                                                "1979-05-27",
                                                "\\u0000",
                                                "true",
                                                "agents",
                                                "[[agents]]\n",
                                                "[world.log]\n",
                                                "edges = [[0, 9]]\n",
                                                "[[radio.outages]]\n",
                                                "[[radio.partitions]]\n",
                                                "[radio.rotation]\n",
                                                "groups = [[0, 1], [2, 3]]\n",
                                                "topology = \"grid\"\n",
                                                "a,b",
                                                "up",
                                                "\r\n",
                                                "\xff",
                                                "\xc3",
                                                "#"};
  for (std::size_t edits = 1 + dice.below(2); edits > 0; --edits) {
    const std::size_t at = dice.below(text.size() + 1);
    const std::size_t length = dice.below(12);
    switch (dice.below(5)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(dice.below(256));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, 1, static_cast<char>(dice.below(128)));
        break;
      case 3:
        text.insert(dice.below(text.size() + 1), text.substr(at, length));
        break;
      default:
        text.insert(at, tokens[dice.below(std::size(tokens))]);
    }
  }
  return text;
}

class Fuzz : public InTempDirectory {
 protected:
  // Counts what came of it; anything else than success or InputError fails the test.
  template <class Load>
  void attempt(const std::string& content, Load load) {
    write("f.toml", content);
    try {
      load();
      ++read;
    } catch (const InputError& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()), "");
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what() << "\nfrom\n" << content;
    }
  }
  int read = 0, refused = 0;
};

TEST_F(Fuzz, AScenarioIsReadOrRefused) {
  Dice dice;
  for (int i = 0; i < 2000; ++i) {
    attempt(mutated(ring, dice), [] { canonical_text(load_scenario("f.toml", {}, {})); });
  }
  EXPECT_GT(read, 20);
  EXPECT_GT(refused, 500);
}

TEST_F(Fuzz, AChannelIsReadAndCanBeBuiltOrIsRefused) {
  const std::string channel = R"(duration_s = 9
[radio]
topology = "by-position"
propagation = { model = "log-distance", exponent = 2, shadowing_sigma_db = 4, range_m = 90 }
loss = { model = "gilbert-elliott", probability = 0.5, mean_burst = 5 }
jammers = [{ position_m = [1, 2], power_dbm = 9, from_s = 1, period_s = 3, duty = 0.5 }]
[[agents]]
count = 3
circle = { radius_m = 9 }
[[dropouts]]
agents = [0, "estimator1"]
kind = "reboot"
mean_up_s = 9
mean_down_s = 1
)";
  Dice dice;
  for (int i = 0; i < 2000; ++i) {
    attempt(mutated(channel, dice), [] {
      const Scenario s = load_scenario("f.toml", {}, {});
      EXPECT_NO_THROW(loss_of(s.radio.loss));
      EXPECT_NO_THROW(propagation_of(s.radio));
      EXPECT_NO_THROW(jammers_of(s.radio));
      EXPECT_NO_THROW(dropouts_of(s, 1, Time::at(9_s)).next(1));
    });
  }
  EXPECT_GT(read, 20);
  EXPECT_GT(refused, 500);
}

TEST_F(Fuzz, AScenarioWithLinksThatChangeIsReadOrRefused) {
  const std::string changing = R"(duration_s = 60
[radio]
topology = "small-world"
mean_degree = 2
rewire_probability = 0.5
[[radio.outages]]
links = [["a0", 1], [2, 3]]
down_s = 1.5
[[radio.partitions]]
from_s = 10
until_s = 20
groups = [["a0", "a1"], [2, 3]]
[radio.rotation]
period_s = 4
groups = [[0], [1], [2, 3]]
[[agents]]
name = "a"
count = 4
)";
  Dice dice;
  for (int i = 0; i < 1500; ++i) {
    attempt(mutated(changing, dice), [] {
      const Scenario scenario = load_scenario("f.toml", {}, {});
      canonical_text(scenario);
      if (scenario.agent_count() < 100) make_link_plan(scenario, agent_positions(scenario), 1);
    });
  }
  EXPECT_GT(read, 20);
  EXPECT_GT(refused, 500);
}

TEST_F(Fuzz, AContactTraceIsReadOrRefused) {
  write("scenario.toml",
        "duration_s = 9\nradio = { topology = \"contacts\", contacts = \"f.toml\" }\n"
        "[[agents]]\nname = \"a\"\ncount = 4\n");
  const std::string trace =
      "t_s,a,b,state\n0,a0,a1,up\n1.5,1,0,down\n# later\n2,\"a2\",3,up\n2,0,1,up\n4e1,3,2,down\n";
  Dice dice;
  for (int i = 0; i < 3000; ++i) {
    attempt(mutated(trace, dice), [] {
      const Scenario scenario = load_scenario("scenario.toml", {}, {});
      make_link_plan(scenario, agent_positions(scenario), 1);
    });
  }
  EXPECT_GT(read, 20);
  EXPECT_GT(refused, 500);
}

TEST_F(Fuzz, MotionIsReadAndGivesLegsOrIsRefused) {
  const std::string moving = R"(duration_s = 60
[[agents]]
motion = { kind = "waypoints", points_m = [[0, 1], [2, 3]], speed_m_per_s = 4, repeat = "loop" }
[[agents]]
motion = { kind = "lawn-mower", area_m = [[0, 1], [9, 8]], speed_m_per_s = 4, lane_spacing_m = 2 }
[[agents]]
count = 2
[agents.motion]
kind = "random-waypoint"
area_m = [[0, 1], [9, 8]]
speed_min_m_per_s = 1
speed_max_m_per_s = 3
pause_max_s = 5
[[agents]]
[agents.motion]
kind = "gauss-markov"
area_m = [[0, 1], [9, 8]]
speed_mean_m_per_s = 1
speed_sigma_m_per_s = 1
direction_sigma_rad = 3
alpha = 0.75
)";
  Dice dice;
  for (int i = 0; i < 1500; ++i) {
    attempt(mutated(moving, dice), [] {
      const Scenario s = load_scenario("f.toml", {}, {});
      const auto places_m = agent_positions(s);
      for (std::size_t agent = 0; agent < s.agents.size(); ++agent) {
        if (!s.agents[agent].motion) continue;
        const auto motion = make_motion(s.agents[agent], {}, static_cast<AgentId>(agent), 1);
        Leg leg = motion->next();
        for (int k = 0; k < 20 && leg.end < Time::never(); ++k) {
          const Time end = leg.end;
          leg = motion->next();
          ASSERT_EQ(leg.begin, end);
          ASSERT_GT(leg.end, end);
        }
      }
    });
  }
  EXPECT_GT(read, 20);
  EXPECT_GT(refused, 500);
}

TEST_F(Fuzz, ATrackIsReadOrRefused) {
  write("scenario.toml",
        "duration_s = 9\n[[agents]]\nname = \"a\"\ncount = 2\n"
        "motion = { kind = \"track\", file = \"f.toml\" }\n");
  const std::string track = "t_s,agent,x_m,y_m\n0,a0,1,2\n1.5,1,0,4\n# later\n2,\"a0\",3,1e3\n";
  Dice dice;
  for (int i = 0; i < 1500; ++i) {
    attempt(mutated(track, dice), [] { load_scenario("scenario.toml", {}, {}); });
  }
  EXPECT_GT(read, 20);
  EXPECT_GT(refused, 300);
}

TEST_F(Fuzz, AStudyIsReadOrRefused) {
  write("ring.toml", ring);
  const std::string study = R"(scenario = "ring.toml"
repetitions = 3
[set]
radio.latency_s = 0.1
[axes]
rule = { key = "agents.estimator.fusion", values = ["naive", "ci-det"] }
place = { points = [{ label = 1, set = { "agents.circle.radius_m" = 2 } }] }
[[skip]]
when = { rule = "naive", place = [1] }
[[claims]]
text = "t"
expect = { metric = "anees", where = { rule = "ci-det" }, within = "chi2-band" }
[[figures]]
script = "a.py"
output = "a.png"
)";
  Dice dice;
  for (int i = 0; i < 1000; ++i) {
    attempt(mutated(study, dice), [] { load_study("f.toml", {}); });
  }
  EXPECT_GT(read, 20);
  EXPECT_GT(refused, 500);
}

TEST_F(Fuzz, AnOverrideIsTakenOrRefused) {
  Dice dice;
  for (int i = 0; i < 2000; ++i) {
    const std::string text = mutated("agents[0].sensor.period_s=0.5", dice);
    attempt(ring, [&] { load_scenario("f.toml", sets({text}), {}); });
  }
  EXPECT_GT(read, 20);
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace hearsay
