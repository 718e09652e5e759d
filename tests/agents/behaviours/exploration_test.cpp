#include "agents/behaviours/exploration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "sim/kernel/error.hpp"
#include "tests/agents/behaviours/samples.hpp"
#include "tools/memory/memory.hpp"

namespace hearsay {
namespace {

using namespace exploring;

/// χ² of counts that are expected to be equal.
double chi_squared(const std::map<int, int>& counts, std::size_t kinds, int draws) {
  const double expected = static_cast<double>(draws) / static_cast<double>(kinds);
  double sum = expected * static_cast<double>(kinds - counts.size());
  for (const auto& [kind, count] : counts)
    sum += (count - expected) * (count - expected) / expected;
  return sum;
}

double entropy(double p) { return -p * std::log(p) - (1 - p) * std::log(1 - p); }

/// A land where all is nearly known but a patch; eq. 4.21–4.23 as they stand.
struct Land {
  Area area = cells(14, 9, 2.5, {-7.0, 3.0});
  std::vector<double> belief = std::vector<double>(14 * 9, 0.01);
  Land() {
    for (const int k : {64, 65, 66, 79, 80, 93, 25, 26}) belief[static_cast<std::size_t>(k)] = 0.5;
    for (int k = 0; k < 14 * 9; k += 5) belief[static_cast<std::size_t>(k)] = 0.02 + 0.0007 * k;
  }
  double gain(grid::Point from) const {
    double sum = 0.0;
    for (const int k : view(area, from)) {
      const double p = belief[static_cast<std::size_t>(k)], pd = 0.9, pf = 0.05;
      const double detect = pd * p + pf * (1 - p);
      sum += entropy(p) - detect * entropy(pd * p / detect) -
             (1 - detect) * entropy((1 - pd) * p / (1 - detect));
    }
    return sum;
  }
};

/// What a test thinks of a candidate.
struct Candidate {
  State to;
  double worth;
};
/// True, and `best` set, if one is the best by a margin.
bool one_is_best(const std::vector<Candidate>& candidates, Candidate& best) {
  double second = -1e9;
  best = {{}, -1e9};
  for (const Candidate& c : candidates) {
    if (c.worth > best.worth) {
      second = best.worth;
      best = c;
    } else {
      second = std::max(second, c.worth);
    }
  }
  return best.worth > second + 1e-9;
}

TEST(Exploration, HolonomicMovesAreThoseOfBruteForce) {
  const Land land;
  const auto gain = [&](const State& s) { return land.gain(s.place_m); };
  Stream draws = stream(1);
  for (const int horizon : {1, 2, 6}) {
    for (const double beta : {0.0, 0.3}) {
      const Options options{.horizon = horizon, .weights = {.gain = 2.0, .cost = beta}};
      const Exploration exploration(options, land.area);
      int clear = 0;
      for (int k = 0; k < land.area.cells(); ++k) {
        const grid::Cell c = land.area.cell(k);
        const double heading = 0.1 + k % 3;
        std::vector<Candidate> all{
            {{land.area.centre(k), heading}, 2.0 * land.gain(land.area.centre(k))}};
        for (int dx = -1; dx <= 1; ++dx) {
          for (int dy = -1; dy <= 1; ++dy) {
            if (dx == 0 && dy == 0) continue;
            double sum = 0.0;
            int looks = 0;
            for (int n = 1; n <= horizon; ++n) {
              const grid::Cell there{c.column + n * dx, c.row + n * dy};
              if (!land.area.has(there)) break;
              sum += land.gain(land.area.centre(land.area.number(there)));
              ++looks;
            }
            if (looks == 0) continue;
            const State to = in_cell(land.area, c.column + dx, c.row + dy, std::atan2(dy, dx));
            const double cost =
                std::sqrt(dx * dx + dy * dy) + std::abs(wrapped(to.heading_rad - heading)) / pi;
            all.push_back({to, 2.0 * sum - beta * cost});
          }
        }
        Candidate best{};
        if (!one_is_best(all, best)) continue;
        ++clear;
        const State next = exploration.next({land.area.centre(k), heading}, gain, draws);
        EXPECT_EQ(land.area.at(next.place_m), land.area.at(best.to.place_m)) << k;
        EXPECT_LT(distance(next.place_m, best.to.place_m), 1e-12);
        EXPECT_NEAR(next.heading_rad, best.to.heading_rad, 1e-15);
      }
      EXPECT_GT(clear, 100);
    }
  }
}

TEST(Exploration, ConstantSpeedMovesAreThoseOfBruteForce) {
  const Land land;
  const auto gain = [&](const State& s) { return land.gain(s.place_m); };
  Stream draws = stream(2);
  const double cell = land.area.cell_m();
  for (const int horizon : {1, 4}) {
    for (const double beta : {0.0, 0.3}) {
      const Options options{.vehicle = Vehicle::constant_speed,
                            .turn_max_rad = 1.2,
                            .headings = 7,
                            .horizon = horizon,
                            .weights = {.cost = beta}};
      const Exploration exploration(options, land.area);
      int clear = 0;
      for (int trial = 0; trial < 150; ++trial) {
        const State here{{draws.uniform(-7.0, 28.0), draws.uniform(3.0, 25.5)},
                         draws.uniform(-pi, pi)};
        std::vector<Candidate> all;
        for (int i = -3; i <= 3; ++i) {
          const double h = here.heading_rad + 0.4 * i;
          double sum = 0.0;
          int looks = 0;
          for (int n = 1; n <= horizon; ++n) {
            const grid::Point p{here.place_m.x_m + n * cell * std::cos(h),
                                here.place_m.y_m + n * cell * std::sin(h)};
            if (outside_m(land.area, p) > 0.0) break;
            sum += land.gain(p);
            ++looks;
          }
          const grid::Point end{here.place_m.x_m + cell * std::cos(h),
                                here.place_m.y_m + cell * std::sin(h)};
          if (looks > 0) {
            all.push_back({{end, wrapped(h)}, sum - beta * (1 + std::abs(0.4 * i) / pi)});
          }
        }
        Candidate best{};
        if (all.empty() || !one_is_best(all, best)) continue;
        ++clear;
        const State next = exploration.next(here, gain, draws);
        EXPECT_LT(distance(next.place_m, best.to.place_m), 1e-12);
        EXPECT_NEAR(next.heading_rad, best.to.heading_rad, 1e-12);
      }
      EXPECT_GT(clear, 90);
    }
  }
}

TEST(Exploration, WhereGainsAreEqualTheShorterAndStraighterMoveIsMade) {
  const Area area = cells(9, 9);
  Stream draws = stream(3);
  const State here = in_cell(area, 4, 4);
  double more_up = 0.0;
  const auto gain = [&](const State& s) {
    if (distance(s.place_m, here.place_m) < 0.5) return 0.0;
    return s.place_m.y_m > 5 && std::abs(s.place_m.x_m - 4.5) < 0.5 ? 1.0 + more_up : 1.0;
  };
  const auto known = [](const State&) { return 0.0; };
  const Exploration holonomic({.weights = {.cost = 0.1}}, area);
  for (int i = 0; i < 30; ++i) {
    EXPECT_EQ(area.at(holonomic.next(here, gain, draws).place_m), area.number({5, 4}));
    // Turned by π/4 it costs √2 to go on, and 1 + ¼ to one of the two sides.
    const State slanted{here.place_m, pi / 4};
    const int to = *area.at(holonomic.next(slanted, gain, draws).place_m);
    EXPECT_TRUE(to == area.number({5, 4}) || to == area.number({4, 5})) << to;
    // Nothing to be gained: it stays, and looks where it looked.
    const State stays = holonomic.next({here.place_m, -2.0}, known, draws);
    EXPECT_EQ(area.at(stays.place_m), area.number({4, 4}));
    EXPECT_EQ(stays.heading_rad, -2.0);
  }
  // A right angle costs 0.1·½.
  more_up = 0.049;
  EXPECT_EQ(holonomic.next(here, gain, draws).heading_rad, 0.0);
  more_up = 0.051;
  EXPECT_NEAR(holonomic.next(here, gain, draws).heading_rad, pi / 2, 1e-15);

  const Exploration straight(
      {.vehicle = Vehicle::constant_speed, .horizon = 3, .weights = {.cost = 1e-6}}, area);
  State s = in_cell(area, 0, 4);
  for (int i = 1; i <= 8; ++i) {
    s = straight.next(s, known, draws);
    EXPECT_NEAR(s.place_m.x_m, 0.5 + i, 1e-12);
    EXPECT_EQ(s.place_m.y_m, 4.5);
  }
}

TEST(Exploration, AHorizonShowsWhatAGreedyStepDoesNot) {
  const Area area = cells(21, 21);
  Stream draws = stream(4);
  const auto gain = [&](const State& s) {
    return area.at(s.place_m) == area.number({10, 15}) ? 1.0 : 0.0;
  };
  for (const Vehicle vehicle : {Vehicle::holonomic, Vehicle::constant_speed}) {
    for (const int horizon : {1, 4, 5, 21}) {
      const Options options{.vehicle = vehicle, .turn_max_rad = pi / 2, .horizon = horizon};
      const Exploration exploration(options, area);
      int towards = 0;
      for (int i = 0; i < 45; ++i) {
        const State next = exploration.next(in_cell(area, 10, 10), gain, draws);
        towards += area.at(next.place_m) == area.number({10, 11});
      }
      if (horizon >= 5) {
        EXPECT_EQ(towards, 45) << horizon;
      } else {
        EXPECT_LT(towards, 25) << horizon;  // one way of 9 or of 5
      }
    }
  }
}

TEST(Exploration, LooksCountAsFarAsTheAreaGoesAndOnceFromOnePlace) {
  const Area area = cells(11, 11);
  Stream draws = stream(5);
  const auto same = [](const State&) { return 1.0; };
  std::map<int, int> chosen;
  const Exploration exploration({.horizon = 3}, area);
  for (int i = 0; i < 400; ++i) {
    ++chosen[*area.at(exploration.next(in_cell(area, 1, 5), same, draws).place_m)];
  }
  // To the right there are three looks; up and down, too; to the left and in place one.
  EXPECT_EQ(chosen.size(), 5u);
  for (const auto& [k, count] : chosen) EXPECT_GE(area.cell(k).column, 1) << count;
  EXPECT_EQ(chosen.count(area.number({1, 5})), 0u);
}

TEST(Exploration, HolonomicLooksAreFromTheCentresOfCells) {
  const Area area = cells(40, 40, 0.3, {0.1, -0.7});
  Stream draws = stream(14);
  int looks = 0;
  const auto gain = [&](const State& s) {
    const grid::Point centre = area.centre(*area.at(s.place_m));
    EXPECT_EQ(s.place_m.x_m, centre.x_m);
    EXPECT_EQ(s.place_m.y_m, centre.y_m);
    ++looks;
    return 0.0;
  };
  const Exploration exploration({.horizon = 15}, area);
  exploration.next(in_cell(area, 20, 19), gain, draws);
  EXPECT_EQ(looks, 8 * 15 + 1);
}

TEST(Exploration, EqualMovesAreEquallyLikely) {
  const Area area = cells(11, 11, 0.3, {1e6, -1e6});
  Stream draws = stream(6);
  // Nothing to be gained anywhere, and gains that differ by less than the tolerance.
  for (const double off : {0.0, 1e-14}) {
    const auto gain = [&](const State& s) {
      return off > 0 ? 3.0 + off * *area.at(s.place_m) / 99 : 0.0;
    };
    std::map<int, int> moves, turns;
    const Exploration holonomic({}, area);
    const Exploration onward({.vehicle = Vehicle::constant_speed, .turn_max_rad = 2.0}, area);
    for (int i = 0; i < 8000; ++i) {
      ++moves[*area.at(holonomic.next(in_cell(area, 5, 5), gain, draws).place_m)];
      const State next = onward.next(in_cell(area, 5, 5), gain, draws);
      ++turns[static_cast<int>(std::lround(next.heading_rad))];
    }
    EXPECT_LT(chi_squared(moves, 9, 8000), 26.1);  // 8 degrees of freedom, 0.1 %
    EXPECT_LT(chi_squared(turns, 5, 8000), 18.5);  // 4
    EXPECT_EQ(moves.size(), 9u);
    EXPECT_EQ(turns.size(), 5u);
  }
}

TEST(Exploration, WhereOneMoveIsBestNothingIsDrawn) {
  const Area area = cells(11, 11);
  const auto gain = [&](const State& s) { return 1.0 + 1e-9 * *area.at(s.place_m); };
  Stream draws = stream(7), untouched = draws;
  const Exploration exploration({}, area);
  const State next = exploration.next(in_cell(area, 5, 5), gain, draws);
  EXPECT_EQ(area.at(next.place_m), area.number({6, 6}));
  EXPECT_EQ(draws.bits(), untouched.bits());
}

TEST(Exploration, ARandomWalkIsEvenOverTheNeighboursAndConfined) {
  const Area area = cells(5, 3);
  Stream draws = stream(8);
  const auto never = [](const State&) -> double { throw 0; };
  const Exploration walk({.choice = Choice::random_walk}, area);
  std::map<int, int> middle, corner;
  for (int i = 0; i < 8000; ++i) {
    ++middle[*area.at(walk.next(in_cell(area, 2, 1), never, draws).place_m)];
    ++corner[*area.at(walk.next(in_cell(area, 4, 2), never, draws).place_m)];
  }
  EXPECT_EQ(middle.count(area.number({2, 1})), 0u);
  EXPECT_LT(chi_squared(middle, 8, 8000), 24.4);  // 7 degrees of freedom, 0.1 %
  EXPECT_EQ(corner.count(area.number({4, 2})), 0u);
  EXPECT_LT(chi_squared(corner, 3, 8000), 13.9);  // 2
  State s{{0.2, 0.9}, 0.0};
  std::map<int, int> visits;
  for (int i = 0; i < 10000; ++i) {
    const State next = walk.next(s, never, draws);
    const double dx = next.place_m.x_m - s.place_m.x_m, dy = next.place_m.y_m - s.place_m.y_m;
    if (i > 0) {
      EXPECT_NEAR(next.heading_rad, std::atan2(dy, dx), 1e-12);
      EXPECT_NEAR(std::max(std::abs(dx), std::abs(dy)), 1.0, 1e-12);
    }
    s = next;
    ASSERT_TRUE(area.at(s.place_m));
    ++visits[*area.at(s.place_m)];
  }
  EXPECT_EQ(visits.size(), 15u);
  const Exploration confined({.choice = Choice::random_walk}, cells(1, 1));
  EXPECT_EQ(confined.next({{0.3, 0.6}, 1.0}, never, draws).place_m.x_m, 0.3);
}

TEST(Exploration, AllocatesNothing) {
  const Area area = cells(9, 9);
  Stream draws = stream(11);
  const std::vector<double> many(100, 0.5);
  double a = 1, b = 2, c = 3;  // more than a std::function holds without storage of its own
  const auto gain = [&](const State& s) { return a * s.place_m.x_m + b + c * many[7]; };
  for (const Vehicle vehicle : {Vehicle::holonomic, Vehicle::constant_speed}) {
    const Exploration exploration({.vehicle = vehicle, .horizon = 4}, area);
    State s = in_cell(area, 4, 4);
    const std::size_t before = memory::allocations();
    for (int i = 0; i < 100; ++i) s = exploration.next(s, gain, draws);
    EXPECT_EQ(memory::allocations(), before);
  }
}

TEST(Exploration, RefusesWhatMakesNoSense) {
  const Area area = cells(4, 4);
  Stream draws = stream(12);
  for (const Options& options :
       {Options{.turn_max_rad = 0.0}, Options{.turn_max_rad = pi}, Options{.headings = 1},
        Options{.headings = 4}, Options{.headings = 65}, Options{.horizon = 0},
        Options{.horizon = 5000}, Options{.weights = {.gain = -1.0}},
        Options{.weights = {.cost = INFINITY}}}) {
    EXPECT_THROW(Exploration(options, area), BrokenInvariant);
  }
  const auto zero = [](const State&) { return 0.0; };
  const auto undefined = [](const State&) { return NAN; };
  const Exploration exploration({}, area);
  EXPECT_THROW(exploration.next(in_cell(area, 1, 1), undefined, draws), BrokenInvariant);
  EXPECT_THROW(exploration.next({{4.5, 1.0}, 0.0}, zero, draws), BrokenInvariant);
  EXPECT_THROW(exploration.next({{1.0, 1.0}, NAN}, zero, draws), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
