#include "filters/gaussian/sightings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

static_assert(MeasurementModel<RangeBearing>);
static_assert(MeasurementModel<BearingOnly>);
static_assert(MeasurementModel<CameraPixel>);

constexpr double pi = 3.14159265358979323846;

template <typename Model>
void expect_jacobian(const Model& model, const Vector& x) {
  const auto J = model.jacobian(x);
  const auto z = model.value(x);
  ASSERT_TRUE(J && z);
  ASSERT_EQ(J->rows(), z->size());
  ASSERT_EQ(J->cols(), x.size());
  constexpr double step = 1e-4;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    Vector up = x, down = x;
    up(k) += step;
    down(k) -= step;
    const Vector difference = model.difference(*model.value(up), *model.value(down)) / (2 * step);
    EXPECT_LT((J->col(k) - difference).norm(), 1e-7 * (1 + J->norm())) << k;
  }
}

TEST(Sightings, JacobiansEqualCentralDifferences) {
  Stream random = stream("sightings");
  for (int i = 0; i < 20; ++i) {
    for (const int d : {2, 3}) {
      const Observer observer{random_vector(random, d), random.uniform(-pi, pi)};
      for (const int n : {d, 2 * d}) {  // with and without a velocity
        const Vector x = 6 * random_vector(random, n) + Vector::Constant(n, 8.0);
        expect_jacobian(RangeBearing{observer}, x);
        expect_jacobian(BearingOnly{observer}, x);
      }
    }
    const CameraPose pose = looking({random.normal(), random.normal(), 40}, random.uniform(-pi, pi),
                                    random.uniform(1.0, 1.5), random.normal());
    const CameraPixel pixel{{350, 340, 120, 160, 2.5}, pose, {}};
    for (const int n : {3, 6}) expect_jacobian(pixel, random_vector(random, n));
    CameraPixel on_plane = pixel;
    on_plane.plane_m = 2.0;
    for (const int n : {2, 4}) expect_jacobian(on_plane, random_vector(random, n));
  }
}

TEST(RangeBearing, ATriangleOfThreeFourFive) {
  const RangeBearing plane{{vector({1.0, 1.0}), pi / 2}};
  const auto z = plane.value(vector({4.0, 5.0, 100.0, 100.0}));
  ASSERT_TRUE(z);
  ASSERT_EQ(z->size(), 2);
  EXPECT_NEAR((*z)(0), 5.0, 1e-14);
  EXPECT_NEAR((*z)(1), std::atan2(4.0, 3.0) - pi / 2, 1e-14);
  const RangeBearing space{{vector({1.0, 1.0, 10.0}), 0.0}};
  const auto up = space.value(vector({4.0, 5.0, 22.0}));  // 5 level, 12 up, 13 far
  ASSERT_TRUE(up);
  EXPECT_NEAR((*up)(0), 13.0, 1e-13);
  EXPECT_NEAR((*up)(1), std::atan2(4.0, 3.0), 1e-14);
  EXPECT_NEAR((*up)(2), std::atan2(12.0, 5.0), 1e-14);
  const auto only = BearingOnly{space.observer}.value(vector({4.0, 5.0, 22.0}));
  ASSERT_TRUE(only);
  EXPECT_EQ(*only, up->tail(2));
}

TEST(BearingOnly, DifferencesGoTheShortWayRound) {
  const BearingOnly bearing{{vector({0.0, 0.0}), 0.0}};
  EXPECT_NEAR(bearing.difference(vector({3.1}), vector({-3.1}))(0), 6.2 - 2 * pi, 1e-14);
  EXPECT_NEAR(bearing.difference(vector({-3.1}), vector({3.1}))(0), 2 * pi - 6.2, 1e-14);
  const RangeBearing both{{vector({0.0, 0.0}), 0.0}};  // a range is no angle
  EXPECT_EQ(both.difference(vector({9.0, 0.0}), vector({1.0, 0.0}))(0), 8.0);
}

TEST(CameraPixel, InAPlaneIsTheSameAsInSpace) {
  const CameraPose pose = looking({0, 0, 40}, 0.3, 1.1);
  const CameraPixel space{infrared_camera, pose, {}};
  const CameraPixel plane{infrared_camera, pose, 3.0};
  EXPECT_EQ(*space.value(vector({15.0, 4.0, 3.0})), *plane.value(vector({15.0, 4.0})));
}

TEST(Sightings, WhereNothingIsSeenThereIsNoValue) {
  for (const Vector& x :
       {vector({1.0, 2.0}), vector({std::nan(""), 2.0}), vector({HUGE_VAL, 2.0})}) {
    EXPECT_FALSE(RangeBearing({{vector({1.0, 2.0})}}).value(x));
    EXPECT_FALSE(BearingOnly({{vector({1.0, 2.0})}}).jacobian(x));
  }
  const RangeBearing above{{vector({1.0, 2.0, 9.0})}};
  EXPECT_FALSE(above.value(vector({1.0, 2.0, 3.0}))) << "straight below there is no bearing";
  const CameraPixel ahead{infrared_camera, looking({0, 0, 2}, 0.0, 0.0), {}};
  EXPECT_FALSE(ahead.value(vector({-4.0, 0.0, 0.0})));
  EXPECT_FALSE(ahead.jacobian(vector({-4.0, 0.0, 0.0})));
}

TEST(Sightings, StatesWithoutAPositionAreRefused) {
  EXPECT_THROW(RangeBearing({{vector({1.0, 2.0, 3.0})}}).value(vector({1.0, 2.0})),
               BrokenInvariant);
  EXPECT_THROW(RangeBearing({{vector({1.0})}}).value(vector({1.0, 2.0})), BrokenInvariant);
  const CameraPixel ahead{infrared_camera, looking({0, 0, 2}, 0.0, 0.0), {}};
  EXPECT_THROW(ahead.value(vector({1.0, 2.0})), BrokenInvariant);
  EXPECT_THROW(BearingOnly({{vector({0.0, 0.0})}}).difference(vector({1.0}), vector({1.0, 2.0})),
               BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::gaussian
