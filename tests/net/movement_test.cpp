#include "net/movement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/world/motion.hpp"
#include "tests/sim/world/paths.hpp"
#include "tools/memory/memory.hpp"

namespace hearsay {
namespace {

using motion::at_s;
using motion::Path;
using Make = std::function<std::unique_ptr<Motion>(AgentId)>;

class Motions final : public PathSource {
 public:
  Motions(int agents, const Make& make) {
    for (AgentId a = 0; a < agents; ++a) motions_.push_back(make(a));
  }
  Leg next(AgentId agent, Time) override {
    ++asked;
    return motions_[static_cast<std::size_t>(agent)]->next();
  }
  int asked = 0;

 private:
  std::vector<std::unique_ptr<Motion>> motions_;
};

// A run in which looks at random times find whom brute force finds, to the last bit.
void expect_brute_force(int agents, double reach_m, double slack_m, const Make& make,
                        double end_s) {
  Simulation simulation({.end = at_s(end_s)});
  Motions motions(agents, make);
  std::vector<Path> paths;
  for (AgentId a = 0; a < agents; ++a) paths.emplace_back(make(a));
  Places places(agents, reach_m, slack_m);
  const Movement movement(simulation, places, motions);
  Stream stream(1, Purpose("looks"), Entity::agent(0));
  std::size_t found = 0;
  const auto look = [&] {
    const Time now = simulation.now();
    std::vector<Point> at;
    for (Path& path : paths) at.push_back(path.at(now));
    for (int k = 0; k < 20; ++k) {
      const auto me = stream.below(static_cast<std::uint64_t>(agents));
      std::vector<std::pair<AgentId, double>> expected, got;
      for (std::size_t b = 0; b < at.size(); ++b) {
        const double d2 = squared_distance_m2(at[me], at[b]);
        if (b != me && d2 <= reach_m * reach_m) expected.emplace_back(static_cast<AgentId>(b), d2);
      }
      for (const auto& [agent, d2] : places.near(static_cast<AgentId>(me), now)) {
        got.emplace_back(agent, d2);
      }
      ASSERT_EQ(got, expected) << "agent " << me << " at " << now.seconds() << " s";
      ASSERT_EQ(places.at(static_cast<AgentId>(me), now), at[me]);
      found += got.size();
    }
  };
  for (int k = 0; k < 300; ++k) {
    simulation.schedule(at_s(stream.uniform(0.0, end_s)), Phase::update, [&] { look(); });
  }
  simulation.schedule(Time(), Phase::update, [&] { look(); });
  simulation.schedule(at_s(end_s), Phase::update, [&] { look(); });
  const RunEnd end = simulation.run();
  EXPECT_TRUE(end.ok()) << end.message;
  EXPECT_GT(found, 100u);
}

constexpr motion::Rectangle field{{-300.0, -200.0}, {300.0, 100.0}};

Make wanderers(double speed_max_m_per_s) {
  return [=](AgentId a) {
    return motion::make(motion::RandomWaypoint{.area = field,
                                               .speed_min_m_per_s = speed_max_m_per_s / 10,
                                               .speed_max_m_per_s = speed_max_m_per_s,
                                               .pause_max = 5_s},
                        1, a);
  };
}
Make roamers(double speed_m_per_s) {
  return [=](AgentId a) {
    return motion::make(motion::GaussMarkov{.area = field,
                                            .speed_mean_m_per_s = speed_m_per_s,
                                            .speed_sigma_m_per_s = speed_m_per_s / 3,
                                            .direction_sigma_rad = 1.0,
                                            .alpha = 0.8,
                                            .altitude_m = 10.0 * (a % 3)},
                        1, a);
  };
}

TEST(Movement, LooksFindWhomBruteForceFinds) {
  for (const double slack_m : {0.5, 10.0, 60.0, 1000.0}) {
    expect_brute_force(300, 60.0, slack_m, wanderers(20.0), 50.0);
    expect_brute_force(300, 60.0, slack_m, roamers(15.0), 50.0);
  }
}

TEST(Movement, LooksFindWhomBruteForceFindsInACrowdAndAmongFew) {
  expect_brute_force(400, 250.0, 50.0, wanderers(20.0), 20.0);
  expect_brute_force(9, 60.0, 20.0, roamers(15.0), 500.0);
  expect_brute_force(100, 5.0, 2.0, wanderers(20.0), 200.0);
}

TEST(Movement, LooksFindWhomBruteForceFindsAmongTheFast) {
  expect_brute_force(100, 60.0, 20.0, wanderers(30'000.0), 0.5);
}

TEST(Movement, LooksFindWhomBruteForceFindsOnToursThatGather) {
  // From a circle to its centre and out again, all at once.
  const Make make = [](AgentId a) {
    const double x_m = 100.0 * (a % 17 - 8), y_m = 90.0 * (a % 13 - 6);
    return motion::make(motion::Waypoints{{{x_m, y_m}, {0.1 * a, 0.0}, {-y_m, x_m}},
                                          0.1 * std::sqrt(x_m * x_m + y_m * y_m) + 0.5,
                                          1_s,
                                          motion::Repeat::loop});
  };
  expect_brute_force(221, 40.0, 15.0, make, 60.0);
}

TEST(Movement, PlacesAreRightAtTheInstantOfATurn) {
  // Agent 0 turns at whole seconds; whoever looks then, in whatever phase after the world's, finds
  // agent 1 exactly in reach.
  const Make make = [](AgentId a) {
    if (a == 1) return motion::make(motion::Hover{{10.0, 3.0}});
    return motion::make(motion::Waypoints{{{0, 0}, {10, 0}}, 10.0, {}, motion::Repeat::loop});
  };
  Simulation simulation({.end = at_s(100)});
  Motions motions(2, make);
  Places places(2, 3.0, 1.0);
  const Movement movement(simulation, places, motions);
  int met = 0;
  for (int s = 0; s <= 100; ++s) {
    simulation.schedule(at_s(s), Phase::measure, [&, s] {
      met += static_cast<int>(places.near(0, simulation.now()).size());
      EXPECT_EQ(places.near(0, simulation.now()).size(), s % 2 == 1 ? 1u : 0u) << s;
    });
  }
  EXPECT_TRUE(simulation.run().ok());
  EXPECT_EQ(met, 50);
}

TEST(Movement, WhatStandsStillCostsNoEvents) {
  Simulation simulation({.end = at_s(1000)});
  Motions motions(5, [](AgentId a) { return motion::make(motion::Hover{{1.0 * a, 0.0}}); });
  Places places(5, 3.0, 0.0);
  const Movement movement(simulation, places, motions);
  EXPECT_EQ(simulation.run().events, 0u);
  EXPECT_EQ(motions.asked, 5);
}

TEST(Movement, FilesAnewOnlyWhenTheSlackIsUsedUp) {
  // 1000 m at 10 m/s in one leg, 50 m of slack: after 5, 10, … 95 s, then at the end of the leg.
  Simulation simulation({.end = at_s(1000)});
  Motions motions(1, [](AgentId) {
    return motion::make(motion::Waypoints{{{0, 0}, {1000, 0}}, 10.0});
  });
  Places places(1, 100.0, 50.0);
  const Movement movement(simulation, places, motions);
  EXPECT_EQ(simulation.run().events, 20u);
  EXPECT_EQ(motions.asked, 2);
}

TEST(Movement, MayBeginInTheMiddleOfARun) {
  Simulation simulation({.end = at_s(100)});
  Motions motions(2, wanderers(20.0));
  std::vector<Path> paths;
  for (AgentId a = 0; a < 2; ++a) paths.emplace_back(wanderers(20.0)(a));
  Places places(2, 100.0, 50.0);
  std::unique_ptr<Movement> movement;
  simulation.schedule(at_s(70), Phase::act,
                      [&] { movement = std::make_unique<Movement>(simulation, places, motions); });
  simulation.schedule(at_s(90), Phase::act, [&] {
    for (AgentId a = 0; a < 2; ++a) {
      EXPECT_EQ(places.at(a, at_s(90)), paths[static_cast<std::size_t>(a)].at(at_s(90)));
    }
  });
  EXPECT_TRUE(simulation.run().ok());
}

TEST(Movement, APathWithAGapEndsTheRunInItsAgentsName) {
  class Gappy final : public PathSource {
   public:
    Leg next(AgentId agent, Time now) override {
      const Duration gap = agent == 1 && now > Time() ? 1_ns : 0_ns;
      return {.begin = now + gap, .end = now + 1_s};
    }
  };
  Simulation simulation({.end = at_s(10)});
  Gappy gappy;
  Places places(2, 100.0, 50.0);
  const Movement movement(simulation, places, gappy);
  const RunEnd end = simulation.run();
  EXPECT_FALSE(end.ok());
  EXPECT_EQ(end.message,
            "agent 1 failed at 1.000000000 s: the legs of a path do not follow each other");
}

TEST(Movement, WhoIsSteeredLeavesItsPathAndStaysWhereTheLegEnds) {
  Simulation simulation({.end = at_s(100)});
  Motions motions(2, wanderers(20.0));
  Path path(wanderers(20.0)(1));
  Places places(2, 100.0, 50.0);
  Movement movement(simulation, places, motions);
  Point turned{};
  const auto expect_at = [&](double t_s, AgentId agent, const auto& place) {
    simulation.schedule(at_s(t_s), Phase::observe, [&, agent, place] {
      const Point expected = place();
      const Point found = places.at(agent, simulation.now());
      EXPECT_LT(squared_distance_m2(found, expected), 1e-18);
      const auto seen = places.around(expected, 1.0, simulation.now());
      EXPECT_TRUE(std::any_of(seen.begin(), seen.end(),
                              [&](const Nearby& near) { return near.agent == agent; }));
    });
  };
  simulation.schedule(at_s(20.5), Phase::act, [&] {
    turned = places.at(0, simulation.now());
    const Point to = {turned[0] + 30.0, turned[1] - 40.0, turned[2]};
    movement.steer(0, motion::leg_to(simulation.now(), turned, to, 5.0));
  });
  expect_at(25.5, 0, [&] { return Point{turned[0] + 15.0, turned[1] - 20.0, turned[2]}; });
  expect_at(31.0, 0, [&] { return Point{turned[0] + 30.0, turned[1] - 40.0, turned[2]}; });
  expect_at(60.0, 0, [&] { return Point{turned[0] + 30.0, turned[1] - 40.0, turned[2]}; });
  simulation.schedule(at_s(70), Phase::act, [&] {  // on again, and stopped half-way
    const Point here = places.at(0, simulation.now());
    movement.steer(0, motion::leg_to(simulation.now(), here, turned, 10.0));
  });
  simulation.schedule(at_s(72.5), Phase::act, [&] {
    movement.steer(0, {.begin = simulation.now(), .from_m = places.at(0, simulation.now())});
  });
  expect_at(99.0, 0, [&] { return Point{turned[0] + 15.0, turned[1] - 20.0, turned[2]}; });
  expect_at(99.5, 1, [&] { return path.at(at_s(99.5)); });  // nobody steered the other
  const RunEnd end = simulation.run();
  EXPECT_TRUE(end.ok()) << end.message;
}

TEST(Movement, NobodyIsSteeredFromWhereItIsNot) {
  Simulation simulation({.end = at_s(10)});
  Motions motions(1, wanderers(20.0));
  Places places(1, 100.0, 50.0);
  Movement movement(simulation, places, motions);
  const Point here = places.at(0, Time());
  const Point beside = {here[0] + 0.01, here[1], here[2]};
  EXPECT_THROW(movement.steer(0, {.begin = Time(), .from_m = beside}), BrokenInvariant);
  EXPECT_THROW(movement.steer(0, {.begin = at_s(1), .from_m = here}), BrokenInvariant);
  EXPECT_THROW(movement.steer(0, {.begin = Time(), .end = Time(), .from_m = here}),
               BrokenInvariant);
  EXPECT_THROW(motion::leg_to(Time(), here, beside, 0.0), BrokenInvariant);
  EXPECT_THROW(motion::leg_to(Time(), here, here, 1.0), BrokenInvariant);
  EXPECT_THROW(motion::leg_to(Time(), here, {1e13, 0.0, 0.0}, 1.0), BrokenInvariant);
}

TEST(Movement, NothingIsAllocatedInSteadyState) {
  constexpr int agents = 500;
  Simulation simulation({.end = at_s(60)});
  Motions motions(agents, roamers(15.0));
  Places places(agents, 40.0, 10.0);
  const Movement movement(simulation, places, motions);
  std::size_t found = 0, counted[2] = {}, found_by[2] = {};
  const std::function<void()> look = [&] {
    for (AgentId a = 0; a < agents; a += 10) found += places.near(a, simulation.now()).size();
    simulation.schedule(simulation.now() + 50_ms, Phase::update, [&] { look(); });
  };
  simulation.schedule(Time(), Phase::update, [&] { look(); });
  for (const std::size_t i : {0u, 1u}) {
    simulation.schedule(at_s(i == 0 ? 20 : 60), Phase::observe, [&, i] {
      counted[i] = memory::allocations();
      found_by[i] = found;
    });
  }
  EXPECT_TRUE(simulation.run().ok());
  EXPECT_GT(found_by[1], found_by[0] + 10'000);
  EXPECT_EQ(counted[1], counted[0]);
}

}  // namespace
}  // namespace hearsay
