#include "sim/math/functions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace {

namespace math = hearsay::math;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Distance of `value` from `truth` in units in the last place of the double nearest to `truth`.
double ulps(double value, long double truth) {
  if (static_cast<long double>(value) == truth) return 0.0;
  const double nearest = std::fabs(static_cast<double>(truth));
  const double ulp = std::nextafter(nearest, infinity) - nearest;
  return static_cast<double>(std::fabs(static_cast<long double>(value) - truth) / ulp);
}

// `count` arguments from `low` to `high`, at irregular places.
std::vector<double> spread(double low, double high, int count = 2000) {
  std::vector<double> points;
  for (int i = 0; i < count; ++i) {
    const double place = std::fmod((i + 1) * 0.6180339887498949, 1.0);
    points.push_back(low + (high - low) * place);
  }
  return points;
}

// The same, evenly in the exponent.
std::vector<double> spread_log(double low, double high, int count = 2000) {
  std::vector<double> points = spread(std::log(low), std::log(high), count);
  for (double& point : points) point = std::exp(point);
  return points;
}

using Ours = double (*)(double);
using Precise = long double (*)(long double);

void expect_close(const char* name, Ours ours, Precise precise, const std::vector<double>& points) {
  for (const double x : points) {
    EXPECT_LE(ulps(ours(x), precise(x)), 2.0) << name << "(" << x << ") = " << ours(x);
  }
}

TEST(Functions, AreWithinTwoUnitsInTheLastPlaceOfMorePreciseOnes) {
  expect_close("exp", math::exp, std::exp, spread(-700, 700));
  expect_close("expm1", math::expm1, std::expm1, spread(-2, 2));
  expect_close("expm1", math::expm1, std::expm1, spread_log(1e-12, 1e-2));
  expect_close("log", math::log, std::log, spread_log(1e-300, 1e300));
  expect_close("log", math::log, std::log, spread(0.5, 2));
  expect_close("log1p", math::log1p, std::log1p, spread(-0.9, 3));
  expect_close("log1p", math::log1p, std::log1p, spread_log(1e-12, 1e-2));
  expect_close("log2", math::log2, std::log2, spread_log(1e-300, 1e300));
  expect_close("log10", math::log10, std::log10, spread_log(1e-300, 1e300));
  expect_close("sin", math::sin, std::sin, spread(-10, 10));
  expect_close("sin", math::sin, std::sin, spread(-1e6, 1e6));
  expect_close("cos", math::cos, std::cos, spread(-10, 10));
  expect_close("cos", math::cos, std::cos, spread(-1e6, 1e6));
  expect_close("tan", math::tan, std::tan, spread(-10, 10));
  expect_close("asin", math::asin, std::asin, spread(-1, 1));
  expect_close("acos", math::acos, std::acos, spread(-1, 1));
  expect_close("atan", math::atan, std::atan, spread(-50, 50));
  expect_close("tanh", math::tanh, std::tanh, spread(-5, 5));
  expect_close("lgamma", math::lgamma, std::lgamma, spread_log(2.5, 1e6));
}

TEST(Functions, OfTwoArgumentsAreWithinTwoUnitsInTheLastPlace) {
  const std::vector<double> xs = spread(-30, 30, 60);
  const std::vector<double> ys = spread(-7, 7, 61);
  for (const double x : xs) {
    for (const double y : ys) {
      EXPECT_LE(ulps(math::atan2(y, x), std::atan2(static_cast<long double>(y), x)), 2.0);
      EXPECT_LE(ulps(math::hypot(x, y), std::hypot(static_cast<long double>(x), y)), 2.0);
      EXPECT_LE(
          ulps(math::pow(std::fabs(x), y), std::pow(std::fabs(static_cast<long double>(x)), y)),
          2.0);
    }
  }
}

TEST(Functions, GivePublishedConstants) {
  EXPECT_LE(ulps(math::exp(1.0), 2.71828182845904523536L), 1.0);
  EXPECT_LE(ulps(math::log(2.0), 0.693147180559945309417L), 1.0);
  EXPECT_LE(ulps(math::log(10.0), 2.302585092994045684018L), 1.0);
  EXPECT_LE(ulps(math::pow(2.0, 0.5), 1.41421356237309504880L), 1.0);
  EXPECT_LE(ulps(4.0 * math::atan(1.0), 3.14159265358979323846L), 1.0);
  EXPECT_LE(ulps(math::sin(1.0), 0.841470984807896506653L), 1.0);
  EXPECT_LE(ulps(math::cos(1.0), 0.540302305868139717401L), 1.0);
  EXPECT_LE(ulps(math::tan(1.0), 1.557407724654902230507L), 1.0);
  EXPECT_LE(ulps(math::tanh(0.5), 0.462117157260009758502L), 1.0);
  EXPECT_LE(ulps(math::log10(2.0), 0.301029995663981195214L), 1.0);
  EXPECT_LE(ulps(math::log2(3.0), 1.584962500721156181454L), 1.0);
  EXPECT_LE(ulps(math::lgamma(0.5), 0.572364942924700087072L), 2.0);  // ln √π
  EXPECT_NEAR(math::lgamma(171.0), 706.5730622457873471, 2e-13);      // ln 170!
}

TEST(Functions, TakeSpecialValuesAsTheStandardSays) {
  EXPECT_EQ(math::exp(0.0), 1.0);
  EXPECT_EQ(math::exp(-infinity), 0.0);
  EXPECT_EQ(math::exp(infinity), infinity);
  EXPECT_EQ(math::exp(-800.0), 0.0);
  EXPECT_EQ(math::exp(800.0), infinity);
  EXPECT_EQ(math::log(1.0), 0.0);
  EXPECT_EQ(math::log(0.0), -infinity);
  EXPECT_EQ(math::log(infinity), infinity);
  EXPECT_TRUE(std::isnan(math::log(-1.0)));
  EXPECT_EQ(math::log10(1000.0), 3.0);
  EXPECT_EQ(math::log2(1024.0), 10.0);
  EXPECT_EQ(math::log1p(-1.0), -infinity);
  EXPECT_EQ(math::pow(0.0, 0.0), 1.0);
  EXPECT_EQ(math::pow(-2.0, 3.0), -8.0);
  EXPECT_TRUE(std::isnan(math::pow(-2.0, 0.5)));
  EXPECT_EQ(math::sin(0.0), 0.0);
  EXPECT_EQ(math::cos(0.0), 1.0);
  EXPECT_EQ(math::atan2(0.0, 1.0), 0.0);
  EXPECT_EQ(math::atan2(0.0, -1.0), math::pi);
  EXPECT_EQ(math::atan2(-0.0, -1.0), -math::pi);
  EXPECT_EQ(math::atan2(1.0, 0.0), math::pi / 2);
  EXPECT_EQ(math::acos(1.0), 0.0);
  EXPECT_TRUE(std::isnan(math::asin(1.5)));
  EXPECT_EQ(math::lgamma(1.0), 0.0);
  EXPECT_EQ(math::lgamma(2.0), 0.0);
  EXPECT_EQ(math::lgamma(infinity), infinity);
  for (const Ours f :
       {math::exp, math::expm1, math::log, math::log1p, math::sin, math::cos, math::tan, math::atan,
        math::tanh, math::lgamma, math::digamma, math::wrap_angle}) {
    EXPECT_TRUE(std::isnan(f(nan)));
  }
}

TEST(Hypot, NeitherOverflowsNorUnderflows) {
  EXPECT_EQ(math::hypot(3.0, -4.0), 5.0);
  EXPECT_LE(ulps(math::hypot(3e200, 4e200), 5e200L), 2.0);
  EXPECT_LE(ulps(math::hypot(3e-200, 4e-200), 5e-200L), 2.0);
  EXPECT_LE(ulps(math::hypot(3e300, 4e300), std::hypot(3e300L, 4e300L)), 2.0);
  EXPECT_EQ(math::hypot(0x1p-1074, 0.0), 0x1p-1074);
  EXPECT_EQ(math::hypot(0.0, -0.0), 0.0);
  EXPECT_EQ(math::hypot(1e-300, 1.0), 1.0);
  EXPECT_EQ(math::hypot(1e308, 1.7e308), infinity);
  EXPECT_EQ(math::hypot(nan, -infinity), infinity);
  EXPECT_TRUE(std::isnan(math::hypot(nan, 1.0)));
  EXPECT_TRUE(std::isnan(math::hypot(1.0, nan)));
}

TEST(Digamma, EqualsClosedForms) {
  constexpr double euler = 0.577215664901532860606512;
  const double ln2 = std::log(2.0);
  // Gauss's theorem: ψ(1/2) = −γ − 2 ln 2, ψ(1/4) = −γ − π/2 − 3 ln 2.
  EXPECT_NEAR(math::digamma(1.0), -euler, 1e-15);
  EXPECT_NEAR(math::digamma(0.5), -euler - 2 * ln2, 4e-15);
  EXPECT_NEAR(math::digamma(0.25), -euler - M_PI / 2 - 3 * ln2, 8e-15);
  double harmonic = 0.0;
  for (int n = 1; n < 60; ++n) {
    EXPECT_NEAR(math::digamma(n), harmonic - euler, 1e-14) << "n = " << n;
    harmonic += 1.0 / n;
  }
}

TEST(Digamma, IsPreciseToOnePartInTenToTheThirteenEvenNearItsZero) {
  // From a 70-digit evaluation.
  const std::pair<double, double> table[] = {
      {1e-8, -100000000.57721564636},
      {0.001, -1000.5755719318102797},
      {0.1, -10.423754940411076232},
      {1.3116, -0.15611356213401192394},
      {1.36, -0.10321005823697751435652},
      {1.4, -0.061384544585116236800635},
      {1.46163, -2.0756283887224574169e-06},
      {1.4616321449683622, -9.2412655217294272577e-17},
      {1.461632144968363, 5.5218654909471045838e-16},
      {1.4617, 6.5659392293676495682e-05},
      {1.5, 0.036489973978576520559},
      {1.56, 0.091135192540635234781},
      {1.6117, 0.13604324443789828081},
      {3.75, 1.1825373886117962286},
      {17.5, 2.8333574322286841031},
      {12345.678, 9.4210208207417608775},
      {1e15, 34.538776394910684760},
  };
  for (const auto& [x, value] : table) {
    EXPECT_NEAR(math::digamma(x) / value, 1.0, 1e-13) << "x = " << x;
  }
}

TEST(Digamma, ObeysItsRecurrenceAcrossAllBranches) {
  for (const double x : spread(0.05, 30.0)) {
    const double next = math::digamma(x) + 1.0 / x;
    EXPECT_NEAR(math::digamma(x + 1.0), next, 2e-14 * (1.0 + 1.0 / x)) << "x = " << x;
  }
}

TEST(Digamma, IsTheSlopeOfLogGamma) {
  for (const double x : spread(0.5, 40.0, 200)) {
    const long double h = 1e-4L;
    const long double slope = (std::lgamma(x + h) - std::lgamma(x - h)) / (2 * h);
    EXPECT_NEAR(math::digamma(x), static_cast<double>(slope), 1e-6) << "x = " << x;
  }
}

TEST(Digamma, IsUndefinedBelowZero) {
  EXPECT_TRUE(std::isnan(math::digamma(-0.5)));
  EXPECT_EQ(math::digamma(0.0), -infinity);
  EXPECT_EQ(math::digamma(infinity), infinity);
}

TEST(WrapAngle, BringsAnglesToTheHalfOpenTurn) {
  EXPECT_EQ(math::wrap_angle(0.0), 0.0);
  EXPECT_EQ(math::wrap_angle(math::pi), math::pi);
  EXPECT_EQ(math::wrap_angle(-math::pi), math::pi);
  EXPECT_EQ(math::wrap_angle(1.25), 1.25);
  EXPECT_EQ(math::wrap_angle(-3.0), -3.0);
  EXPECT_NEAR(math::wrap_angle(4.0), 4.0 - 2 * M_PI, 1e-15);
  EXPECT_NEAR(math::wrap_angle(-4.0), 2 * M_PI - 4.0, 1e-15);
  EXPECT_TRUE(std::isnan(math::wrap_angle(infinity)));
  EXPECT_TRUE(std::isnan(math::wrap_angle(-infinity)));
}

TEST(WrapAngle, KeepsSineAndCosineOverManyTurns) {
  for (const double angle : spread(-1e5, 1e5)) {
    const double wrapped = math::wrap_angle(angle);
    EXPECT_GT(wrapped, -math::pi);
    EXPECT_LE(wrapped, math::pi);
    EXPECT_NEAR(std::sin(wrapped), std::sin(angle), 1e-15) << "angle " << angle;
    EXPECT_NEAR(std::cos(wrapped), std::cos(angle), 1e-15) << "angle " << angle;
  }
  for (int turns = -1000; turns <= 1000; ++turns) {  // around the seam
    for (const double offset : {-1e-12, 0.0, 1e-12}) {
      const double wrapped = math::wrap_angle((2 * turns + 1) * math::pi + offset);
      EXPECT_GT(wrapped, -math::pi);
      EXPECT_LE(wrapped, math::pi);
    }
  }
}

}  // namespace
