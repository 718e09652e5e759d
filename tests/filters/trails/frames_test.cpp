#include "filters/trails/frames.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"
#include "tests/filters/trails/samples.hpp"

namespace hearsay::trails {
namespace {

Similarity made(double scale, double angle_rad, double x_m, double y_m) {
  return {scale * math::cos(angle_rad), scale * math::sin(angle_rad), x_m, y_m};
}

std::vector<PointPair> pairs_of(Stream& random, const Similarity& map, std::size_t count,
                                double noise_m) {
  std::vector<PointPair> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    const Point from = random_point(random, 20.0), to = map.apply(from);
    pairs.push_back({from, point(to.x_m + random.normal(0.0, noise_m + 1e-300),
                                 to.y_m + random.normal(0.0, noise_m + 1e-300))});
  }
  return pairs;
}

double cost(const std::vector<PointPair>& pairs, const Similarity& s) {
  double sum = 0.0;
  for (const PointPair& p : pairs) {
    const double x = s.a * p.from.x_m - s.b * p.from.y_m + s.x_m - p.to.x_m;
    const double y = s.b * p.from.x_m + s.a * p.from.y_m + s.y_m - p.to.y_m;
    sum += x * x + y * y;
  }
  return sum;
}

TEST(Frames, TwoPlacesGiveTheRotationTranslationAndScaleThatWere) {
  Stream random = stream("two places");
  for (int i = 0; i < 200; ++i) {
    const double scale = random.uniform(0.3, 3.0);
    const double angle_rad = random.uniform(-math::pi, math::pi);
    const Similarity truth =
        made(scale, angle_rad, random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0));
    std::vector<PointPair> pairs = pairs_of(random, truth, 1, 0.0);
    const Point far = point(pairs[0].from.x_m + random.uniform(2.0, 30.0), random.uniform(-9, 9));
    pairs.push_back({far, truth.apply(far)});
    const auto found = align(pairs, {});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->basis, Basis::similarity);
    EXPECT_NEAR(found->map.scale(), scale, 1e-5);
    EXPECT_NEAR(math::wrap_angle(found->map.rotation_rad() - angle_rad), 0.0, 1e-5);
    EXPECT_LT(found->residual_m, 1e-5);
    const Point p = random_point(random, 20.0), mapped = found->map.apply(p);
    const Point expected = truth.apply(p);
    EXPECT_NEAR(mapped.x_m, expected.x_m, 2e-4);
    EXPECT_NEAR(mapped.y_m, expected.y_m, 2e-4);
  }
}

TEST(Frames, AQuarterTurnAtTwiceTheScaleByHand) {
  const std::vector<PointPair> pairs{{{0.0F, 0.0F}, {5.0F, 1.0F}}, {{1.0F, 0.0F}, {5.0F, 3.0F}}};
  const auto found = align(pairs, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->map.apply({1.0F, 1.0F}), (Point{3.0F, 3.0F}));
  EXPECT_DOUBLE_EQ(found->map.scale(), 2.0);
  EXPECT_NEAR(found->map.rotation_rad(), math::pi / 2, 1e-15);
  EXPECT_EQ(found->pairs, 2u);
}

TEST(Frames, MorePlacesGiveWhatASingularValueDecompositionGives) {
  Stream random = stream("many places");
  for (int i = 0; i < 100; ++i) {
    const Similarity truth = made(random.uniform(0.3, 3.0), random.uniform(-3.1, 3.1), 4.0, -7.0);
    const auto pairs = pairs_of(random, truth, 3 + random.below(6), 1.0);
    Eigen::Matrix2Xd from(2, pairs.size()), to(2, pairs.size());
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const auto c = static_cast<Eigen::Index>(k);
      from.col(c) << pairs[k].from.x_m, pairs[k].from.y_m;
      to.col(c) << pairs[k].to.x_m, pairs[k].to.y_m;
    }
    for (const bool scale : {true, false}) {
      const Eigen::Matrix3d expected = Eigen::umeyama(from, to, scale);
      const auto found = align(pairs, {.scale = scale});
      ASSERT_TRUE(found);
      EXPECT_NEAR(found->map.a, expected(0, 0), 1e-9);
      EXPECT_NEAR(found->map.b, expected(1, 0), 1e-9);
      EXPECT_NEAR(found->map.x_m, expected(0, 2), 1e-8);
      EXPECT_NEAR(found->map.y_m, expected(1, 2), 1e-8);
      EXPECT_NEAR(found->residual_m * found->residual_m * static_cast<double>(pairs.size()),
                  cost(pairs, found->map), 1e-9);
      if (!scale) {
        EXPECT_NEAR(found->map.scale(), 1.0, 1e-12);
      }
    }
  }
}

TEST(Frames, NoOtherSimilarityIsNearerToThePairs) {
  Stream random = stream("brute force");
  const auto pairs = pairs_of(random, made(1.2, 0.7, 3.0, 4.0), 5, 1.0);
  const Similarity best = align(pairs, {})->map;
  const double least = cost(pairs, best);
  for (int i = 0; i < 3000; ++i) {
    Similarity other = best;
    const double by = random.uniform(1e-3, 2.0);
    other.a += by * 0.1 * random.normal();
    other.b += by * 0.1 * random.normal();
    other.x_m += by * random.normal();
    other.y_m += by * random.normal();
    ASSERT_GT(cost(pairs, other), least);
  }
}

TEST(Frames, AMirrorImageIsNotMirroredBack) {
  // Corners of a rectangle, and their mirror image: no turn is better than another, so half way.
  const std::vector<PointPair> square{{{1.0F, 1.0F}, {1.0F, -1.0F}},
                                      {{-1.0F, 1.0F}, {-1.0F, -1.0F}},
                                      {{-1.0F, -1.0F}, {-1.0F, 1.0F}},
                                      {{1.0F, -1.0F}, {1.0F, 1.0F}}};
  EXPECT_FALSE(align(square, {}));
  std::vector<PointPair> longer = square;
  for (PointPair& pair : longer) pair.from.x_m = pair.to.x_m = 3.0F * pair.from.x_m;
  const auto found = align(longer, {.scale = false});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->map.a, 1.0, 1e-12);  // as it is, and not mirrored
  EXPECT_NEAR(found->map.b, 0.0, 1e-12);
  EXPECT_NEAR(found->residual_m, 2.0, 1e-12);
}

TEST(Frames, TooFewPlacesAreDroppedOrTranslated) {
  const std::vector<PointPair> one{{{1.0F, 2.0F}, {4.0F, 1.0F}}};
  EXPECT_FALSE(align({}, {}));
  EXPECT_FALSE(align(one, {}));
  const auto copied = align({}, {.optimistic = true});
  ASSERT_TRUE(copied);
  EXPECT_EQ(copied->basis, Basis::nothing);
  EXPECT_EQ(copied->map.apply({7.0F, 8.0F}), (Point{7.0F, 8.0F}));
  const auto moved = align(one, {.optimistic = true});
  ASSERT_TRUE(moved);
  EXPECT_EQ(moved->basis, Basis::translation);
  EXPECT_EQ(moved->map.apply({1.0F, 3.0F}), (Point{4.0F, 2.0F}));
  EXPECT_DOUBLE_EQ(moved->map.scale(), 1.0);
  EXPECT_EQ(moved->residual_m, 0.0);
}

TEST(Frames, PlacesThatCoincideAreOnePlace) {
  const PointPair a{{1.0F, 2.0F}, {4.0F, 1.0F}};
  for (const PointPair& b :
       {a, PointPair{a.from, {9.0F, 9.0F}}, PointPair{{5.0F, 5.0F}, a.to},
        PointPair{{1.001F, 2.0F}, {4.0F, 9.0F}}, PointPair{{1.0F, 9.0F}, {4.0F, 1.001F}}}) {
    EXPECT_FALSE(align(std::vector{a, b}, {}));
    const auto moved = align(std::vector{a, b}, {.optimistic = true});
    ASSERT_TRUE(moved);
    EXPECT_EQ(moved->basis, Basis::translation);
    EXPECT_EQ(moved->map.a, 1.0);
    EXPECT_EQ(moved->map.b, 0.0);
    EXPECT_TRUE(std::isfinite(moved->residual_m));
  }
  EXPECT_TRUE(align(std::vector{a, PointPair{{1.2F, 2.0F}, {4.0F, 1.2F}}}, {}));
  EXPECT_THROW(align(std::vector{a}, {.spread_min_m = 0.0}), BrokenInvariant);
}

TEST(Frames, ThereAndBackIsNothing) {
  const Similarity there = made(1.7, 2.0, 3.0, -4.0);
  const Similarity nothing = chained(*there.inverse(), there);
  EXPECT_NEAR(nothing.a, 1.0, 1e-12);
  EXPECT_NEAR(nothing.b, 0.0, 1e-12);
  EXPECT_NEAR(nothing.x_m, 0.0, 1e-12);
  EXPECT_NEAR(nothing.y_m, 0.0, 1e-12);
  EXPECT_FALSE((Similarity{0.0, 0.0, 1.0, 1.0}).inverse());
}

TEST(Frames, CommonPlacesAreThoseOfTheSameEvents) {
  const auto place = [](EventId event, float x) {
    return Place{.event = event, .position = {x, 0.0F}, .time_s = 0.0, .identity = {}};
  };
  const std::vector<Place> theirs{place(1, 1.0F), place(3, 3.0F), place(4, 4.0F)};
  const std::vector<Place> own{place(0, 0.0F), place(1, 10.0F), place(2, 20.0F), place(4, 40.0F)};
  std::vector<PointPair> pairs(9);
  common_places(theirs, own, pairs);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].from, (Point{1.0F, 0.0F}));
  EXPECT_EQ(pairs[0].to, (Point{10.0F, 0.0F}));
  EXPECT_EQ(pairs[1].to, (Point{40.0F, 0.0F}));
}

TEST(Frames, ACrumbKeepsItsTimes) {
  const Crumb crumb{.event = 1,
                    .goal = 2,
                    .position = {1.0F, 0.0F},
                    .distance_s = 12.0F,
                    .created_s = 34.0,
                    .identity = {1, 2, 3}};
  Crumb expected = crumb;
  expected.position = {5.0F, 3.0F};
  EXPECT_EQ(mapped(crumb, Similarity{0.0, 2.0, 5.0, 1.0}), expected);
}

}  // namespace
}  // namespace hearsay::trails
