// Covariance intersection of any number of beliefs at once:
//
//     Ω = Σ ωᵢΩᵢ,   ξ = Σ ωᵢξᵢ,   ω ≥ 0, Σ ωᵢ = 1, and |Ω| the greatest.
//
// Conservative for any correlations, as each step of pairwise intersection is, but it does not
// matter in which order beliefs came. log |Ω| is concave in ω, and at its maximum tr(Ω⁻¹Ωᵢ) ≤ n,
// with equality wherever ωᵢ > 0 (as in optimal design of experiments: Kiefer & Wolfowitz 1960).
#pragma once

#include <span>
#include <vector>

#include "filters/gaussian/belief.hpp"

namespace hearsay::gaussian {

/// Finds the weights; reuses its storage from one call to the next.
class BatchIntersection {
 public:
  /// ω for these matrices, all n×n, finite and positive semi-definite; at least one. Valid until
  /// the next call. Where they determine Ω together but not ω, as equal matrices do, each gets the
  /// same share. What is singular in all of them together is left out: the criterion is the
  /// determinant on the range of their sum. All of them zero: equal weights. tr(Ω⁻¹Ωᵢ) ≤ n holds
  /// to about 1e-10.
  /// Primal-dual interior-point iteration, at most 100 steps of k³/3 + k²n² + kn³ operations for k
  /// matrices. @throws BrokenInvariant if there is none, or their dimensions differ.
  std::span<const double> weights(std::span<const Matrix* const> omegas);

 private:
  void prepare(std::span<const Matrix* const> omegas);
  bool evaluate();
  bool find_step(double target);
  double step_length() const;
  void settle();
  std::size_t size() const { return omega_.size(); }
  double& curvature(std::size_t i, std::size_t j) { return curvature_[i * size() + j]; }
  double curvature(std::size_t i, std::size_t j) const { return curvature_[i * size() + j]; }

  int rank_ = 0;
  std::vector<Matrix> parts_;   // each Ωᵢ in coordinates in which their sum is I (r×r)
  std::vector<Matrix> shares_;  // L⁻¹ part L⁻ᵀ with Σ ωᵢ partᵢ = LLᵀ
  std::vector<double> omega_;   // ω > 0
  std::vector<double> slack_;   // z > 0, r − tr(Ω⁻¹Ωᵢ) at the optimum
  std::vector<double> slope_;   // tr(Ω⁻¹Ωᵢ)
  std::vector<double> curvature_, factor_;
  std::vector<double> step_, slack_step_;
};

/// The Metropolis weight of a neighbour in consensus, 1/(1 + the greater of the two numbers of
/// neighbours). L. Xiao, S. Boyd, S. Lall, IPSN 2005. Both ≥ 0.
double metropolis_weight(int degree_a, int degree_b);

}  // namespace hearsay::gaussian
