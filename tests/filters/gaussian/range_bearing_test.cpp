#include <gtest/gtest.h>

#include <cmath>

#include "filters/gaussian/belief.hpp"
#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

using Parameters = Eigen::Matrix<double, 5, 1>;  // x, y, heading, range, bearing

Eigen::Vector2d seen(const Parameters& p) {
  return {p(0) + p(3) * std::cos(p(2) + p(4)), p(1) + p(3) * std::sin(p(2) + p(4))};
}

constexpr Pose pose{2.0, -1.0, 0.7};
constexpr double range_m = 4.0;
constexpr double bearing_rad = -1.9;

TEST(RangeBearing, StraightAheadSeparatesRangeFromAngle) {
  const RangeBearingNoise noise{0.5, 0.03, 0.04, 0.1};
  const auto m = range_bearing_to_position({1.0, 2.0, 0.0}, 10.0, 0.0, noise);
  EXPECT_DOUBLE_EQ(m.z(0), 11.0);
  EXPECT_DOUBLE_EQ(m.z(1), 2.0);
  EXPECT_NEAR(m.S(0, 0), 0.25 + 0.01, 1e-15);
  EXPECT_NEAR(m.S(1, 1), 100 * (0.0009 + 0.0016) + 0.01, 1e-15);
  EXPECT_EQ(m.S(0, 1), 0.0);
}

TEST(RangeBearing, CovarianceEqualsThatOfTheNumericalJacobian) {
  const RangeBearingNoise noise{0.15, 0.08, 0.03, 0.05};
  const Parameters at{pose.x_m, pose.y_m, pose.heading_rad, range_m, bearing_rad};
  Eigen::Matrix<double, 2, 5> J;
  constexpr double step = 1e-5;
  for (int k = 0; k < 5; ++k) {
    Parameters up = at;
    Parameters down = at;
    up(k) += step;
    down(k) -= step;
    J.col(k) = (seen(up) - seen(down)) / (2 * step);
  }
  Parameters variance{0.05 * 0.05, 0.05 * 0.05, 0.03 * 0.03, 0.15 * 0.15, 0.08 * 0.08};
  const Eigen::Matrix2d expected = J * variance.asDiagonal() * J.transpose();

  const auto m = range_bearing_to_position(pose, range_m, bearing_rad, noise);
  EXPECT_LT(relative(m.z, seen(at)), 1e-15);
  EXPECT_LT(relative(m.S, expected), 1e-9);
  EXPECT_EQ(m.S(0, 1), m.S(1, 0));
}

TEST(RangeBearing, CovarianceAgreesWithMonteCarloForSmallNoise) {
  const RangeBearingNoise noise{0.05, 0.01, 0.008, 0.02};
  const auto m = range_bearing_to_position(pose, range_m, bearing_rad, noise);
  Stream random = stream("range-bearing");
  constexpr int draws = 20000;
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (int i = 0; i < draws; ++i) {
    const Parameters p{pose.x_m + random.normal(0, noise.sigma_position_m),
                       pose.y_m + random.normal(0, noise.sigma_position_m),
                       pose.heading_rad + random.normal(0, noise.sigma_heading_rad),
                       range_m + random.normal(0, noise.sigma_range_m),
                       bearing_rad + random.normal(0, noise.sigma_bearing_rad)};
    const Eigen::Vector2d e = seen(p) - Eigen::Vector2d(m.z);
    sum += e * e.transpose();
  }
  sum /= draws;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const double sd = std::sqrt((m.S(i, i) * m.S(j, j) + m.S(i, j) * m.S(i, j)) / draws);
      EXPECT_NEAR(sum(i, j), m.S(i, j), 5 * sd);
    }
  }
}

TEST(RangeBearing, ARangeThatIsNotPositiveIsRefused) {
  const RangeBearingNoise noise{0.15, 0.08, 0.03, 0.05};
  EXPECT_THROW(range_bearing_to_position(pose, 0.0, 0.0, noise), BrokenInvariant);
  EXPECT_THROW(range_bearing_to_position(pose, -1.0, 0.0, noise), BrokenInvariant);
  EXPECT_THROW(range_bearing_to_position(pose, std::nan(""), 0.0, noise), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::gaussian
