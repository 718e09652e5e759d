// Small symmetric matrices whose entries may be of any size (1e-300 … 1e300): the numerics behind
// beliefs, fusion and the ledger. Internal to filters/.
//
// Everything is computed on the equilibrated matrix DΩD, D = diag(2^eᵢ), whose diagonal lies in
// [½, 2). Powers of two make the scaling exact; nothing overflows; and what counts as singular does
// not depend on the units of the state. Factorisation and solves are written out: at n = 2 they
// take a fraction of the time of the general ones, and their order of operations is in sight.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "filters/gaussian/belief.hpp"

namespace hearsay::gaussian {

/// A symmetric matrix, equilibrated and judged.
struct Scaled {
  Matrix matrix;  ///< matrix(i, j) = factor(i)·Ω(i, j)·factor(j)
  Vector factor;  ///< powers of two: D is its diagonal matrix
  Definiteness definiteness = Definiteness::singular;
  int rank = 0;     ///< eigenvalues of `matrix` beyond n·1e-13 of the largest; 0 for an overflow
  Matrix cholesky;  ///< lower factor of `matrix` if positive definite; else empty

  bool invertible() const { return rank > 0 && rank == matrix.rows(); }
};

/// Equilibrates `omega` (n×n, symmetric, n ≤ dimension_max). Where a diagonal entry is negative, or
/// zero in a row that is not, or an off-diagonal one is larger than a semi-definite matrix can
/// have, one common factor is used instead.
Scaled scale(const Matrix& omega);

/// x ← L⁻¹x and x ← L⁻ᵀx, L n×n lower triangular, x n×m.
void solve_lower(const Matrix& l, Matrix& x);
void solve_lower_transposed(const Matrix& l, Matrix& x);

/// matrix⁻¹·rhs (n×m) for an invertible one: by Cholesky, or by eigenvectors where indefinite.
Matrix solve(const Scaled& scaled, const Matrix& rhs);

/// Eigen's allFinite() subtracts each entry from itself and looks at the sum; this looks at each.
template <typename Plain>
bool all_finite(const Plain& m) {
  return std::all_of(m.data(), m.data() + m.size(), [](double x) { return std::isfinite(x); });
}

/// G (n×n) with GGᵀ = Ω, for a singular Ω, too; nothing if Ω is indefinite or not finite.
std::optional<Matrix> square_root(const Matrix& omega);

/// Row i of `m` times factor(i).
void scale_rows(Matrix& m, const Vector& factor);

/// All entries times 2^exponent.
Matrix times_power_of_two(const Matrix& m, int exponent);

/// The least e with |entries| < 2^e; 0 for a zero matrix.
int exponent_of(const Matrix& matrix);

/// WᵀW, symmetric to the last bit.
Matrix gram(const Matrix& w);

/// Eigenvalues in ascending order and, on request, the eigenvectors in columns.
/// Cyclic Jacobi: one rotation for n = 2, no workspace, and no eigenvalue is polluted by the
/// larger ones on an equilibrated matrix (Demmel & Veselić 1992). All entries must be finite and
/// of moderate size.
struct Eigenpairs {
  Vector values;
  Matrix vectors;
};
Eigenpairs eigenpairs(const Matrix& symmetric);
Vector eigenvalues(const Matrix& symmetric);

}  // namespace hearsay::gaussian
