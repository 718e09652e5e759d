// The slope of log |ωΩ_a + (1−ω)Ω_b| over two trajectories. Internal to filters/.
//
// With the block factorisation P_k = LDLᵀ at ω (L unit lower triangular, E = D⁻¹), dP_k and d²P_k
// the derivatives of P_k, and everything whitened by L alone,
//     X = L⁻¹dPL⁻ᵀ, Y = L⁻¹d²PL⁻ᵀ, W = L⁻¹Ω_k,k+1, V = L⁻¹d(Ω_k,k+1), Z = V − XEW,
// the next step and the sums are
//     P_k+1   = Ω_k+1,k+1 − WᵀEW,
//     dP_k+1  = d(Ω_k+1,k+1) − VᵀEW − (EW)ᵀZ,   f'  = Σ tr EX,
//     d²P_k+1 = (EW)ᵀYEW − 2ZᵀEZ,               f'' = Σ (tr EY − tr EXEX).
//
// There is no square root in it, so a scale of powers of two changes no bit of f' and f''. All
// matrices are kept by rows, and every loop over a row is one over independent sums: a compiler may
// take several at once, and the result is the same.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "filters/gaussian/block_cholesky.hpp"
#include "filters/gaussian/trajectory.hpp"

namespace hearsay::gaussian {

/// f' and f'' at one ω.
struct TrajectorySlope {
  double first;
  double second;
};

/// Goes through two trajectories of dimension N; of any dimension if N = 0.
template <int N>
class SlopeSweep {
 public:
  SlopeSweep(const Trajectory& a, const Trajectory& b) : a_(a), b_(b), dimension_(a.dimension()) {}

  /// At ωΩ_a + (1−ω)Ω_b; nothing unless it is positive definite.
  std::optional<TrajectorySlope> at(double omega) {
    TrajectorySlope sum{0.0, 0.0};
    for (int k = 0; k < a_.steps(); ++k) {
      mix(a_.omega(k).data(), b_.omega(k).data(), omega);
      if (k > 0) take_off_what_is_behind();
      if (!eliminate()) return std::nullopt;
      whiten_both(dP_, X_);
      add_traces(k > 0, sum);
      if (k + 1 < a_.steps()) look_ahead(k, omega);
    }
    return sum;
  }

 private:
  static constexpr int room = N > 0 ? N : dimension_max;
  using Row = std::array<double, room>;
  using Square = std::array<Row, room>;
  constexpr int n() const { return N > 0 ? N : dimension_; }

  /// P, dP ← Ω_k,k at ω and its derivative.
  void mix(const double* a, const double* b, double omega) {
    const double rest = 1.0 - omega;
    for (int i = 0; i < n(); ++i) {
      for (int j = 0; j < n(); ++j) {
        const double from_a = a[i * n() + j], from_b = b[i * n() + j];
        P_[i][j] = omega * from_a + rest * from_b;
        dP_[i][j] = from_a - from_b;
      }
    }
    for (int i = 0; i < n(); ++i) diagonal_[i] = P_[i][i];
  }

  void take_off_what_is_behind() {
    for (int i = 0; i < n(); ++i) {
      for (int j = 0; j < n(); ++j) P_[i][j] -= less_P_[i][j];
      for (int j = 0; j < n(); ++j) dP_[i][j] -= less_dP_[i][j];
    }
  }

  /// P's upper triangle ← Lᵀ, E. False unless every pivot is positive and not negligible beside
  /// what the diagonal was before anything was taken off it.
  bool eliminate() {
    for (int k = 0; k < n(); ++k) {
      const double pivot = P_[k][k];
      if (!(pivot > n() * singular_below * diagonal_[k])) return false;
      E_[k] = 1.0 / pivot;
      if (!std::isfinite(E_[k]) || !std::isfinite(pivot)) return false;
      Row l;
      for (int j = 0; j < n(); ++j) l[j] = P_[k][j] * E_[k];
      for (int i = k + 1; i < n(); ++i) {
        for (int j = 0; j < n(); ++j) P_[i][j] -= l[i] * P_[k][j];
      }
      P_[k] = l;
    }
    return true;
  }

  /// x ← L⁻¹x.
  void whiten(Square& x) const {
    for (int i = 1; i < n(); ++i) {
      Row row = x[i];
      for (int k = 0; k < i; ++k) {
        const double l = P_[k][i];
        for (int j = 0; j < n(); ++j) row[j] -= l * x[k][j];
      }
      x[i] = row;
    }
  }

  /// out ← L⁻¹xL⁻ᵀ of a symmetric x.
  void whiten_both(Square& x, Square& out) const {
    whiten(x);
    for (int i = 0; i < n(); ++i) {
      for (int j = 0; j < n(); ++j) out[i][j] = x[j][i];
    }
    whiten(out);
  }

  /// out ← EX.
  void weigh(const Square& x, Square& out) const {
    for (int i = 0; i < n(); ++i) {
      for (int j = 0; j < n(); ++j) out[i][j] = E_[i] * x[i][j];
    }
  }

  /// out ← out + sign·AB.
  void add_product(double sign, const Square& a, const Square& b, Square& out) const {
    for (int i = 0; i < n(); ++i) {
      Row row = out[i];
      for (int k = 0; k < n(); ++k) {
        const double factor = sign * a[i][k];
        for (int j = 0; j < n(); ++j) row[j] += factor * b[k][j];
      }
      out[i] = row;
    }
  }

  /// out ← out + sign·AᵀB.
  void add_transposed_product(double sign, const Square& a, const Square& b, Square& out) const {
    for (int i = 0; i < n(); ++i) {
      Row row = out[i];
      for (int k = 0; k < n(); ++k) {
        const double factor = sign * a[k][i];
        for (int j = 0; j < n(); ++j) row[j] += factor * b[k][j];
      }
      out[i] = row;
    }
  }

  void add_traces(bool behind, TrajectorySlope& sum) {
    double squares = 0.0;
    for (int i = 0; i < n(); ++i) {
      sum.first += E_[i] * X_[i][i];
      for (int j = 0; j < n(); ++j) squares += (E_[i] * X_[i][j]) * (E_[j] * X_[i][j]);
    }
    sum.second -= squares;
    if (!behind) return;
    whiten_both(ddP_, Y_);
    for (int i = 0; i < n(); ++i) sum.second += E_[i] * Y_[i][i];
  }

  /// What step k takes off the next, and the derivatives of that.
  void look_ahead(int k, double omega) {
    const double* a = a_.omega_next(k).data();
    const double* b = b_.omega_next(k).data();
    const double rest = 1.0 - omega;
    for (int i = 0; i < n(); ++i) {
      for (int j = 0; j < n(); ++j) {
        const double from_a = a[j * n() + i], from_b = b[j * n() + i];
        W_[i][j] = omega * from_a + rest * from_b;
        V_[i][j] = from_a - from_b;
      }
    }
    whiten(W_);
    whiten(V_);
    weigh(W_, EW_);
    less_P_ = {};
    add_transposed_product(1.0, W_, EW_, less_P_);
    Square half = V_, Z = {};  // V − ½XEW, and XEW
    add_product(1.0, X_, EW_, Z);
    for (int i = 0; i < n(); ++i) {
      for (int j = 0; j < n(); ++j) half[i][j] -= 0.5 * Z[i][j];
      for (int j = 0; j < n(); ++j) Z[i][j] = V_[i][j] - Z[i][j];
    }
    Square one_side = {};
    add_transposed_product(1.0, half, EW_, one_side);
    for (int i = 0; i < n(); ++i) {
      for (int j = 0; j < n(); ++j) less_dP_[i][j] = one_side[i][j] + one_side[j][i];
    }
    Square EZ;
    weigh(Z, EZ);
    ddP_ = {};
    add_transposed_product(-2.0, Z, EZ, ddP_);
    if (k == 0) return;
    Square YEW = {};
    add_product(1.0, Y_, EW_, YEW);
    add_transposed_product(1.0, EW_, YEW, ddP_);
  }

  const Trajectory& a_;
  const Trajectory& b_;
  int dimension_;
  Row diagonal_{}, E_{};
  Square P_{}, dP_{}, X_{}, Y_{}, W_{}, V_{}, EW_{};
  Square less_P_{}, less_dP_{}, ddP_{};  // what the steps before take off, and leave
};

}  // namespace hearsay::gaussian
