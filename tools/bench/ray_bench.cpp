// Rays among walls. scan: 180 rays over 180 degrees, of up to 10 m, from places all over a floor of
// 60 × 30 m with N×N rooms along corridors, beside a loop over all walls for each ray; an item is a
// scan. advance: moves of 2.5 cm by a disc of 0.3 m on the same floor, beside the distance of one
// point to all walls; an item is a move.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/kernel/random.hpp"
#include "sim/math/functions.hpp"
#include "sim/world/collision.hpp"
#include "sim/world/plan.hpp"
#include "sim/world/ray_caster.hpp"

namespace {

using namespace hearsay;
using namespace hearsay::plan;

constexpr double range_m = 10.0;
constexpr int rays = 180;

/// Rooms side by side, each with a door to the corridor below its row.
Drawing floor_of(int rooms) {
  Drawing d{.columns = 240, .rows = 120, .cell_m = 0.25, .walls = {}, .places = {}};
  const int width = d.columns / rooms, height = d.rows / rooms, corridor = height / 3;
  for (int row = 0; row < d.rows; ++row) {
    for (int column = 0; column < d.columns; ++column) {
      const int x = column % width, y = row % height;
      const bool edge = column == 0 || row == 0 || column == d.columns - 1 || row == d.rows - 1;
      const bool side = x == 0 && y >= corridor;
      const bool front = (y == corridor && (x < 2 || x > 5)) || y == 0;
      d.walls.push_back(edge || side || front);
    }
  }
  return d;
}

struct Start {
  Point at;
  double heading_rad;
};
std::vector<Start> starts(const Drawing& d) {
  Stream stream(1, Purpose("starts"), Entity{0});
  std::vector<Start> out;
  while (out.size() < 1024) {
    const Point p{stream.uniform(0.5, 59.5), stream.uniform(0.5, 29.5)};
    if (d.wall(static_cast<int>(p.x_m * 4.0), static_cast<int>(p.y_m * 4.0))) continue;
    out.push_back({p, stream.uniform(0.0, 6.28)});
  }
  return out;
}

void our_scan(benchmark::State& state) {
  const Drawing drawing = floor_of(static_cast<int>(state.range(0)));
  const WallIndex walls{Plan(drawing)};
  const auto from = starts(drawing);
  const Fan fan(rays, math::pi);
  std::vector<double> out(rays);
  std::size_t i = 0;
  for (auto _ : state) {
    const Start& s = from[i++ % from.size()];
    scan(walls, s.at, s.heading_rad, fan, range_m, {}, out);
    benchmark::DoNotOptimize(out.data());
  }
  state.SetItemsProcessed(state.iterations());
  state.counters["walls"] = static_cast<double>(walls.segments().size());
}

void floor_scan(benchmark::State& state) {
  const Drawing drawing = floor_of(static_cast<int>(state.range(0)));
  const Plan plan(drawing);
  const auto from = starts(drawing);
  const Fan fan(rays, math::pi);
  std::vector<double> out(rays);
  std::size_t i = 0;
  for (auto _ : state) {
    const Start& s = from[i++ % from.size()];
    for (std::size_t k = 0; k < out.size(); ++k) {
      const Point d = fan.directions()[k];
      double best = range_m;
      for (const Segment& w : plan.walls()) {
        const double wx = w.to.x_m - w.from.x_m, wy = w.to.y_m - w.from.y_m;
        const double ax = w.from.x_m - s.at.x_m, ay = w.from.y_m - s.at.y_m;
        const double det = d.x_m * wy - d.y_m * wx;
        const double t = (ax * wy - ay * wx) / det, u = (ax * d.y_m - ay * d.x_m) / det;
        if (t >= 0.0 && t < best && u >= 0.0 && u <= 1.0) best = t;
      }
      out[k] = best;
    }
    benchmark::DoNotOptimize(out.data());
  }
  state.SetItemsProcessed(state.iterations());
}

void floor_advance(benchmark::State& state) {
  const Drawing drawing = floor_of(static_cast<int>(state.range(0)));
  const Plan plan(drawing);
  const auto from = starts(drawing);
  std::size_t i = 0;
  for (auto _ : state) {
    const Point p = from[i++ % from.size()].at;
    double best = 1e30;
    for (const Segment& w : plan.walls()) {
      const double wx = w.to.x_m - w.from.x_m, wy = w.to.y_m - w.from.y_m;
      const double vx = p.x_m - w.from.x_m, vy = p.y_m - w.from.y_m;
      const double u = std::clamp((vx * wx + vy * wy) / (wx * wx + wy * wy), 0.0, 1.0);
      const double dx = vx - u * wx, dy = vy - u * wy;
      best = std::min(best, dx * dx + dy * dy);
    }
    benchmark::DoNotOptimize(best);
  }
  state.SetItemsProcessed(state.iterations());
}

void our_advance(benchmark::State& state) {
  const Drawing drawing = floor_of(static_cast<int>(state.range(0)));
  const WallIndex walls{Plan(drawing)};
  const auto from = starts(drawing);
  std::size_t i = 0;
  for (auto _ : state) {
    const Start& s = from[i++ % from.size()];
    const Point to{s.at.x_m + 0.02, s.at.y_m + 0.015};
    benchmark::DoNotOptimize(advance(walls, s.at, to, 0.3));
  }
  state.SetItemsProcessed(state.iterations());
}

BENCHMARK(floor_scan)->Name("floor/scan")->Arg(6)->Arg(12);
BENCHMARK(our_scan)->Name("ours/scan")->Arg(6)->Arg(12);
BENCHMARK(floor_advance)->Name("floor/advance")->Arg(6);
BENCHMARK(our_advance)->Name("ours/advance")->Arg(6);

}  // namespace
