#include "sim/world/differential_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::drive {
namespace {

TEST(DifferentialDrive, AQuarterOfACircleEndsWhereGeometrySays) {
  // Radius v/ω = 2 m, from (1, 0) to the north: the centre is at (−1, 0).
  const Pose end = driven({1.0, 0.0, 0.5 * math::pi}, {1.0, 0.5}, math::pi);
  EXPECT_NEAR(end.x_m, -1.0, 1e-12);
  EXPECT_NEAR(end.y_m, 2.0, 1e-12);
  EXPECT_NEAR(std::fabs(end.heading_rad), math::pi, 1e-12);
}

TEST(DifferentialDrive, StraightAheadTurningOnTheSpotAndBackwards) {
  const Pose ahead = driven({1.0, 2.0, 0.0}, {0.5, 0.0}, 4.0);
  EXPECT_DOUBLE_EQ(ahead.x_m, 3.0);
  EXPECT_DOUBLE_EQ(ahead.y_m, 2.0);
  const Pose turned = driven({1.0, 2.0, 3.0}, {0.0, 1.0}, 1.0);
  EXPECT_DOUBLE_EQ(turned.x_m, 1.0);
  EXPECT_NEAR(turned.heading_rad, 4.0 - 2.0 * math::pi, 1e-12);
  const Pose back = driven(driven({0.0, 0.0, 0.4}, {0.7, 0.3}, 2.0), {-0.7, -0.3}, 2.0);
  EXPECT_NEAR(back.x_m, 0.0, 1e-14);
  EXPECT_NEAR(back.y_m, 0.0, 1e-14);
  EXPECT_NEAR(back.heading_rad, 0.4, 1e-14);
}

TEST(DifferentialDrive, ManySmallStepsMakeOneLargeOne) {
  Pose steps{0.0, 0.0, -2.0};
  for (int i = 0; i < 1000; ++i) steps = driven(steps, {1.2, 0.7}, 0.01);
  const Pose once = driven({0.0, 0.0, -2.0}, {1.2, 0.7}, 10.0);
  EXPECT_NEAR(steps.x_m, once.x_m, 1e-11);
  EXPECT_NEAR(steps.y_m, once.y_m, 1e-11);
  EXPECT_NEAR(steps.heading_rad, once.heading_rad, 1e-11);
}

TEST(DifferentialDrive, AVerySlowTurnIsNoJump) {
  // On both sides of where the series takes over.
  for (const double turn : {1.9e-4, 2.1e-4}) {
    const Pose end = driven({}, {1.0, turn}, 1.0);
    EXPECT_NEAR(end.x_m, math::sin(turn) / turn, 1e-15);
    EXPECT_NEAR(end.y_m, 2.0 * math::sin(0.5 * turn) * math::sin(0.5 * turn) / turn, 1e-15);
  }
}

TEST(DifferentialDrive, CommandsKeepToSpeedsAndAccelerations) {
  const Limits limits{.speed_max_m_per_s = 0.5, .turn_max_rad_per_s = 1.0};
  EXPECT_DOUBLE_EQ(limited({2.0, -3.0}, {}, limits, 0.1).forward_m_per_s, 0.5);
  EXPECT_DOUBLE_EQ(limited({2.0, -3.0}, {}, limits, 0.1).turn_rad_per_s, -1.0);
  Limits slow = limits;
  slow.acceleration_max_m_per_s2 = 1.0;
  slow.turn_acceleration_max_rad_per_s2 = 4.0;
  const Command next = limited({2.0, -3.0}, {0.2, 0.1}, slow, 0.1);
  EXPECT_NEAR(next.forward_m_per_s, 0.3, 1e-15);
  EXPECT_NEAR(next.turn_rad_per_s, -0.3, 1e-15);
  EXPECT_THROW(limited({NAN, 0.0}, {}, limits, 0.1), BrokenInvariant);
  EXPECT_THROW(limited({}, {}, limits, 0.0), BrokenInvariant);
}

TEST(DifferentialDrive, RelativeToUndoesAFrame) {
  const Pose seen = relative_to({1.0, 1.0, 0.5 * math::pi}, {1.0, 3.0, math::pi});
  EXPECT_NEAR(seen.x_m, 2.0, 1e-15);
  EXPECT_NEAR(seen.y_m, 0.0, 1e-15);
  EXPECT_NEAR(seen.heading_rad, 0.5 * math::pi, 1e-15);
}

TEST(Odometer, WithoutErrorsItKnowsTheWay) {
  Odometer odometer({.start = {0.0, 0.0, 0.3}}, 1, 0);
  Pose truth{0.0, 0.0, 0.3};
  for (int i = 0; i < 50; ++i) {
    const Command c{0.3 + 0.01 * i, 0.5 - 0.02 * i};
    odometer.drove(c, 0.1);
    truth = driven(truth, c, 0.1);
  }
  EXPECT_EQ(odometer.pose().x_m, truth.x_m);
  EXPECT_EQ(odometer.pose().y_m, truth.y_m);
  EXPECT_EQ(odometer.pose().heading_rad, truth.heading_rad);
}

TEST(Odometer, WhoIsToldWhereItIsGoesOnFromThereWithItsErrors) {
  Odometer told({.forward_bias = 0.2, .turn_bias = 0.3}, 1, 4);
  Odometer fresh({.start = {3.0, -2.0, 2.5}, .forward_bias = 0.2, .turn_bias = 0.3}, 1, 4);
  told.drove({0.7, 0.4}, 3.0);
  told.set({3.0, -2.0, 2.5});
  EXPECT_EQ(told.pose().x_m, 3.0);
  EXPECT_EQ(told.pose().y_m, -2.0);
  EXPECT_EQ(told.pose().heading_rad, 2.5);
  EXPECT_NE(told.forward_bias(), 0.0);
  for (Odometer* odometer : {&told, &fresh}) odometer->drove({0.5, -0.3}, 2.0);
  EXPECT_EQ(told.pose().x_m, fresh.pose().x_m);
  EXPECT_EQ(told.pose().y_m, fresh.pose().y_m);
  EXPECT_EQ(told.pose().heading_rad, fresh.pose().heading_rad);
}

TEST(Odometer, ABiasIsDrawnOnceAndIsInProportion) {
  const Odometer::Options options{.forward_bias = 0.03, .turn_bias = 0.05};
  double sum = 0.0, squares = 0.0;
  constexpr int robots = 4000;
  for (AgentId robot = 0; robot < robots; ++robot) {
    Odometer odometer(options, 7, robot);
    odometer.drove({1.0, 0.0}, 10.0);
    EXPECT_NEAR(odometer.pose().x_m, 10.0 * (1.0 + odometer.forward_bias()), 1e-12);
    odometer.drove({0.0, 1.0}, 2.0);
    EXPECT_NEAR(odometer.pose().heading_rad, 2.0 * (1.0 + odometer.turn_bias()), 1e-12);
    EXPECT_LE(std::fabs(odometer.forward_bias()), 0.015);
    EXPECT_LE(std::fabs(odometer.turn_bias()), 0.025);
    sum += odometer.turn_bias();
    squares += odometer.turn_bias() * odometer.turn_bias();
  }
  // Even in ±E/2: mean 0, variance E²/12; four standard errors.
  const double variance = 0.05 * 0.05 / 12.0;
  EXPECT_NEAR(sum / robots, 0.0, 4.0 * std::sqrt(variance / robots));
  EXPECT_NEAR(squares / robots, variance, 4.0 * variance * std::sqrt(0.8 / robots));
}

TEST(Odometer, ARandomWalkGrowsWithTheWayWhateverTheSteps) {
  for (const int steps : {1, 20}) {
    double heading = 0.0, along = 0.0;
    constexpr int robots = 4000;
    for (AgentId robot = 0; robot < robots; ++robot) {
      Odometer walk({.forward_m_per_sqrt_m = 0.02, .turn_rad_per_sqrt_m = 0.001}, 3, robot);
      for (int i = 0; i < steps; ++i) walk.drove({1.0, 0.0}, 9.0 / steps);
      heading += walk.pose().heading_rad * walk.pose().heading_rad;
      along += (walk.pose().x_m - 9.0) * (walk.pose().x_m - 9.0);
    }
    // After 9 m: 0.001²·9 and 0.02²·9; a variance of n draws is off by √(2/n).
    const double tolerance = 4.0 * std::sqrt(2.0 / robots);
    EXPECT_NEAR(heading / robots / (0.001 * 0.001 * 9.0), 1.0, tolerance) << steps;
    EXPECT_NEAR(along / robots / (0.02 * 0.02 * 9.0), 1.0, tolerance) << steps;
  }
}

TEST(Odometer, ItIsTheSameAgainAndAnotherForOthers) {
  const Odometer::Options options{
      .forward_bias = 0.03, .turn_bias = 0.05, .turn_rad_per_sqrt_rad = 0.01};
  Odometer a(options, 1, 4), again(options, 1, 4), other(options, 1, 5);
  for (int i = 0; i < 5; ++i) {
    for (Odometer* o : {&a, &again, &other}) o->drove({0.5, 0.4}, 0.1);
  }
  EXPECT_EQ(a.pose().x_m, again.pose().x_m);
  EXPECT_NE(a.pose().heading_rad, other.pose().heading_rad);
  EXPECT_THROW(Odometer({.turn_bias = 2.0}, 1, 0), BrokenInvariant);
  EXPECT_THROW(Odometer({.turn_rad_per_sqrt_m = -0.1}, 1, 0), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::drive
