#include "filters/gaussian/nonlinear.hpp"

#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {

const char* to_string(Refusal refusal) {
  switch (refusal) {
    case Refusal::none:
      return "none";
    case Refusal::no_point:
      return "no point to linearise at";
    case Refusal::not_seen:
      return "not seen from there";
    case Refusal::no_spread:
      return "no covariance to spread points over";
    case Refusal::no_gaussian:
      return "indefinite linearisation error";
  }
  return "unknown";
}

void require_measurement(const Vector& z, const Matrix& S, const Vector& measured) {
  const Eigen::Index m = measured.size();
  require(z.size() == m && S.rows() == m && S.cols() == m,
          "measurement: the shapes of z (m), S (m×m) and h(x) (m) disagree");
  require(scale(S).definiteness == Definiteness::positive,
          "the covariance is not positive definite");
}

Belief information_of(const LinearModel& model) {
  require(model.H.cols() == model.point.size() && model.H.rows() == model.from_mean.size(),
          "linear model: the shapes of H (m×n), point (n) and from_mean (m) disagree");
  return measurement_information(model.H, model.R,
                                 model.from_mean + model.H.lazyProduct(model.point));
}

std::optional<LinearModel> regression(const Moments& x, const Belief& belief, const Propagated& h,
                                      const Matrix& S, const Vector& from_mean) {
  const Matrix H = h.cross.transpose().lazyProduct(belief.omega);
  const Matrix explained = H.lazyProduct(h.cross);
  const Matrix rest = h.y.covariance - explained;
  const Matrix R = S + 0.5 * (rest + rest.transpose());
  if (scale(R).definiteness != Definiteness::positive) return std::nullopt;
  return LinearModel{H, R, from_mean, x.mean};
}

}  // namespace hearsay::gaussian
