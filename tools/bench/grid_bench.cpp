// Certainty grids. fuse_grid: one grid of N×N log-odds takes in another (rule naive; channel takes
// off a third), beside memcpy of one onto another; an item is a byte read or written: 12 a cell, 16
// for channel, 8 for memcpy. camera: an update by a nadir camera, from pose to log-odds, with N
// cells in view of a grid of 4096×4096; camera_grid: 1600 cells in view of a grid of N×N; an item
// is a cell in view. One pixel in a hundred is marked, so that no ellipse is spared. Their floor is
// 17 pin-hole projections a cell and nothing else.

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "filters/gaussian/geolocation.hpp"
#include "filters/grid/camera_look.hpp"
#include "filters/grid/fusion.hpp"
#include "sim/kernel/random.hpp"

namespace {

using namespace hearsay::grid;
using hearsay::Stream;

std::vector<float> evidence_of(std::uint64_t who, std::int64_t side) {
  Stream random(who, hearsay::Purpose("grid"), hearsay::Entity::agent(0));
  std::vector<float> evidence(static_cast<std::size_t>(side * side));
  for (float& e : evidence) e = static_cast<float>(random.normal());
  return evidence;
}

BernoulliGrid grid_of(std::int64_t side) {
  return BernoulliGrid(Area({.columns = static_cast<int>(side), .rows = static_cast<int>(side)}));
}

void floor_fuse_grid(benchmark::State& state) {
  const std::vector<float> received = evidence_of(2, state.range(0));
  std::vector<float> own = evidence_of(1, state.range(0));
  for (auto _ : state) {
    std::memcpy(own.data(), received.data(), own.size() * sizeof(float));
    benchmark::DoNotOptimize(own.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(own.size()) * 8);
}

void fuse_with(benchmark::State& state, Rule rule, std::int64_t bytes_a_cell) {
  BernoulliGrid own = grid_of(state.range(0));
  const std::vector<float> received = evidence_of(2, state.range(0));
  const std::vector<float> common = evidence_of(3, state.range(0));
  // What comes out of the first fusion, cell by cell.
  fuse(rule, own, {.received = received, .common = common});
  for (std::size_t i = 0; i < received.size(); ++i) {
    const float expected = rule == Rule::naive ? received[i] : received[i] - common[i];
    if (own.evidence()[i] != expected) return state.SkipWithError("ours fuses wrongly");
  }
  for (auto _ : state) {
    fuse(rule, own, {.received = received, .common = common});
    benchmark::DoNotOptimize(own.evidence_mutable().data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * state.range(0) * state.range(0) * bytes_a_cell);
}
void our_fuse_grid(benchmark::State& state) { fuse_with(state, Rule::naive, 12); }
void our_fuse_grid_channel(benchmark::State& state) { fuse_with(state, Rule::channel, 16); }

constexpr double height_m = 40.0;

GridCamera camera() {
  return {.lens = hearsay::gaussian::infrared_camera,
          .width = 240,
          .height = 320,
          .detector = *detector_by_name("infrared"),
          .range_max_m = 100.0};
}

/// A grid of side×side cells around the camera, about `in_view` of which it sees.
Area area_of(std::int64_t in_view, std::int64_t side) {
  const GridCamera c = camera();
  const double seen_m2 =
      c.width / c.lens.focal_u * height_m * (c.height / c.lens.focal_v) * height_m;
  const double cell_m = std::sqrt(seen_m2 / static_cast<double>(in_view));
  const double corner_m = -0.5 * static_cast<double>(side) * cell_m;
  return Area({.columns = static_cast<int>(side),
               .rows = static_cast<int>(side),
               .cell_m = cell_m,
               .x_m = corner_m,
               .y_m = corner_m});
}

SegmentedImage speckled() {
  Stream random(4, hearsay::Purpose("grid"), hearsay::Entity::agent(0));
  SegmentedImage image(240, 320);
  for (int i = 0; i < 768; ++i) {
    image.mark(static_cast<int>(random.below(240)), static_cast<int>(random.below(320)));
  }
  return image;
}

/// 17 cameras as 3×4 matrices P: s·(u, v, 1) = P·(x, y, 0, 1).
void floor_camera_of(benchmark::State& state, std::int64_t in_view, std::int64_t side) {
  const Area area = area_of(in_view, side);
  const auto around = static_cast<int>(std::sqrt(static_cast<double>(in_view)));
  const int first = (area.columns() - around) / 2;
  std::array<std::array<double, 12>, 17> cameras;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const double tilt = 1e-3 * static_cast<double>(k);
    cameras[k] = {347.881, tilt, 119.5, 1.0, tilt, 345.876, 161.8, 2.0, tilt, tilt, 1.0, 40.0};
  }
  double sum = 0.0;
  for (auto _ : state) {
    for (int row = first; row < first + around; ++row) {
      for (int column = first; column < first + around; ++column) {
        const Point at = area.centre(row * area.columns() + column);
        for (const auto& p : cameras) {
          const double s = 1.0 / (p[8] * at.x_m + p[9] * at.y_m + p[11]);
          sum += (p[0] * at.x_m + p[1] * at.y_m + p[3]) * s;
          sum += (p[4] * at.x_m + p[5] * at.y_m + p[7]) * s;
        }
      }
    }
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * around * around);
}

void our_camera_of(benchmark::State& state, std::int64_t in_view, std::int64_t side) {
  BernoulliGrid grid(area_of(in_view, side));
  CameraLook look(camera(), grid.area());
  const SegmentedImage image = speckled();
  const auto pose = hearsay::gaussian::looking({0.0, 0.0, height_m}, 0.0, 1.5707963);
  const hearsay::gaussian::Matrix covariance =
      hearsay::gaussian::look_covariance({0.3, 0.01, 0.0}).topLeftCorner(6, 6);
  std::vector<CellLook> looks;
  std::int64_t cells = 0;
  for (auto _ : state) {
    look.look(pose, covariance);
    look.judge(image, looks);
    add(looks, grid);
    benchmark::ClobberMemory();
    cells += static_cast<std::int64_t>(looks.size());
  }
  const double share = static_cast<double>(looks.size()) / static_cast<double>(in_view);
  if (!(share > 0.8 && share < 1.2)) return state.SkipWithError("not as many cells as meant");
  state.SetItemsProcessed(cells);
}

constexpr std::int64_t widest = Area::side_max;
constexpr std::int64_t usual_in_view = 1600;
void floor_camera(benchmark::State& state) { floor_camera_of(state, state.range(0), widest); }
void our_camera(benchmark::State& state) { our_camera_of(state, state.range(0), widest); }
void floor_camera_grid(benchmark::State& s) { floor_camera_of(s, usual_in_view, s.range(0)); }
void our_camera_grid(benchmark::State& s) { our_camera_of(s, usual_in_view, s.range(0)); }

BENCHMARK(floor_fuse_grid)->Name("floor/fuse_grid")->Arg(100)->Arg(1000);
BENCHMARK(our_fuse_grid)->Name("ours/fuse_grid")->Arg(100)->Arg(1000);
BENCHMARK(our_fuse_grid_channel)->Name("ours/fuse_grid_channel")->Arg(1000);
BENCHMARK(floor_camera)->Name("floor/camera")->Arg(400)->Arg(6400)->Arg(102400);
BENCHMARK(our_camera)->Name("ours/camera")->Arg(400)->Arg(6400)->Arg(102400);
BENCHMARK(floor_camera_grid)->Name("floor/camera_grid")->Arg(64)->Arg(4096);
BENCHMARK(our_camera_grid)->Name("ours/camera_grid")->Arg(64)->Arg(4096);

}  // namespace
