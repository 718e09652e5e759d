// What a non-linear measurement tells, as information to be added to a belief: by the extended
// filter and by the unscented one. Merino 2007, section 3.3, eq. 3.50–3.52.
//
// Both give Ω = HᵀR⁻¹H, ξ = HᵀR⁻¹(z − c) of a model z ≈ Hx + c + N(0, R), which is then fused like
// any other. They differ in where H, c and R come from, and in what they ask of the belief.
#pragma once

#include <optional>

#include "filters/gaussian/belief.hpp"
#include "filters/gaussian/propagation.hpp"
#include "filters/gaussian/sightings.hpp"

namespace hearsay::gaussian {

/// Why there is no information.
enum class Refusal {
  none,
  no_point,     ///< the belief has no mean to linearise at, and no other point was given
  not_seen,     ///< the model has no value there, or at one of the sigma points
  no_spread,    ///< unscented: the belief has no covariance
  no_gaussian,  ///< unscented: the linearisation error came out indefinite (a negative κ)
};
const char* to_string(Refusal refusal);

struct Told {
  std::optional<Belief> information;
  Refusal refusal = Refusal::none;  ///< not none where there is no information
};

/// z ≈ Hx + c, with S (m×m) its own noise.
struct LinearModel {
  Matrix H;          ///< m×n
  Matrix R;          ///< m×m
  Vector from_mean;  ///< z − h(point), angles wrapped (m)
  Vector point;      ///< n
};
/// @throws BrokenInvariant unless z (m) and S (m×m) fit what is measured (m), S positive definite.
void require_measurement(const Vector& z, const Matrix& S, const Vector& measured);

/// Information of that: Ω = HᵀR⁻¹H, ξ = HᵀR⁻¹(from_mean + H·point). @throws BrokenInvariant unless
/// R is positive definite.
Belief information_of(const LinearModel& model);

/// The linear model closest to `h` in the mean square under the belief: H = Cov(z, x)Σ⁻¹, and R = S
/// and what of Cov(z) H does not explain, so that the update equals that of the unscented Kalman
/// filter. Nothing unless R comes out positive definite.
std::optional<LinearModel> regression(const Moments& x, const Belief& belief, const Propagated& h,
                                      const Matrix& S, const Vector& from_mean);

/// The extended filter: first order at `at`, or, where that is not given, at the belief's mean.
/// With a given point any belief is legal, also one that knows nothing. z (m), S (m×m).
/// @throws BrokenInvariant if S is not positive definite.
template <MeasurementModel Model>
Told extended_information(const Belief& belief, const Model& model, const Vector& z,
                          const Matrix& S, std::optional<Vector> at = std::nullopt) {
  if (!at) at = state(belief);
  if (!at) return {.information = std::nullopt, .refusal = Refusal::no_point};
  const std::optional<Vector> h = model.value(*at);
  const std::optional<Matrix> H = model.jacobian(*at);
  if (!h || !H) return {.information = std::nullopt, .refusal = Refusal::not_seen};
  require_measurement(z, S, *h);
  return {.information = information_of({*H, S, model.difference(z, *h), *at})};
}

/// The unscented filter: statistical linearisation over the sigma points of the belief, which must
/// be positive definite. z (m), S (m×m). @throws BrokenInvariant if S is not positive definite, and
/// unless n + κ > 0.
template <MeasurementModel Model>
Told unscented_information(const Belief& belief, const Model& model, const Vector& z,
                           const Matrix& S, double kappa) {
  const std::optional<Moments> x = moments(belief);
  if (!x) return {.information = std::nullopt, .refusal = Refusal::no_spread};
  const std::optional<Propagated> h = unscented(
      *x, kappa, [&](const Vector& at) { return model.value(at); },
      [&](const Vector& a, const Vector& b) { return model.difference(a, b); });
  if (!h) return {.information = std::nullopt, .refusal = Refusal::not_seen};
  require_measurement(z, S, h->y.mean);
  const auto linear = regression(*x, belief, *h, S, model.difference(z, h->y.mean));
  if (!linear) return {.information = std::nullopt, .refusal = Refusal::no_gaussian};
  return {.information = information_of(*linear)};
}

}  // namespace hearsay::gaussian
