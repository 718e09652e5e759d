// Trajectories of T steps in 6-D (three axes, white-noise acceleration, measured at every step):
// add one to another, add them weighted by a fixed ω, solve for all means, and weigh two by
// covariance intersection of minimum determinant, then fuse them. An item is one trajectory. Ours
// must not allocate once it is warm.
//
// floor: as a user of Eigen would write it, with 6×6 matrices of fixed size in std::vector: blocks
// added one by one; block Cholesky factorisation forwards, means backwards. Intersection is
// compared with the floor of means, for it factors several times. Means must agree.
//
// What is seen repeats every 20 steps. How often an intersection factors depends on the balance of
// the two trajectories alone (thrice for the ω of 0.8 here, twice where ω is nearly ½), and so
// that is much the same at every length.

#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "filters/gaussian/trajectory_factor.hpp"
#include "sim/kernel/random.hpp"
#include "tools/bench/count_allocations.hpp"

namespace {

using hearsay::gaussian::Belief;
using hearsay::gaussian::Matrix;
using hearsay::gaussian::Trajectory;
using hearsay::gaussian::TrajectoryFactor;

constexpr int n = 6;
using Block = Eigen::Matrix<double, n, n>;
using Part = Eigen::Matrix<double, n, 1>;

struct PlainStep {
  Block omega, next;
  Part xi;
};
using Plain = std::vector<PlainStep>;

constexpr int period = 20;

Trajectory made(int steps, int agent) {
  hearsay::Stream random(1, hearsay::Purpose("trajectory"), hearsay::Entity::agent(agent));
  std::vector<Belief> seen(period, Belief::unknown(n));
  for (Belief& belief : seen) {
    for (int i = 0; i < 3; ++i) {
      belief.omega(i, i) = 0.1 + random.uniform();
      belief.xi(i) = random.normal();
    }
  }
  const auto move = hearsay::gaussian::white_noise_acceleration(3, 1.0, 0.1);
  Trajectory trajectory(n, 0);
  for (int k = 0; k < steps; ++k) {
    if (k > 0) trajectory.augment(k, move);
    trajectory.update(k, seen[static_cast<std::size_t>(k % period)]);
  }
  return trajectory;
}

Plain plain(const Trajectory& trajectory) {
  Plain steps;
  for (int k = 0; k < trajectory.steps(); ++k) {
    PlainStep step{trajectory.omega(k), Block::Zero(), trajectory.xi(k)};
    if (k + 1 < trajectory.steps()) step.next = trajectory.omega_next(k);
    steps.push_back(step);
  }
  return steps;
}

class PlainMeans {
 public:
  const std::vector<Part>& of(const Plain& steps) {
    const std::size_t count = steps.size();
    factors_.resize(count);
    links_.resize(count);
    means_.resize(count);
    Block left = steps[0].omega;
    Part rest = steps[0].xi;
    for (std::size_t k = 0; k < count; ++k) {
      factors_[k].compute(left);
      means_[k] = factors_[k].matrixL().solve(rest);
      if (k + 1 == count) break;
      links_[k] = factors_[k].matrixL().solve(steps[k].next);
      left = steps[k + 1].omega - links_[k].transpose() * links_[k];
      rest = steps[k + 1].xi - links_[k].transpose() * means_[k];
    }
    for (std::size_t k = count; k-- > 0;) {
      if (k + 1 < count) means_[k] -= links_[k] * means_[k + 1];
      means_[k] = factors_[k].matrixU().solve(means_[k]);
    }
    return means_;
  }

 private:
  std::vector<Eigen::LLT<Block>> factors_;
  std::vector<Block> links_;
  std::vector<Part> means_;
};

int steps_of(const benchmark::State& state) { return static_cast<int>(state.range(0)); }

void floor_add(benchmark::State& state) {
  Plain own = plain(made(steps_of(state), 0));
  const Plain other = plain(made(steps_of(state), 1));
  for (auto _ : state) {
    for (std::size_t k = 0; k < own.size(); ++k) {
      own[k].omega += other[k].omega;
      own[k].next += other[k].next;
      own[k].xi += other[k].xi;
    }
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations());
}

/// Does `work` once to warm up, then counts and times it.
template <typename Work>
void measure(benchmark::State& state, const Work& work) {
  work();
  const std::size_t before = hearsay::bench::allocations;
  work();
  const std::size_t asked = hearsay::bench::allocations - before;
  if (before == 0) {  // the trajectories themselves are on the heap
    state.SkipWithError("allocations are not counted");
    return;
  }
  if (asked != 0) {
    state.SkipWithError("ours allocates");
    return;
  }
  for (auto _ : state) work();
  state.SetItemsProcessed(state.iterations());
  state.counters["allocations"] = static_cast<double>(asked);
}

void our_add(benchmark::State& state) {
  Trajectory own = made(steps_of(state), 0);
  const Trajectory other = made(steps_of(state), 1);
  measure(state, [&] {
    own += other;
    benchmark::ClobberMemory();
  });
}

constexpr double fixed_omega = 0.4;

void floor_weigh(benchmark::State& state) {
  Plain own = plain(made(steps_of(state), 0));
  const Plain other = plain(made(steps_of(state), 1));
  const auto weigh = [](auto& x, const auto& y) { x = fixed_omega * x + (1.0 - fixed_omega) * y; };
  for (auto _ : state) {
    for (std::size_t k = 0; k < own.size(); ++k) {
      weigh(own[k].omega, other[k].omega);
      weigh(own[k].next, other[k].next);
      weigh(own[k].xi, other[k].xi);
    }
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations());
}

void our_weigh(benchmark::State& state) {
  Trajectory own = made(steps_of(state), 0);
  const Trajectory other = made(steps_of(state), 1);
  measure(state, [&] {
    own.intersect(fixed_omega, other);
    benchmark::ClobberMemory();
  });
}

void floor_means(benchmark::State& state) {
  const Plain steps = plain(made(steps_of(state), 0));
  PlainMeans solver;
  for (auto _ : state) benchmark::DoNotOptimize(solver.of(steps).data());
  state.SetItemsProcessed(state.iterations());
}

void our_means(benchmark::State& state) {
  const Trajectory trajectory = made(steps_of(state), 0);
  TrajectoryFactor factor;
  factor.factor(trajectory);
  PlainMeans solver;
  const std::vector<Part>& expected = solver.of(plain(trajectory));
  for (std::size_t k = 0; k < expected.size(); ++k) {
    if ((factor.means()[k] - expected[k]).norm() > 1e-9 * (1.0 + expected[k].norm())) {
      state.SkipWithError("means differ from the floor's");
      return;
    }
  }
  measure(state, [&] {
    factor.factor(trajectory);
    benchmark::DoNotOptimize(factor.means().data());
  });
}

void our_intersection(benchmark::State& state) {
  const Trajectory own = made(steps_of(state), 0);
  const Trajectory other = made(steps_of(state), 1);
  Trajectory fused = own;
  measure(state, [&] {
    const auto omega = hearsay::gaussian::intersect_det(own, other);
    fused = own;
    fused.intersect(omega.value_or(0.5), other);
    benchmark::ClobberMemory();
  });
}

BENCHMARK(floor_add)->Name("floor/add")->Arg(20)->Arg(100)->Arg(1000);
BENCHMARK(our_add)->Name("ours/add")->Arg(20)->Arg(100)->Arg(1000);
BENCHMARK(floor_weigh)->Name("floor/weigh")->Arg(20)->Arg(100)->Arg(1000);
BENCHMARK(our_weigh)->Name("ours/weigh")->Arg(20)->Arg(100)->Arg(1000);
BENCHMARK(floor_means)->Name("floor/means")->Arg(20)->Arg(100)->Arg(1000);
BENCHMARK(our_means)->Name("ours/means")->Arg(20)->Arg(100)->Arg(1000);
BENCHMARK(our_intersection)->Name("ours/intersect")->Arg(20)->Arg(100)->Arg(1000);

}  // namespace
