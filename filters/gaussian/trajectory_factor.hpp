// What a trajectory says: means, marginal covariances, log-determinant, divergence, and the weight
// of covariance intersection. All in time linear in the number of steps.
//
// Block Cholesky factorisation from the first step to the last, P_k = L_kL_kᵀ:
//     P_0 = Ω_0,0,   W_k = L_k⁻¹Ω_k,k+1,   P_k+1 = Ω_k+1,k+1 − W_kᵀW_k,
// and back again for means and for the blocks of Σ = Ω⁻¹ that touch the diagonal (what is known as
// fixed-interval smoothing). Each step is scaled by powers of two to a diagonal in [½, 2), so units
// do not matter and nothing overflows.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "filters/gaussian/trajectory.hpp"

namespace hearsay::gaussian {

/// A factorisation of one trajectory at a time. It keeps its room: no allocation for trajectories
/// that are not longer than those before. Everything below speaks of the trajectory given last.
class TrajectoryFactor {
 public:
  /// @return positive; or singular, indefinite, overflow, judged at the first step whose P_k is not
  /// positive definite (in the sense of `definiteness`; what comes behind is not looked at). Then
  /// nothing else may be asked.
  Definiteness factor(const Trajectory& trajectory);

  /// μ_k of every step.
  const std::vector<Vector>& means();
  /// Σ_k,k (n×n) of every step.
  const std::vector<Matrix>& covariances();
  /// log det Ω.
  double log_determinant() const { return log_determinant_; }
  /// tr(ΘΣ) for another block tridiagonal matrix Θ of the same shape.
  double trace_with(const Trajectory& other);

 private:
  // One step, equilibrated.
  struct Step {
    Vector factor;  // D: powers of two
    Matrix l;       // L_k
    Matrix w;       // W_k; empty at the last step
    Vector y;       // L_k⁻¹ of what is left of ξ_k
  };
  std::vector<Step> steps_;
  std::size_t size_ = 0;
  double log_determinant_ = 0.0;
  std::vector<Vector> means_;
  std::vector<Matrix> covariances_;
};

/// D(p ‖ q) in nats over whole trajectories of the same stamps, never negative; nothing unless both
/// are positive definite.
std::optional<double> kl_divergence_nats(const Trajectory& p, const Trajectory& q);

/// (x − μ)ᵀΩ(x − μ) of states `truth` (n each, one a step): its mean is n·steps for a consistent
/// belief. Nothing unless Ω is positive definite.
std::optional<double> nees(const Trajectory& trajectory, std::span<const Vector> truth);
/// The same, with room to work in; `truth` is not what lies in there.
std::optional<double> nees(const Trajectory& trajectory, std::span<const Vector> truth,
                           TrajectoryFactor& room);

/// ω in [0, 1] that maximises |ωΩ_a + (1−ω)Ω_b| over the whole block matrix: covariance
/// intersection by determinant (Merino 2007, eq. 3.45–3.46 on trajectories). ½ if the determinant
/// does not depend on it. Nothing if no convex combination of the two is positive definite.
std::optional<double> intersect_det(const Trajectory& a, const Trajectory& b);

}  // namespace hearsay::gaussian
