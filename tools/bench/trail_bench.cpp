// Looking for the crumb to follow: TrailStore::best() along a way of 2.5 cm a look, as a robot at
// 0.25 m/s that looks ten times a second. alive: about ten crumbs within the sense radius, the same
// ones whether 1e3, 1e4 or 1e5 are alive; beside it all that are alive, looked at one by one.
// reach: 1e4 alive, about 10, 100 or 1000 of them in reach; beside it a bare loop over as many.
// merge: a crumb that is news in a full store of 1024, so that the oldest goes; beside it a bare
// copy.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "filters/trails/store.hpp"
#include "sim/kernel/random.hpp"
#include "tools/bench/count_allocations.hpp"

namespace {

using namespace hearsay;
using namespace hearsay::trails;

constexpr double radius_m = 1.0, pi = 3.14159265358979323846;
constexpr EventId goal = 0, other = 1;

/// Of a square of `whole` crumbs, half of them of the goal.
double half_side_m(std::size_t whole, double density_per_m2) {
  return 0.5 * std::sqrt(static_cast<double>(whole) / (2.0 * density_per_m2));
}

/// Crumbs of two events, half of each, `density_per_m2` of the goal's, around the origin: those of
/// more crumbs are those of fewer and others around them. In the order in which they are heard.
std::vector<Crumb> crumbs_of(std::size_t count, double density_per_m2) {
  Stream stream(1, Purpose("crumbs"), Entity{0});
  std::vector<Crumb> crumbs;
  double inner_m = 0.0;
  for (std::size_t whole = 1000; crumbs.size() < count; whole *= 10) {
    const double half_m = half_side_m(whole, density_per_m2);
    while (crumbs.size() < whole) {
      const double x = stream.uniform(-half_m, half_m), y = stream.uniform(-half_m, half_m);
      if (std::fabs(x) < inner_m && std::fabs(y) < inner_m) continue;
      const auto number = static_cast<std::uint32_t>(crumbs.size());
      crumbs.push_back({.event = number % 2 == 0 ? goal : other,
                        .position = point(x, y),
                        .distance_s = static_cast<float>(stream.uniform(0.0, 200.0)),
                        .created_s = stream.uniform(0.0, 200.0),
                        .identity = {number % 100, 0, number / 100}});
    }
    inner_m = half_m;
  }
  for (std::size_t i = crumbs.size() - 1; i > 0; --i) {
    std::swap(crumbs[i], crumbs[stream.below(i + 1)]);
  }
  return crumbs;
}

/// To and fro within the middle of the innermost crumbs.
std::vector<Point> way(double density_per_m2) {
  const double half_m = std::max(half_side_m(1000, density_per_m2) - 2.0 * radius_m, 0.5);
  std::vector<Point> points;
  const double step_m = 0.025, row_m = 0.5;
  for (double y = -half_m; y <= half_m; y += row_m) {
    const double sign = static_cast<int>((y + half_m) / row_m + 0.5) % 2 == 0 ? 1.0 : -1.0;
    for (double x = -half_m; x <= half_m; x += step_m) points.push_back(point(sign * x, y));
  }
  return points;
}

bool near(const Crumb& crumb, const Point& at) {
  const double dx = double{crumb.position.x_m} - at.x_m, dy = double{crumb.position.y_m} - at.y_m;
  return crumb.event == goal && dx * dx + dy * dy < radius_m * radius_m;
}

double mean_in_reach(const std::vector<Crumb>& crumbs, const std::vector<Point>& places) {
  std::size_t sum = 0, looks = 0;
  for (std::size_t i = 0; i < places.size(); i += 101, ++looks) {
    for (const Crumb& crumb : crumbs) sum += near(crumb, places[i]);
  }
  return static_cast<double>(sum) / static_cast<double>(looks);
}

const Crumb* best_of(const std::vector<Crumb>& crumbs, const Point& at) {
  const Crumb* found = nullptr;
  for (const Crumb& crumb : crumbs) {
    if (!near(crumb, at)) continue;
    if (found == nullptr || follows_before(crumb, *found)) found = &crumb;
  }
  return found;
}

TrailStore<MetricSpace> store_of(const std::vector<Crumb>& crumbs) {
  TrailStore<MetricSpace> store({.robot = 1000, .crumbs_max = crumbs.size(), .age_max_s = 1e6});
  for (const Crumb& crumb : crumbs) store.merge(crumb, 200.0, crumb.identity.robot);
  return store;
}

struct Density {
  std::size_t alive;
  double per_m2;
};
Density alive_of(const benchmark::State& state) {
  return {static_cast<std::size_t>(state.range(0)), 10.0 / (pi * radius_m * radius_m)};
}
Density reach_of(const benchmark::State& state) {
  return {10000, static_cast<double>(state.range(0)) / (pi * radius_m * radius_m)};
}

void our_look(benchmark::State& state, const Density& density) {
  const std::vector<Crumb> crumbs = crumbs_of(density.alive, density.per_m2);
  const std::vector<Point> places = way(density.per_m2);
  TrailStore<MetricSpace> store = store_of(crumbs);
  for (std::size_t i = 0; i < places.size(); i += 101) {
    const Crumb* const ours = store.best(goal, {places[i], radius_m}, 200.0);
    const Crumb* const right = best_of(crumbs, places[i]);
    if ((ours == nullptr) != (right == nullptr) ||
        (ours != nullptr && ours->identity != right->identity)) {
      state.SkipWithError("not the crumb that follows first");
      return;
    }
  }
  std::size_t i = 0;
  const std::size_t before = hearsay::bench::allocations;
  for (auto _ : state) {
    benchmark::DoNotOptimize(store.best(goal, {places[i], radius_m}, 200.0));
    if (++i == places.size()) i = 0;
  }
  if (hearsay::bench::allocations != before) state.SkipWithError("a look allocates");
  state.SetItemsProcessed(state.iterations());
  state.counters["in_reach"] = mean_in_reach(crumbs, places);
}

void floor_look(benchmark::State& state, const std::vector<Crumb>& crumbs,
                const std::vector<Point>& places) {
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(best_of(crumbs, places[i]));
    if (++i == places.size()) i = 0;
  }
  state.SetItemsProcessed(state.iterations());
}

void our_alive(benchmark::State& state) { our_look(state, alive_of(state)); }
void our_reach(benchmark::State& state) { our_look(state, reach_of(state)); }
void floor_alive(benchmark::State& state) {
  const Density density = alive_of(state);
  floor_look(state, crumbs_of(density.alive, density.per_m2), way(density.per_m2));
}
void floor_reach(benchmark::State& state) {
  std::vector<Crumb> crumbs = crumbs_of(2000, 1e6);
  std::erase_if(crumbs, [](const Crumb& crumb) { return crumb.event != goal; });
  crumbs.resize(static_cast<std::size_t>(state.range(0)));
  floor_look(state, crumbs, {point(0.0, 0.0)});
}

/// The i-th crumb of robots that lay one after the other.
Crumb fresh(std::uint32_t i, const std::vector<Point>& places) {
  return {.event = i % 2 == 0 ? goal : other,
          .position = places[i % places.size()],
          .distance_s = static_cast<float>(i % 200),
          .created_s = 0.01 * i,
          .identity = {i % 100, 0, i / 100}};
}
void our_merge(benchmark::State& state) {
  const std::vector<Point> places = way(alive_of(state).per_m2);
  const auto room = static_cast<std::size_t>(state.range(0));
  TrailStore<MetricSpace> store({.robot = 1000, .crumbs_max = room});
  std::uint32_t i = 0;
  const auto merge = [&] {
    const Crumb crumb = fresh(i++, places);
    store.merge(crumb, crumb.created_s, crumb.identity.robot);
  };
  while (i < 4 * room) merge();
  const std::size_t before = hearsay::bench::allocations;
  for (auto _ : state) merge();
  if (hearsay::bench::allocations != before) state.SkipWithError("a merge allocates");
  state.SetItemsProcessed(state.iterations());
}
void floor_merge(benchmark::State& state) {
  const std::vector<Point> places = way(alive_of(state).per_m2);
  std::vector<Crumb> ring(static_cast<std::size_t>(state.range(0)));
  std::uint32_t i = 0;
  for (auto _ : state) {
    ring[i % ring.size()] = fresh(i, places);
    ++i;
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations());
}

BENCHMARK(floor_alive)->Name("floor/alive")->Arg(1000)->Arg(10000)->Arg(100000);
BENCHMARK(our_alive)->Name("ours/alive")->Arg(1000)->Arg(10000)->Arg(100000);
BENCHMARK(floor_reach)->Name("floor/reach")->Arg(10)->Arg(100)->Arg(1000);
BENCHMARK(our_reach)->Name("ours/reach")->Arg(10)->Arg(100)->Arg(1000);
BENCHMARK(floor_merge)->Name("floor/merge")->Arg(1024);
BENCHMARK(our_merge)->Name("ours/merge")->Arg(1024);

}  // namespace
