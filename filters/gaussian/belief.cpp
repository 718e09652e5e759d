#include "filters/gaussian/belief.hpp"

#include <algorithm>
#include <cmath>

#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::gaussian {
namespace {

constexpr double log_2 = 0.69314718055994530942;
constexpr double log_2_pi_e = 2.83787706640934548356;

/// Lower L and powers of two D (a diagonal) with Ω = D⁻¹LLᵀD⁻¹.
struct Factor {
  Matrix l;
  Vector d;
};

std::optional<Factor> factor(const Matrix& omega) {
  const Scaled scaled = scale(omega);
  if (scaled.cholesky.size() == 0) return std::nullopt;
  return Factor{scaled.cholesky, scaled.factor};
}

/// L⁻¹D·m: the whitened m, so that gram() of it is mᵀΩ⁻¹m.
Matrix whitened(const Factor& f, const Matrix& m) {
  Matrix w = m;
  scale_rows(w, f.d);
  solve_lower(f.l, w);
  return w;
}

double log_determinant(const Factor& f) {
  double sum = 0.0;
  int exponents = 0;
  for (Eigen::Index i = 0; i < f.l.rows(); ++i) {
    int exponent = 0;
    std::frexp(f.d(i), &exponent);  // ½·2^exponent
    exponents += exponent - 1;
    sum += math::log(f.l(i, i));
  }
  return 2.0 * (sum - log_2 * exponents);
}

/// μ = Ω⁻¹ξ.
std::optional<Vector> mean(const Factor& f, const Vector& xi) {
  Matrix x = whitened(f, xi);
  solve_lower_transposed(f.l, x);
  scale_rows(x, f.d);
  if (!all_finite(x)) return std::nullopt;
  return Vector(x);
}

/// eᵀΩe.
double quadratic(const Matrix& omega, const Vector& e) {
  double sum = 0.0;
  for (Eigen::Index j = 0; j < e.size(); ++j) {
    for (Eigen::Index i = 0; i < e.size(); ++i) sum += e(i) * omega(i, j) * e(j);
  }
  return sum;
}

/// Ω⁻¹ξ of an equilibrated Ω.
std::optional<Vector> state_of(const Scaled& scaled, const Vector& xi) {
  if (!scaled.invertible()) return std::nullopt;
  Matrix x = xi;
  scale_rows(x, scaled.factor);
  x = solve(scaled, x);
  scale_rows(x, scaled.factor);
  if (!all_finite(x)) return std::nullopt;
  return Vector(x);
}

/// √(tr Ω⁻¹ / n) of an equilibrated Ω = D⁻¹LLᵀD⁻¹: the squares of all entries of L⁻¹D are added up.
std::optional<double> claimed_sigma_of(const Scaled& scaled) {
  const Matrix& l = scaled.cholesky;
  const Eigen::Index n = l.rows();
  if (n == 0) return std::nullopt;
  double trace = 0.0;
  for (Eigen::Index j = 0; j < n; ++j) {
    double column[dimension_max];
    double squares = 0.0;
    for (Eigen::Index i = j; i < n; ++i) {
      double x = i == j ? scaled.factor(j) : 0.0;
      for (Eigen::Index k = j; k < i; ++k) x -= l(i, k) * column[k];
      column[i] = x / l(i, i);
      squares += column[i] * column[i];
    }
    trace += squares;
  }
  if (!std::isfinite(trace)) return std::nullopt;
  return std::sqrt(trace / static_cast<double>(n));
}

std::optional<double> if_finite(double value) {
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

const char* to_string(Definiteness definiteness) {
  switch (definiteness) {
    case Definiteness::positive:
      return "positive";
    case Definiteness::singular:
      return "singular";
    case Definiteness::indefinite:
      return "indefinite";
    case Definiteness::overflow:
      return "overflow";
  }
  return "unknown";
}

Belief Belief::unknown(int n) {
  require(n >= 1 && n <= dimension_max, "Belief::unknown: the dimension must be 1 to 8");
  return Belief{Matrix::Zero(n, n), Vector::Zero(n)};
}

Belief Belief::from_moments(const Vector& mean, const Matrix& covariance) {
  const auto n = static_cast<int>(mean.size());
  require(n >= 1 && n <= dimension_max, "Belief::from_moments: the dimension must be 1 to 8");
  return measurement_information(Matrix::Identity(n, n), covariance, mean);
}

Belief& Belief::operator+=(const Belief& other) {
  require(dimension() == other.dimension(), "Belief +=: dimensions differ");
  omega += other.omega;
  xi += other.xi;
  return *this;
}

Belief& Belief::operator-=(const Belief& other) {
  require(dimension() == other.dimension(), "Belief -=: dimensions differ");
  omega -= other.omega;
  xi -= other.xi;
  return *this;
}

Belief& Belief::operator*=(double scalar) {
  omega *= scalar;
  xi *= scalar;
  return *this;
}

Belief lifted(const Belief& information, int n) {
  const int known = information.dimension();
  require(known <= n, "lifted: the information has more dimensions than the state");
  if (known == n) return information;
  Belief belief = Belief::unknown(n);
  belief.omega.topLeftCorner(known, known) = information.omega;
  belief.xi.head(known) = information.xi;
  return belief;
}

Belief measurement_information(const Matrix& M, const Matrix& S, const Vector& z) {
  require(M.rows() == z.size() && S.rows() == z.size() && S.cols() == z.size() && M.cols() >= 1,
          "measurement: the shapes of M (m×n), S (m×m) and z (m) disagree");
  require(M.allFinite() && z.allFinite(), "measurement: M and z must be finite");
  const auto f = factor(S);
  require(f.has_value(), "the covariance is not positive definite");
  const Matrix w = whitened(*f, M);
  const Matrix wz = whitened(*f, z);
  return Belief{gram(w), w.transpose().lazyProduct(wz)};
}

Definiteness definiteness(const Belief& belief) {
  if (!all_finite(belief.xi)) return Definiteness::overflow;
  return scale(belief.omega).definiteness;
}

std::optional<Vector> state(const Belief& belief) {
  if (!all_finite(belief.xi)) return std::nullopt;
  return state_of(scale(belief.omega), belief.xi);
}

std::optional<Matrix> covariance(const Belief& belief) {
  if (!all_finite(belief.xi)) return std::nullopt;
  const auto f = factor(belief.omega);
  if (!f) return std::nullopt;
  const Matrix sigma = gram(whitened(*f, Matrix::Identity(f->l.rows(), f->l.cols())));
  if (!all_finite(sigma)) return std::nullopt;
  return sigma;
}

std::optional<double> log_determinant(const Matrix& omega) {
  const auto f = factor(omega);
  if (!f) return std::nullopt;
  return log_determinant(*f);
}

std::optional<double> entropy_nats(const Belief& belief) {
  if (!all_finite(belief.xi)) return std::nullopt;
  const auto log_det = log_determinant(belief.omega);
  if (!log_det) return std::nullopt;
  return 0.5 * (belief.dimension() * log_2_pi_e - *log_det);
}

std::optional<double> kl_divergence_nats(const Belief& p, const Belief& q) {
  require(p.dimension() == q.dimension(), "kl_divergence_nats: dimensions differ");
  if (!all_finite(p.xi) || !all_finite(q.xi)) return std::nullopt;
  const auto fp = factor(p.omega);
  const auto fq = factor(q.omega);
  if (!fp || !fq) return std::nullopt;
  const auto mean_p = mean(*fp, p.xi);
  const auto mean_q = mean(*fq, q.xi);
  if (!mean_p || !mean_q) return std::nullopt;

  Matrix root_q = fq->l;  // D⁻¹L of q: Ω_q = root·rootᵀ
  scale_rows(root_q, fq->d.cwiseInverse());
  const double trace = whitened(*fp, root_q).squaredNorm();
  const double distance = quadratic(q.omega, *mean_q - *mean_p);
  const double kl =
      0.5 * (trace - p.dimension() + distance + log_determinant(*fp) - log_determinant(*fq));
  return if_finite(kl < 0.0 ? 0.0 : kl);  // below zero by rounding only
}

std::optional<double> nees(const Belief& belief, const Vector& truth) {
  require(belief.dimension() == truth.size(), "nees: dimensions differ");
  const auto mu = state(belief);
  if (!mu) return std::nullopt;
  return nees_of_error(belief, *mu - truth);
}

std::optional<double> nees_of_error(const Belief& belief, const Vector& error) {
  require(belief.dimension() == error.size(), "nees_of_error: dimensions differ");
  return if_finite(quadratic(belief.omega, error));
}

std::optional<double> mahalanobis_squared(const Vector& e, const Matrix& P) {
  require(P.rows() == e.size(), "mahalanobis_squared: dimensions differ");
  const Scaled scaled = scale(P);
  if (scaled.definiteness != Definiteness::positive) return std::nullopt;
  Matrix De = e;  // P⁻¹ = D M⁻¹ D
  scale_rows(De, scaled.factor);
  return if_finite(De.cwiseProduct(solve(scaled, De)).sum());
}

std::optional<double> claimed_sigma(const Belief& belief) {
  if (!all_finite(belief.xi)) return std::nullopt;
  return claimed_sigma_of(scale(belief.omega));
}

Assessment assess(const Belief& belief) {
  if (!all_finite(belief.xi)) return {};
  const Scaled scaled = scale(belief.omega);
  return {scaled.definiteness, state_of(scaled, belief.xi), claimed_sigma_of(scaled)};
}

PositionMeasurement range_bearing_to_position(const Pose& pose, double range_m, double bearing_rad,
                                              const RangeBearingNoise& noise) {
  require(range_m > 0.0, "range_bearing_to_position: the range must be positive");
  const double c = math::cos(pose.heading_rad + bearing_rad);
  const double s = math::sin(pose.heading_rad + bearing_rad);
  const double along = noise.sigma_range_m * noise.sigma_range_m;
  const double across = range_m * range_m *
                        (noise.sigma_bearing_rad * noise.sigma_bearing_rad +
                         noise.sigma_heading_rad * noise.sigma_heading_rad);
  const double position = noise.sigma_position_m * noise.sigma_position_m;
  PositionMeasurement out{Vector(2), Matrix(2, 2)};
  out.z << pose.x_m + range_m * c, pose.y_m + range_m * s;
  const double xy = (along - across) * c * s;
  out.S << along * c * c + across * s * s + position, xy,  //
      xy, along * s * s + across * c * c + position;
  return out;
}

}  // namespace hearsay::gaussian
