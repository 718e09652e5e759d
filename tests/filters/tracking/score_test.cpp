// What the scorer counts, on cases where a person can count.
#include "filters/tracking/score.hpp"

#include <gtest/gtest.h>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::tracking {
namespace {

/// Objects or tracks on a line, in m.
std::vector<Placed> line(std::initializer_list<std::pair<std::uint32_t, double>> places) {
  std::vector<Placed> out;
  for (const auto& [name, x] : places) out.push_back({name, gaussian::vector({x, 0.0})});
  return out;
}

constexpr std::uint32_t A = 10, B = 20, C = 30;

TEST(TrackScore, PlaceMissedAndFalse) {
  TrackScore score({.p = 1, .cutoff_m = 10});
  const auto s =
      score.sample(line({{0, 0}, {1, 100}, {2, 200}}), line({{A, 1}, {B, 102}, {C, 500}}));
  EXPECT_EQ(s.missed, 1);
  EXPECT_EQ(s.false_tracks, 1);
  EXPECT_EQ(s.duplicates, 0);
  EXPECT_NEAR(s.gospa.distance, 1 + 2 + 5 + 5, 1e-12);
  EXPECT_NEAR(s.ospa.distance, (1 + 2 + 10) / 3.0, 1e-12);
}

TEST(TrackScore, ASwapIsTwoLabelsThatWentOver) {
  TrackScore score({});
  score.sample(line({{0, 0}, {1, 100}}), line({{A, 0}, {B, 100}}));
  score.sample(line({{0, 0}, {1, 100}}), line({{A, 1}, {B, 99}}));
  EXPECT_EQ(score.counts().label_swaps, 0u);
  score.sample(line({{0, 0}, {1, 100}}), line({{A, 100}, {B, 0}}));
  EXPECT_EQ(score.counts().label_swaps, 2u);
  score.sample(line({{0, 0}, {1, 100}}), line({{A, 100}, {B, 0}}));
  EXPECT_EQ(score.counts().label_swaps, 2u);
  EXPECT_EQ(score.counts().label_changes, 0u);
}

// While two objects are near each other, tracks may be nearer to the wrong one.
TEST(TrackScore, LabelsStayWhileObjectsCross) {
  TrackScore score({.cutoff_m = 10});
  for (int t = -5; t <= 5; ++t) {
    const double x = 4.0 * t;
    const double a = t == 0 || t == 1 ? -x : x;  // for a moment they look swapped
    score.sample(line({{0, x}, {1, -x}}), line({{A, a}, {B, -a}}));
  }
  EXPECT_EQ(score.counts().label_swaps, 0u);
  EXPECT_EQ(score.counts().merged_tracks, 0u);
}

TEST(TrackScore, TracksThatPartOnTheWrongSidesHaveSwapped) {
  TrackScore score({.cutoff_m = 10});
  for (int t = -5; t <= 5; ++t) {
    const double x = 4.0 * t;
    const double a = t > 0 ? -x : x;
    score.sample(line({{0, x}, {1, -x}}), line({{A, a}, {B, -a}}));
  }
  EXPECT_EQ(score.counts().label_swaps, 2u);
}

TEST(TrackScore, ANewLabelInPlaceOfAnOldOneIsAChange) {
  TrackScore score({});
  score.sample(line({{0, 0}}), line({{A, 0}}));
  score.sample(line({{0, 0}}), line({}));
  const auto s = score.sample(line({{0, 0}}), line({{B, 0}}));
  EXPECT_EQ(s.missed, 0);
  EXPECT_EQ(score.counts().label_changes, 1u);
  EXPECT_EQ(score.counts().label_swaps, 0u);
}

TEST(TrackScore, TwoTracksOfWhichBothFollowOneObjectHaveMerged) {
  TrackScore score({.cutoff_m = 10});
  score.sample(line({{0, 0}, {1, 100}}), line({{A, 0}, {B, 100}}));
  auto s = score.sample(line({{0, 0}, {1, 100}}), line({{A, 0}, {B, 3}}));
  EXPECT_EQ(s.merged, 1);
  EXPECT_EQ(s.duplicates, 1);
  EXPECT_EQ(s.missed, 1);
  EXPECT_EQ(s.false_tracks, 0);
  EXPECT_EQ(score.counts().merged_tracks, 1u);
  // It stays merged: that is no second event. Then it parts and merges again.
  s = score.sample(line({{0, 0}, {1, 100}}), line({{A, 0}, {B, 3}}));
  EXPECT_EQ(s.merged, 1);
  EXPECT_EQ(score.counts().merged_tracks, 1u);
  score.sample(line({{0, 0}, {1, 100}}), line({{A, 0}, {B, 100}}));
  score.sample(line({{0, 0}, {1, 100}}), line({{A, 0}, {B, 3}}));
  EXPECT_EQ(score.counts().merged_tracks, 2u);
  EXPECT_EQ(score.counts().label_swaps, 0u);
}

TEST(TrackScore, ASecondTrackThatFollowedNothingIsADuplicate) {
  TrackScore score({});
  score.sample(line({{0, 0}}), line({{A, 0}}));
  const auto s = score.sample(line({{0, 0}}), line({{A, 0}, {B, 1}}));
  EXPECT_EQ(s.duplicates, 1);
  EXPECT_EQ(s.merged, 0);
  EXPECT_EQ(s.gospa.false_count, 1);
  EXPECT_EQ(score.counts().merged_tracks, 0u);
}

// The object that B followed is gone; B goes over to one that had no track.
TEST(TrackScore, ALabelThatGoesOverToAnUntrackedObjectHasSwapped) {
  TrackScore score({});
  score.sample(line({{0, 0}, {1, 100}}), line({{B, 100}}));
  score.sample(line({{0, 0}}), line({{B, 0}}));
  EXPECT_EQ(score.counts().label_swaps, 1u);
}

TEST(TrackScore, NobodyAndNothing) {
  TrackScore score({});
  const auto s = score.sample({}, {});
  EXPECT_EQ(s.gospa.distance, 0.0);
  EXPECT_EQ(s.missed + s.false_tracks + s.duplicates, 0);
  EXPECT_THROW(TrackScore({.cutoff_m = 0}), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::tracking
