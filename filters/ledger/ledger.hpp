// The rumour ledger: how often each measurement is counted in a belief.
//
// Out of band, beside each belief, the simulator carries the weight w_k of every measurement k in
// it: 1 when used once, k when counted k times, fractions under covariance intersection, negative
// when information that was never there is taken away. Weights are combined with the coefficients
// of the fusion rule itself. For static linear-Gaussian problems without prior
//     Ω = Σ w_k M_kᵀS_k⁻¹M_k   and   P_true = Ω⁻¹ (Σ w_k² M_kᵀS_k⁻¹M_k) Ω⁻¹,
// so the true covariance of the estimate is known without Monte Carlo. Rules that weigh direction
// by direction give each measurement a matrix W_k instead (n×n, ξ = Σ W_kM_kᵀS_k⁻¹z_k), and
// P_true = Ω⁻¹ (Σ W_k M_kᵀS_k⁻¹M_k W_kᵀ) Ω⁻¹; its weight is then tr W_k/n.
//
// Where the state moves, x' = Ax + w with w ~ N(0, R), prediction weakens what is known, and what
// was measured at different times has the noise of the motion in common. Then each measurement has
// a matrix and a scalar: the scalar is its multiplicity, combined by the rules alone; the matrix is
// what prediction left of it. And each step s of the motion is one more source, with a matrix H_s:
//     ξ − Ωx = Σ W_k M_kᵀS_k⁻¹v_k + Σ H_s w_s,
//     P_true = Ω⁻¹ (Σ W_k M_kᵀS_k⁻¹M_k W_kᵀ + Σ H_s R H_sᵀ) Ω⁻¹,
// exact, correlations by the common motion included, while no gain depends on measured values.
//
// Beside the weights it carries, independently of them, the set of measurements that can have
// travelled here at all (`reach`).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "filters/gaussian/belief.hpp"

namespace hearsay {

/// All measurements of one subject in a run, in the order in which they were made.
class MeasurementBook {
 public:
  explicit MeasurementBook(int dimension) : dimension_(dimension) {}
  /// @return the measurement's index, from 0.
  std::size_t add(const gaussian::Belief& information);
  std::size_t size() const { return count_; }
  int dimension() const { return dimension_; }
  /// The k-th, k < size().
  gaussian::Belief information(std::size_t k) const;
  /// Σ over k of weights[k] · information k; weights beyond the end count as zero.
  gaussian::Belief weighted_sum(std::span<const double> weights) const;
  /// Σ over the k with chosen[k] ≠ 0: what a central filter over these measurements believes.
  gaussian::Belief sum_over(std::span<const std::uint8_t> chosen) const;
  /// Σ W_k ξ_k, or of all Ω_k, with W_k n×n by columns: what a ledger with matrices says.
  gaussian::Belief weighted_sum_of(std::span<const double> matrices) const;
  /// The state moves, with this R (n×n) in each step; a matrix that is not finite: nobody knows
  /// how.
  void set_motion(const gaussian::Matrix& R) { motion_ = R; }
  /// R; empty (0×0) where the state stands still.
  const gaussian::Matrix& motion() const { return motion_; }
  /// Σ W_k M_kᵀS_k⁻¹M_k W_kᵀ (n×n).
  gaussian::Matrix weighted_square_of(std::span<const double> matrices) const;
  /// Σ H_s R H_sᵀ (n×n), with H_s n×n by columns.
  gaussian::Matrix motion_square_of(std::span<const double> drift) const;
  /// Σ (scale·w_k)² M_kᵀS_k⁻¹M_k (n×n). A scale keeps the squares of huge weights finite.
  gaussian::Matrix weighted_square(std::span<const double> weights, double scale = 1.0) const;

 private:
  int dimension_;
  std::size_t count_ = 0;
  gaussian::Matrix motion_;
  std::vector<double> information_;  // upper triangle of Ω by rows, then ξ, for each measurement
};

/// The weights and the reach of one belief. Grows with the highest measurement it has met.
class Ledger {
 public:
  Ledger() = default;
  /// Of a belief about a state of dimension n that moves.
  static Ledger moving(int n);
  Ledger(const Ledger&) = default;
  Ledger(Ledger&&) = default;
  Ledger& operator=(Ledger&&) = default;
  /// Copies; where there is no room, makes it for twice as much: what was heard last is overwritten
  /// by an ever longer ledger, again and again.
  Ledger& operator=(const Ledger& other);

  /// Measurement `index` was used once, directly (its weight grows by one).
  void measured(std::size_t index);
  /// this = a·this + b·received − c·common; reach = union of this and received. `common` may be
  /// nullptr (nothing in common yet) and is not looked at for c = 0. No allocation once this ledger
  /// has the capacity. With matrices on either side the result has matrices, and c must be 0.
  /// @throws BrokenInvariant if `common` is this ledger itself.
  void combine(double a, double b, const Ledger& received, double c, const Ledger* common);
  /// this = G_a·this + G_b·received, weight by weight (n×n); reach as above.
  void combine(const gaussian::Matrix& own, const gaussian::Matrix& heard, const Ledger& received);
  /// The belief was predicted over step `step` of the motion, counted from 0, and is Ω' = `omega`
  /// (n×n) now: W_k ← F W_k, H_s ← F H_s with F (n×n) of ξ' = Fξ, H_step ← −Ω'. Only for a moving
  /// state.
  void predict(const gaussian::Matrix& F, const gaussian::Matrix& omega, std::size_t step);
  /// w_k ← other.w_k where where[k] ≠ 0; reach = union of both. Not with matrices.
  void replace(const Ledger& other, std::span<const std::uint8_t> where);
  /// From here on weights do not say all: something was rounded, or was said because of its value.
  /// Whatever this ledger is combined into is inexact, too.
  void mark_inexact() { exact_ = false; }
  bool exact() const { return exact_; }
  void clear();

  /// All of it, to be carried to another process.
  struct Parts {
    std::vector<double> weights, matrices, drift;
    std::vector<std::uint8_t> reach;
    int dimension = 0;
    bool moves = false, exact = true;
  };
  Parts parts() const;
  /// @throws BrokenInvariant if lengths disagree.
  static Ledger from(Parts parts);

  std::span<const double> weights() const { return weights_; }
  /// W_k by columns, n² numbers for each measurement; empty as long as W_k = w_k·I for all.
  std::span<const double> matrices() const { return matrices_; }
  /// H_s by columns, n² numbers for each step of the motion.
  std::span<const double> drift() const { return drift_; }
  bool moves() const { return moves_; }
  /// 1 where measurement k can have contributed to this belief, else 0.
  std::span<const std::uint8_t> reach() const { return reach_; }

 private:
  void spread(int n);
  void combine_moving(double a, double b, const Ledger& received, double c, const Ledger* common);
  std::vector<double> weights_;
  std::vector<double> matrices_;
  std::vector<double> drift_;
  std::vector<std::uint8_t> reach_;
  int dimension_ = 0;  // of the matrices; 0 without
  bool moves_ = false;
  bool exact_ = true;
};

/// Over the measurements with |w| > 1e-12.
struct Multiplicity {
  double mean = 0.0;  ///< NaN if there is none
  double max = 0.0;
  double share_above_one = 0.0;  ///< share with w > 1 + 1e-9
  std::size_t measurements = 0;
};
Multiplicity multiplicity(const Ledger& ledger);

/// P_true of a belief with information matrix `omega` under `ledger` (n×n); nothing if the ledger
/// is not exact, Ω is singular or anything is not finite. Also for an indefinite Ω: the error of
/// what its user computes.
std::optional<gaussian::Matrix> true_covariance(const gaussian::Matrix& omega, const Ledger& ledger,
                                                const MeasurementBook& book);

/// The central filter over exactly the measurements in `ledger.reach()`, and how far `belief` is
/// from it: max(‖ΔΩ‖/‖Ω‖, ‖Δξ‖/‖ξ‖), Frobenius, relative to the central filter; 0 if both are
/// empty, infinite if the belief is not finite or only the central filter is empty. Reach only
/// grows (but for who forgets everything): a belief that gives back what it had been told, as
/// under channel-robust when a neighbour comes back without its memory, has a gap from then on.
double reach_gap(const gaussian::Belief& belief, const Ledger& ledger, const MeasurementBook& book);

}  // namespace hearsay
