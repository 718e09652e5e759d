// Where exploring vehicles get to over many moves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "agents/behaviours/exploration.hpp"
#include "filters/grid/bernoulli.hpp"
#include "tests/agents/behaviours/samples.hpp"

namespace hearsay {
namespace {

using namespace exploring;

/// 10,000 steps at constant speed: turns within their limit, outside only if there is no other way,
/// and no farther out than the bound. Returns the farthest, in bounds.
double farthest_out(const Area& area, const Options& options, const Exploration::Gain& gain,
                    Stream& draws) {
  const Exploration exploration(options, area);
  const double turn_max = options.turn_max_rad, cell = area.cell_m();
  const double bound = cell / std::sin(turn_max / 2);
  State s = in_cell(area, area.columns() / 2, area.rows() / 2, draws.uniform(-pi, pi));
  double farthest = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const State next = exploration.next(s, gain, draws);
    EXPECT_LE(std::abs(wrapped(next.heading_rad - s.heading_rad)), turn_max + 1e-12);
    EXPECT_TRUE(next.heading_rad > -pi && next.heading_rad <= pi);
    EXPECT_NEAR(distance(next.place_m, s.place_m), cell, 1e-12);
    EXPECT_NEAR(
        wrapped(std::atan2(next.place_m.y_m - s.place_m.y_m, next.place_m.x_m - s.place_m.x_m) -
                next.heading_rad),
        0.0, 1e-12);
    const double out = outside_m(area, next.place_m);
    if (out > 0.0) {
      for (int k = 0; k < options.headings; ++k) {
        const double h = s.heading_rad + turn_max * (2.0 * k / (options.headings - 1) - 1.0);
        const grid::Point p{s.place_m.x_m + cell * std::cos(h), s.place_m.y_m + cell * std::sin(h)};
        EXPECT_FALSE(area.at(p) && outside_m(area, p) == 0.0);
      }
    }
    farthest = std::max(farthest, out);
    s = next;
  }
  EXPECT_LE(farthest, bound + 1e-9);
  return farthest / bound;
}

TEST(ExplorationPaths, AtConstantSpeedItComesBackFromTheBorder) {
  Stream draws = stream(9);
  // All that there is to see is to the right, beyond the area.
  const auto tempting = [](const State& s) { return s.place_m.x_m; };
  double farthest = 0.0;
  for (const Area& area : {cells(1, 1), cells(3, 2), cells(40, 1, 0.5), cells(16, 12, 1, {5, 5})}) {
    for (const double turn_max : {0.1, 0.5, 1.5, 3.1}) {
      for (const Choice choice : {Choice::gain, Choice::random_walk}) {
        const Options options{.choice = choice,
                              .vehicle = Vehicle::constant_speed,
                              .turn_max_rad = turn_max,
                              .headings = 3 + 4 * (turn_max > 1)};
        farthest = std::max(farthest, farthest_out(area, options, tempting, draws));
      }
    }
  }
  EXPECT_GT(farthest, 0.5);  // the bound is not idle
}

TEST(ExplorationPaths, OutsideItTurnsToTheCentreByTheShorterWay) {
  const Area area = cells(16, 12, 2.0, {-16.0, -12.0});
  const Exploration exploration({.vehicle = Vehicle::constant_speed, .turn_max_rad = 0.5}, area);
  const auto zero = [](const State&) { return 0.0; };
  Stream draws = stream(13);
  for (int i = 0; i < 200; ++i) {
    const double bearing = draws.uniform(-pi, pi), off = draws.uniform(-pi, pi);
    const State here{{-40 * std::cos(bearing), -40 * std::sin(bearing)}, wrapped(bearing + off)};
    const double turn = wrapped(exploration.next(here, zero, draws).heading_rad - here.heading_rad);
    EXPECT_NEAR(turn, std::abs(off) < 0.5 ? -off : std::copysign(0.5, -off), 1e-12);
  }
}

TEST(ExplorationPaths, AnExcursionEndsAfterOneTurnAndTheWayBack) {
  // Where the area has room for the circle, here of 4 cells, in the middle.
  const Area area = cells(16, 12);
  const Options options{
      .choice = Choice::random_walk, .vehicle = Vehicle::constant_speed, .turn_max_rad = 0.5};
  const Exploration exploration(options, area);
  Stream draws = stream(10);
  int longest = 0, now = 0;
  State s = in_cell(area, 8, 6);
  for (int i = 0; i < 20000; ++i) {
    s = exploration.next(
        s, [](const State&) { return 0.0; }, draws);
    now = area.at(s.place_m) ? 0 : now + 1;
    longest = std::max(longest, now);
  }
  EXPECT_GT(longest, 0);
  EXPECT_LE(longest, 2 * pi / 0.5 + 1 / std::sin(0.25) + 2);
}

/// Steps until every cell of 20 × 20 was in view.
int steps_to_cover(Choice choice, std::uint64_t seed) {
  const Area area = cells(20, 20);
  grid::BernoulliGrid map(area);
  const grid::Detector detector{0.98, 0.02};
  std::vector<grid::CellInView> seen;
  const auto look = [&](const State& s) {
    seen.clear();
    for (const int k : view(area, s.place_m)) seen.push_back({k, detector});
  };
  const auto gain = [&](const State& s) {
    look(s);
    return grid::expected_gain(map, seen);
  };
  const Exploration exploration({.choice = choice, .horizon = 3}, area);
  Stream draws = stream(seed);
  State s = in_cell(area, 3, 4);
  for (int steps = 0;; ++steps) {
    look(s);
    for (const grid::CellInView& c : seen) map.add(c.cell, log_likelihood_ratio(detector, 0.0));
    const auto evidence = map.evidence();
    if (std::count(evidence.begin(), evidence.end(), 0.0f) == 0) return steps;
    if (steps == 20000) return steps;
    s = exploration.next(s, gain, draws);
  }
}

TEST(ExplorationPaths, CoversAnAreaInFarFewerStepsThanARandomWalk) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const int greedy = steps_to_cover(Choice::gain, seed);
    const int random = steps_to_cover(Choice::random_walk, seed);
    EXPECT_LT(greedy, 300);
    EXPECT_LT(5 * greedy, random);
    RecordProperty("greedy", greedy);
    RecordProperty("random", random);
  }
}

}  // namespace
}  // namespace hearsay
