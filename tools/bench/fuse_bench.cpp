// Covariance intersection of two beliefs about a 4-D or 6-D state, minimum determinant: find ω,
// then Ω = ωΩ_a + (1−ω)Ω_b and ξ likewise. An item is one fusion, of 256 random pairs in turn.
//
// floor/fuse: as a user of Eigen would write it, with matrices of dynamic size on the heap:
// Cholesky of Ω_a, eigenvalues of L⁻¹Ω_bL⁻ᵀ, Newton for ω. ours/fuse: coefficients() of the rule
// ci-det and the Belief arithmetic that agents use. Both must agree, and ours must not allocate.

#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>
#include <vector>

#include "filters/gaussian/fusion.hpp"
#include "sim/kernel/random.hpp"
#include "tools/bench/count_allocations.hpp"

namespace {

using hearsay::gaussian::Belief;
using hearsay::gaussian::Coefficients;
using hearsay::gaussian::Rule;

constexpr int pairs = 256;  // a power of two; both sides' pairs stay in the caches

struct HeapBelief {
  Eigen::MatrixXd omega;
  Eigen::VectorXd xi;
};

/// Eigenvalues over about two decades, in random directions.
HeapBelief random_belief(hearsay::Stream& random, int n) {
  const auto normal = [&random] { return random.normal(); };
  const Eigen::MatrixXd g = Eigen::MatrixXd::NullaryExpr(n, n, normal);
  const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(g).householderQ();
  Eigen::VectorXd d(n);
  for (double& value : d) value = std::pow(10.0, random.uniform(-1.0, 1.0));
  const Eigen::MatrixXd m = q * d.asDiagonal() * q.transpose();
  return {0.5 * (m + m.transpose()), Eigen::VectorXd::NullaryExpr(n, normal)};
}

std::vector<HeapBelief> random_beliefs(std::uint64_t side, std::int64_t n) {
  hearsay::Stream random(side, hearsay::Purpose("fuse"), hearsay::Entity::agent(0));
  std::vector<HeapBelief> beliefs;
  for (int i = 0; i < pairs; ++i) {
    beliefs.push_back(random_belief(random, static_cast<int>(n)));
  }
  return beliefs;
}

/// ω of the least determinant: the zero of Σ (1 − λ)/(ω + (1 − ω)λ), which decreases.
double omega_of(const Eigen::VectorXd& lambda) {
  const auto slope = [&](double omega) {
    return ((1.0 - lambda.array()) / (omega + (1.0 - omega) * lambda.array())).sum();
  };
  if (slope(0.0) <= 0.0) return 0.0;
  if (slope(1.0) >= 0.0) return 1.0;
  double low = 0.0;
  double high = 1.0;
  double omega = 0.5;
  for (int iteration = 0; iteration < 100; ++iteration) {
    double value = 0.0;
    double derivative = 0.0;
    for (const double l : lambda) {
      const double u = (1.0 - l) / (omega + (1.0 - omega) * l);
      value += u;
      derivative -= u * u;
    }
    (value > 0.0 ? low : high) = omega;
    double next = omega - value / derivative;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double step = std::fabs(next - omega);
    omega = next;
    if (step < 1e-12) break;
  }
  return omega;
}

struct HeapFusion {
  double omega;
  HeapBelief belief;
};

HeapFusion fuse(const HeapBelief& a, const HeapBelief& b) {
  const Eigen::LLT<Eigen::MatrixXd> llt(a.omega);
  if (llt.info() != Eigen::Success) return {1.0, a};
  const Eigen::MatrixXd half = llt.matrixL().solve(b.omega);
  const Eigen::MatrixXd c = llt.matrixL().solve(half.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(c, Eigen::EigenvaluesOnly);
  const double omega = omega_of(solver.eigenvalues());
  return {omega, {omega * a.omega + (1.0 - omega) * b.omega, omega * a.xi + (1.0 - omega) * b.xi}};
}

struct Fusion {
  double omega;
  Belief belief;
};

Fusion fuse(const Belief& own, const Belief& received) {
  const Coefficients k = hearsay::gaussian::coefficients(Rule::ci_det, own, received);
  Fusion fusion{k.own, own};
  fusion.belief *= k.own;
  Belief heard = received;
  heard *= k.received;
  fusion.belief += heard;
  return fusion;
}

std::vector<Belief> inline_beliefs(const std::vector<HeapBelief>& beliefs) {
  std::vector<Belief> out;
  for (const HeapBelief& belief : beliefs) out.push_back({belief.omega, belief.xi});
  return out;
}

void floor_fuse(benchmark::State& state) {
  const std::vector<HeapBelief> a = random_beliefs(1, state.range(0));
  const std::vector<HeapBelief> b = random_beliefs(2, state.range(0));
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(fuse(a[i], b[i]));
    i = (i + 1) % pairs;
  }
  state.SetItemsProcessed(state.iterations());
}

/// nullptr if each of our fusions equals the floor's and none allocated.
const char* what_is_wrong(const std::vector<HeapBelief>& a, const std::vector<HeapBelief>& b,
                          const std::vector<Belief>& own, const std::vector<Belief>& received) {
  for (std::size_t i = 0; i < pairs; ++i) {
    const std::size_t before = hearsay::bench::allocations;
    const Fusion ours = fuse(own[i], received[i]);
    if (hearsay::bench::allocations != before) return "ours allocates";
    const HeapFusion floor = fuse(a[i], b[i]);
    if (hearsay::bench::allocations == before) return "allocations are not counted";
    if (!(std::fabs(ours.omega - floor.omega) <= 1e-9)) return "ω differs from the floor's";
    const auto close = [](const auto& x, const auto& y) {
      return (x - y).norm() <= 1e-9 * y.norm();
    };
    if (!close(ours.belief.omega, floor.belief.omega)) return "Ω differs from the floor's";
    if (!close(ours.belief.xi, floor.belief.xi)) return "ξ differs from the floor's";
  }
  return nullptr;
}

void our_fuse(benchmark::State& state) {
  const std::vector<HeapBelief> a = random_beliefs(1, state.range(0));
  const std::vector<HeapBelief> b = random_beliefs(2, state.range(0));
  const std::vector<Belief> own = inline_beliefs(a);
  const std::vector<Belief> received = inline_beliefs(b);
  if (const char* wrong = what_is_wrong(a, b, own, received)) {
    state.SkipWithError(wrong);
    return;
  }
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(fuse(own[i], received[i]));
    i = (i + 1) % pairs;
  }
  state.SetItemsProcessed(state.iterations());
}

BENCHMARK(floor_fuse)->Name("floor/fuse")->Arg(4)->Arg(6);
BENCHMARK(our_fuse)->Name("ours/fuse")->Arg(4)->Arg(6);

}  // namespace
