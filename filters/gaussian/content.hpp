// Beliefs made smaller to be sent, so that they never claim more than they did.
//
// Both keep the mean (to rounding, which is paid for) and claim a larger covariance: whoever was
// conservative stays so.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "filters/gaussian/belief.hpp"

namespace hearsay::gaussian {

/// The belief with the diagonal information matrix λ·diag(Ω) ≤ Ω and the same mean, λ the least
/// eigenvalue of Ω scaled to unit diagonal: units do not matter. Nothing unless Ω is positive
/// definite.
std::optional<Belief> diagonal_part(const Belief& belief);

inline constexpr int quantised_bits_min = 4;
inline constexpr int quantised_bits_max = 16;

/// A belief on a grid: mean(i) = means[i]·2^(exponents[i] − 12) and covariance
/// Σ(i, j) = 2^(exponents[i] + exponents[j])·N(i, j), the upper triangle of N by rows in `entries`:
/// on the diagonal (code + 1)·2^(1−bits), beside it (code − 2^(bits−1))·2^(1−bits).
struct QuantisedBelief {
  int dimension = 0;
  std::array<std::int8_t, dimension_max> exponents{};
  std::array<std::int32_t, dimension_max> means{};
  std::array<std::uint16_t, dimension_max*(dimension_max + 1) / 2> entries{};
};

/// The grid belief next to this one whose covariance contains Σ widened by the rounding of the
/// mean, however that is correlated with the error. `bits` of an entry of N: 4 to 16. Nothing
/// unless Ω is positive definite, and all standard deviations and means fit: σ within 2^±126, means
/// below 2^18 times the largest σ there is.
std::optional<QuantisedBelief> quantise(const Belief& belief, int bits);

/// Nothing if its covariance is not positive definite, as in a message that nobody quantised.
std::optional<Belief> belief_of(const QuantisedBelief& quantised, int bits);

/// G with G·Ω = Ω_sent (n×n), so that ξ_sent = Gξ where the mean is kept. Ω positive definite.
Matrix gain_of(const Matrix& omega, const Matrix& omega_sent);

}  // namespace hearsay::gaussian
