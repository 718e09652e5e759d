#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>
#include <vector>

#include "agents/journey.hpp"

namespace hearsay {
namespace {

using testing::ElementsAre;

/// (until, forward, turn, dt).
using Piece = std::tuple<double, double, double, double>;

std::vector<Piece> advance(Odometer& odometer, Time now) {
  std::vector<Piece> pieces;
  odometer.advance(now, [&](Time until, double forward, double turn, double dt_s) {
    pieces.emplace_back(until.seconds(), forward, turn, dt_s);
  });
  return pieces;
}

const std::vector<Drive> drives = {
    {Time::at(1_s), 0.5, 0.1}, {Time::at(3_s), 0.25, -0.1}, {Time::at(10_s), 9.0, 9.0}};

TEST(Odometer, EachPieceHasTheVelocitiesUntilTheNextSampleHoweverLong) {
  Odometer odometer(drives);
  EXPECT_THAT(advance(odometer, Time::at(8_s)),
              ElementsAre(Piece(1, 0, 0, 1), Piece(3, 0.5, 0.1, 2), Piece(8, 0.25, -0.1, 5)));
}

TEST(Odometer, BeforeTheFirstSampleAndAfterTheLastItStandsStill) {
  Odometer odometer(drives);
  EXPECT_THAT(advance(odometer, Time::at(500_ms)), ElementsAre(Piece(0.5, 0, 0, 0.5)));
  advance(odometer, Time::at(10_s));
  EXPECT_THAT(advance(odometer, Time::at(12_s)), ElementsAre(Piece(12, 0, 0, 2)));
  Odometer none({});
  EXPECT_THAT(advance(none, Time::at(2_s)), ElementsAre(Piece(2, 0, 0, 2)));
}

TEST(Odometer, HoweverOftenItIsAskedThePiecesAddUpToTheSame) {
  Odometer once(drives), often(drives);
  double way_once = 0.0, way_often = 0.0, turn_once = 0.0, turn_often = 0.0, time = 0.0;
  once.advance(Time::at(12_s), [&](Time, double forward, double turn, double dt_s) {
    way_once += forward * dt_s;
    turn_once += turn * dt_s;
  });
  for (int ms = 0; ms <= 12'000; ms += 7) {
    often.advance(Time() + 1_ms * ms, [&](Time until, double forward, double turn, double dt_s) {
      EXPECT_GT(dt_s, 0.0);
      time += dt_s;
      EXPECT_NEAR(until.seconds(), time, 1e-9);
      way_often += forward * dt_s;
      turn_often += turn * dt_s;
    });
  }
  EXPECT_DOUBLE_EQ(way_once, 0.5 * 2 + 0.25 * 7);
  EXPECT_NEAR(way_often, way_once, 1e-12);
  EXPECT_NEAR(turn_often, turn_once, 1e-12);
}

TEST(Odometer, AskedTwiceAtOneInstantThereIsNothingMore) {
  Odometer odometer(drives);
  advance(odometer, Time::at(3_s));
  EXPECT_THAT(advance(odometer, Time::at(3_s)), ElementsAre());
  EXPECT_THAT(advance(odometer, Time::at(3_s) + 1_ms), ElementsAre(Piece(3.001, 0.25, -0.1, 1e-3)));
}

TEST(Odometer, ASampleAtTheStartHoldsFromTheStart) {
  const std::vector<Drive> from_start = {{Time(), 1.0, 0.0}, {Time::at(2_s), 0.0, 0.0}};
  Odometer odometer(from_start);
  EXPECT_THAT(advance(odometer, Time::at(1_s)), ElementsAre(Piece(1, 1, 0, 1)));
}

}  // namespace
}  // namespace hearsay
