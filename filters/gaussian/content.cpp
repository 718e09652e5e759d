#include "filters/gaussian/content.hpp"

#include <algorithm>
#include <cmath>

#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

constexpr int mean_bits = 12;  // of a mean below its standard deviation
constexpr int exponent_max = 127;
constexpr double mean_code_max = 2147483000.0;
constexpr double rounding = 1e-12;  // of a covariance that was computed, beside its diagonal

/// The step of entries of N.
double step_of(int bits) {
  require(bits >= quantised_bits_min && bits <= quantised_bits_max,
          "quantise: 4 to 16 bits an entry");
  return std::ldexp(1.0, 1 - bits);
}

/// The least k with √variance ≤ 2^k, such that the mean has a code.
int exponent_for(double variance, double mean) {
  int k = 0;
  std::frexp(std::sqrt(variance), &k);
  while (std::fabs(std::ldexp(mean, mean_bits - k)) > mean_code_max) ++k;
  return k;
}

/// Entries of N next to those of `n`, off the diagonal to the nearest and on it upwards by all that
/// was lost beside it: the difference is diagonally dominant.
bool round_up(const Matrix& n, int bits, QuantisedBelief& out) {
  const double step = step_of(bits);
  const double half = std::ldexp(1.0, bits - 1);
  Vector lost = Vector::Zero(n.rows());
  std::size_t at = 0;
  for (Eigen::Index i = 0; i < n.rows(); ++i) {
    for (Eigen::Index j = i; j < n.rows(); ++j, ++at) {
      if (i == j) continue;
      const double code = std::clamp(std::nearbyint(n(i, j) / step), -half, half - 1.0);
      const double error = std::fabs(code * step - n(i, j));
      lost(i) += error;
      lost(j) += error;
      out.entries[at] = static_cast<std::uint16_t>(code + half);
    }
  }
  at = 0;
  for (Eigen::Index i = 0; i < n.rows(); at += static_cast<std::size_t>(n.rows() - i), ++i) {
    const double code = std::ceil((n(i, i) + lost(i)) / step) - 1.0;
    if (!(code >= 0.0) || code >= 2.0 * half) return false;
    out.entries[at] = static_cast<std::uint16_t>(code);
  }
  return true;
}

}  // namespace

std::optional<Belief> diagonal_part(const Belief& belief) {
  const Scaled scaled = scale(belief.omega);
  if (scaled.cholesky.size() == 0) return std::nullopt;
  const auto mean = state(belief);
  if (!mean || !all_finite(*mean)) return std::nullopt;
  const Eigen::Index n = belief.omega.rows();
  Matrix correlation = scaled.matrix;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double root = 1.0 / std::sqrt(scaled.matrix(i, i));
    correlation.row(i) *= root;
    correlation.col(i) *= root;
  }
  const double least = eigenvalues(correlation)(0) - rounding * static_cast<double>(n);
  if (!(least > 0.0)) return std::nullopt;
  Belief out = Belief::unknown(static_cast<int>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    out.omega(i, i) = least * belief.omega(i, i);
    out.xi(i) = out.omega(i, i) * (*mean)(i);
  }
  return out;
}

// With an error e of the mean and q of its rounding, for any a > 0
//     E (e+q)(e+q)ᵀ ≤ (1+a) Σ + (1+1/a) q qᵀ,   q qᵀ ≤ n diag(q²),   |qᵢ| ≤ 2^(kᵢ−13).
std::optional<QuantisedBelief> quantise(const Belief& belief, int bits) {
  const auto mean = state(belief);
  const auto P = covariance(belief);
  if (!mean || !P || !all_finite(*mean) || !all_finite(*P)) return std::nullopt;
  const Eigen::Index n = P->rows();
  QuantisedBelief out;
  out.dimension = static_cast<int>(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!((*P)(i, i) > 0.0)) return std::nullopt;
    const int k = exponent_for((*P)(i, i), (*mean)(i));
    if (k < -exponent_max || k > exponent_max) return std::nullopt;
    const auto at = static_cast<std::size_t>(i);
    out.exponents[at] = static_cast<std::int8_t>(k);
    out.means[at] =
        static_cast<std::int32_t>(std::nearbyint(std::ldexp((*mean)(i), mean_bits - k)));
  }
  const double a = std::ldexp(1.0, -mean_bits);
  const double off = std::ldexp(1.0, -mean_bits - 1);
  Matrix N(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const int k =
          out.exponents[static_cast<std::size_t>(i)] + out.exponents[static_cast<std::size_t>(j)];
      N(i, j) = (1.0 + a) * std::ldexp((*P)(i, j), -k);
    }
    N(j, j) += (1.0 + 1.0 / a) * static_cast<double>(n) * off * off + rounding;
  }
  if (!round_up(N, bits, out)) return std::nullopt;
  return out;
}

std::optional<Belief> belief_of(const QuantisedBelief& quantised, int bits) {
  const double step = step_of(bits);
  const double half = std::ldexp(1.0, bits - 1);
  const Eigen::Index n = quantised.dimension;
  require(n >= 1 && n <= dimension_max, "belief_of: the dimension must be 1 to 8");
  Vector mean(n);
  Matrix P(n, n);
  std::size_t at = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const int k = quantised.exponents[static_cast<std::size_t>(i)];
    mean(i) = std::ldexp(static_cast<double>(quantised.means[static_cast<std::size_t>(i)]),
                         k - mean_bits);
    for (Eigen::Index j = i; j < n; ++j, ++at) {
      const double code = quantised.entries[at];
      const double entry = (i == j ? code + 1.0 : code - half) * step;
      P(i, j) = P(j, i) = std::ldexp(entry, k + quantised.exponents[static_cast<std::size_t>(j)]);
    }
  }
  if (scale(P).cholesky.size() == 0) return std::nullopt;
  return Belief::from_moments(mean, P);
}

Matrix gain_of(const Matrix& omega, const Matrix& omega_sent) {
  const Scaled scaled = scale(omega);
  require(scaled.invertible(), "gain_of: the belief is singular");
  Matrix rhs = omega_sent;
  scale_rows(rhs, scaled.factor);
  Matrix gain = solve(scaled, rhs);
  scale_rows(gain, scaled.factor);
  return gain.transpose();
}

}  // namespace hearsay::gaussian
