#include "sim/math/functions.hpp"

#include <sleef.h>

#include <cmath>
#include <limits>

namespace hearsay::math {

double exp(double x) { return Sleef_exp_u10(x); }
double expm1(double x) { return Sleef_expm1_u10(x); }
double log(double x) { return Sleef_log_u10(x); }
double log1p(double x) { return Sleef_log1p_u10(x); }
double log2(double x) { return Sleef_log2_u10(x); }
double log10(double x) { return Sleef_log10_u10(x); }
double pow(double x, double y) { return Sleef_pow_u10(x, y); }
double sin(double x) { return Sleef_sin_u10(x); }
double cos(double x) { return Sleef_cos_u10(x); }
double tan(double x) { return Sleef_tan_u10(x); }
double asin(double x) { return Sleef_asin_u10(x); }
double acos(double x) { return Sleef_acos_u10(x); }
double atan(double x) { return Sleef_atan_u10(x); }
double atan2(double y, double x) { return Sleef_atan2_u10(y, x); }
double tanh(double x) { return Sleef_tanh_u10(x); }
double lgamma(double x) { return Sleef_lgamma_u10(x); }

double hypot(double x, double y) {
  const double a = std::fabs(x);
  const double b = std::fabs(y);
  const double high = a > b ? a : b;
  if (std::isinf(a) || std::isinf(b)) return std::numeric_limits<double>::infinity();
  // Powers of two, so that scaling rounds nothing. A NaN falls through to the plain formula.
  if (high > 0x1p500)
    return 0x1p600 * std::sqrt((a * 0x1p-600) * (a * 0x1p-600) + (b * 0x1p-600) * (b * 0x1p-600));
  if (high < 0x1p-450)
    return 0x1p-600 * std::sqrt((a * 0x1p600) * (a * 0x1p600) + (b * 0x1p600) * (b * 0x1p600));
  return std::sqrt(a * a + b * b);
}

namespace {

// The positive zero of ψ, as a double and what is missing to it.
constexpr double psi_root = 0x1.762d86356be3fp+0;
constexpr double psi_root_rest = 9.549995429965697e-17;

// ψ about its zero; coefficient k is (−1)^(k+1) ζ(k+1, root). Without it the relative error would
// grow without bound where ψ crosses zero.
double digamma_near_root(double x) {
  constexpr double coefficients[] = {
      0.9676722454476212,   -0.4427631689835921,   0.258499760955651,    -0.16394270544240652,
      0.10782405069126237,  -0.07219956125645471,  0.04880428816414311,  -0.03316112647484736,
      0.022597648232218104, -0.01542476590494896,  0.010538791616612175, -0.007204534386356869,
      0.004926781395729853, -0.003369801655439328, 0.002305126326734928, -0.0015769367714301972,
      0.0010788252019162967};
  const double delta = (x - psi_root) - psi_root_rest;
  double sum = 0.0;
  for (int k = 16; k >= 0; --k) sum = sum * delta + coefficients[k];
  return sum * delta;
}

}  // namespace

double digamma(double x) {
  if (!(x >= 0.0)) return std::numeric_limits<double>::quiet_NaN();
  if (x == 0.0) return -std::numeric_limits<double>::infinity();
  if (std::fabs(x - psi_root) < 0.12) return digamma_near_root(x);
  double shift = 0.0;
  while (x < 12.0) {  // ψ(x) = ψ(x + 1) − 1/x
    shift += 1.0 / x;
    x += 1.0;
  }
  if (std::isinf(x)) return x;
  // ln x − 1/(2x) − Σ B_2k / (2k x^2k); the first term left out is below 1e-17 from x = 12 on.
  const double w = 1.0 / (x * x);
  const double series =
      w * (1.0 / 12 - w * (1.0 / 120 -
                           w * (1.0 / 252 -
                                w * (1.0 / 240 - w * (1.0 / 132 - w * (691.0 / 32760 - w / 12))))));
  return log(x) - 0.5 / x - series - shift;
}

double wrap_angle(double angle_rad) {
  if (angle_rad > -pi && angle_rad <= pi) return angle_rad;
  if (angle_rad == -pi) return pi;
  // 2π in two parts; the first has 30 bits, so its product with up to 2^23 turns is exact.
  constexpr double two_pi_high = 0x1.921fb544p+2;
  constexpr double two_pi_low = 0x1.0b4611a626331p-32;
  const double turns = std::ceil((angle_rad - pi) / (2 * pi));
  double wrapped = (angle_rad - turns * two_pi_high) - turns * two_pi_low;
  if (wrapped > pi) wrapped -= 2 * pi;
  if (wrapped < -pi) wrapped += 2 * pi;
  return wrapped == -pi ? pi : wrapped;
}

}  // namespace hearsay::math
