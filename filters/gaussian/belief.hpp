// A Gaussian belief in information form about a static state of small dimension n.
//
// Ω (n×n, symmetric) is the information matrix, ξ = Ωμ (n) the information vector. Ω = 0 is a legal
// belief that knows nothing; singular Ω are legal; fusion rules with faults can even produce
// indefinite ones, which is something to be measured, not hidden. Hence `state()` and
// `covariance()` return nothing where they do not exist. Merino 2007, eq. 3.8–3.9, Algorithm 3.2.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace hearsay::gaussian {

/// Largest state dimension. Beliefs hold their numbers inline: no allocation.
inline constexpr int dimension_max = 8;

using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, dimension_max, 1>;
using Matrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, dimension_max, dimension_max>;

/// How much a belief's Ω determines.
enum class Definiteness {
  positive,    ///< positive definite: mean and covariance exist
  singular,    ///< positive semi-definite to rounding: some direction is unknown
  indefinite,  ///< a direction of negative information: no Gaussian at all
  overflow,    ///< an entry is not finite
};
const char* to_string(Definiteness definiteness);

struct Belief {
  Matrix omega;  ///< Ω
  Vector xi;     ///< ξ

  /// Knows nothing about an n-dimensional state, 1 ≤ n ≤ dimension_max.
  static Belief unknown(int n);
  /// N(mean, covariance). @throws BrokenInvariant if the covariance is not positive definite.
  static Belief from_moments(const Vector& mean, const Matrix& covariance);

  int dimension() const { return static_cast<int>(xi.size()); }

  /// This belief and independent information: Ω += other.Ω, ξ += other.ξ (eq. 3.9, 3.36).
  Belief& operator+=(const Belief& other);
  /// Takes information out again; may leave an indefinite belief.
  Belief& operator-=(const Belief& other);
  Belief& operator*=(double factor);
};

/// Information about the first numbers of a state as information about all n of them.
/// @throws BrokenInvariant if it has more than n.
Belief lifted(const Belief& information, int n);

/// A measurement z = Mx + v, v ~ N(0, S), as information: Ω = MᵀS⁻¹M, ξ = MᵀS⁻¹z (eq. 3.34–3.35).
/// M is m×n, S m×m positive definite, z m. @throws BrokenInvariant if S is not.
Belief measurement_information(const Matrix& M, const Matrix& S, const Vector& z);

/// Judged by the eigenvalues of Ω scaled to unit diagonal (by powers of two, so within a factor of
/// two); singular below n·1e-13 of the largest. Hence units of the state do not matter.
Definiteness definiteness(const Belief& belief);

/// μ = Ω⁻¹ξ. Nothing unless Ω is non-singular. (Also for indefinite Ω: it is what a user of such a
/// belief would compute.)
std::optional<Vector> state(const Belief& belief);

/// Σ = Ω⁻¹; nothing unless Ω is positive definite.
std::optional<Matrix> covariance(const Belief& belief);

/// log det Ω by Cholesky; nothing unless positive definite.
std::optional<double> log_determinant(const Matrix& omega);

/// Differential entropy in nats, ½ log((2πe)ⁿ/|Ω|); nothing unless positive definite.
std::optional<double> entropy_nats(const Belief& belief);

/// D(p ‖ q) in nats, never negative; nothing unless both are positive definite.
std::optional<double> kl_divergence_nats(const Belief& p, const Belief& q);

/// (μ − x)ᵀΩ(μ − x), raw: its mean is n for a consistent belief. Nothing where μ does not exist;
/// negative for an indefinite Ω.
std::optional<double> nees(const Belief& belief, const Vector& truth);

/// The same for one who knows the mean: eᵀΩe of its error e = μ − x (n).
std::optional<double> nees_of_error(const Belief& belief, const Vector& error);

/// eᵀP⁻¹e of an error e (n) under a covariance P (n×n); nothing unless P is positive definite.
std::optional<double> mahalanobis_squared(const Vector& e, const Matrix& P);

/// √(tr Σ / n): claimed standard deviation per axis; nothing unless positive definite.
std::optional<double> claimed_sigma(const Belief& belief);

/// What definiteness(), state() and claimed_sigma() say, from one factorisation of Ω.
struct Assessment {
  Definiteness definiteness = Definiteness::overflow;
  std::optional<Vector> state;
  std::optional<double> claimed_sigma;
};
Assessment assess(const Belief& belief);

/// A range-bearing sighting from a pose that is itself uncertain, as a position measurement
/// z (2), S (2×2) in the plane, first order: σ_range² along the line of sight,
/// r²(σ_bearing² + σ_heading²) across it, σ_position² on both axes. range > 0; bearing relative to
/// the heading. @throws BrokenInvariant for another range.
struct Pose {
  double x_m, y_m, heading_rad;
};
struct RangeBearingNoise {
  double sigma_range_m;
  double sigma_bearing_rad;
  double sigma_heading_rad;
  double sigma_position_m;  ///< per axis
};
struct PositionMeasurement {
  Vector z;
  Matrix S;
};
PositionMeasurement range_bearing_to_position(const Pose& pose, double range_m, double bearing_rad,
                                              const RangeBearingNoise& noise);

}  // namespace hearsay::gaussian
