#include "agents/behaviours/exploration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

/// Relative difference of moves of equal worth.
constexpr double equal_within = 1e-12;

}  // namespace

/// A way to go on, step by step.
struct Exploration::Way {
  State first;                ///< after one step
  double dx_m = 0, dy_m = 0;  ///< of each step
  double length_cells = 0;    ///< of a step; 0 is staying
  double turn_rad = 0;        ///< before the first, ≥ 0
};

struct Exploration::Ways {
  std::array<Way, headings_max> list;
  std::size_t count = 0;
  void add(const Way& way) { list[count++] = way; }
};

Exploration::Exploration(const Options& options, const grid::Area& area)
    : options_(options), area_(area) {
  static_assert(headings_max >= 9, "the moves of a holonomic vehicle");
  require(options.turn_max_rad > 0.0 && options.turn_max_rad < math::pi,
          "exploration: the largest turn is above 0 and below pi");
  require(options.headings >= 3 && options.headings <= headings_max && options.headings % 2 == 1,
          "exploration: an odd number of headings, 3 to 63");
  require(options.horizon >= 1 && options.horizon <= grid::Area::side_max,
          "exploration: a horizon of 1 to 4096 cells");
  const grid::MoveWeights& w = options.weights;
  require(w.gain >= 0.0 && w.cost >= 0.0 && std::isfinite(w.gain) && std::isfinite(w.cost),
          "exploration: weights are finite and not negative");
}

Exploration::State Exploration::next(const State& here, const Gain& gain, Stream& draws) const {
  require(std::isfinite(here.place_m.x_m) && std::isfinite(here.place_m.y_m) &&
              std::isfinite(here.heading_rad),
          "exploration: a vehicle is somewhere and heads somewhere");
  const bool holonomic = options_.vehicle == Vehicle::holonomic;
  Ways ways = holonomic ? around(here) : ahead(here);
  if (!holonomic && ways.count == 0) return towards_centre(here);
  const State stay = {here.place_m, math::wrap_angle(here.heading_rad)};
  if (options_.choice == Choice::random_walk) {
    return ways.count == 0 ? stay : ways.list[draws.below(ways.count)].first;
  }
  if (holonomic) ways.add({.first = stay});
  return best(ways, gain, draws);
}

Exploration::Ways Exploration::around(const State& here) const {
  const std::optional<int> at = area_.at(here.place_m);
  require(at.has_value(), "exploration: a holonomic vehicle stays in its area");
  const grid::Cell middle = area_.cell(*at);
  Ways ways;
  for (const int number : area_.neighbours(*at)) {
    const grid::Cell cell = area_.cell(number);
    const double columns = cell.column - middle.column, rows = cell.row - middle.row;
    const double heading = math::atan2(rows, columns);
    ways.add({.first = {area_.centre(number), heading},
              .dx_m = columns * area_.cell_m(),
              .dy_m = rows * area_.cell_m(),
              .length_cells = std::sqrt(columns * columns + rows * rows),
              .turn_rad = std::fabs(math::wrap_angle(heading - here.heading_rad))});
  }
  return ways;
}

Exploration::Ways Exploration::ahead(const State& here) const {
  Ways ways;
  const int last = options_.headings - 1;
  for (int i = 0; i <= last; ++i) {
    // So that turns to both sides are equal in all bits, and the middle one is 0.
    const double turn = options_.turn_max_rad * (2 * i - last) / last;
    const Way way = turned(here, turn);
    if (area_.at(way.first.place_m)) ways.add(way);
  }
  return ways;
}

Exploration::Way Exploration::turned(const State& here, double turn_rad) const {
  const double heading = math::wrap_angle(here.heading_rad + turn_rad);
  const double dx = area_.cell_m() * math::cos(heading), dy = area_.cell_m() * math::sin(heading);
  return {.first = {{here.place_m.x_m + dx, here.place_m.y_m + dy}, heading},
          .dx_m = dx,
          .dy_m = dy,
          .length_cells = 1.0,
          .turn_rad = std::fabs(turn_rad)};
}

Exploration::State Exploration::towards_centre(const State& here) const {
  const double x = area_.origin().x_m + area_.columns() * area_.cell_m() / 2;
  const double y = area_.origin().y_m + area_.rows() * area_.cell_m() / 2;
  const double bearing = math::atan2(y - here.place_m.y_m, x - here.place_m.x_m);
  const double turn = math::wrap_angle(bearing - here.heading_rad);
  return turned(here, std::clamp(turn, -options_.turn_max_rad, options_.turn_max_rad)).first;
}

grid::Move Exploration::judged(const Way& way, const Gain& gain) const {
  double sum = gain(way.first);
  for (int step = 1; step < options_.horizon && way.length_cells > 0.0; ++step) {
    State then = way.first;
    then.place_m.x_m += step * way.dx_m;
    then.place_m.y_m += step * way.dy_m;
    const std::optional<int> at = area_.at(then.place_m);
    if (!at) break;
    if (options_.vehicle == Vehicle::holonomic) then.place_m = area_.centre(*at);
    sum += gain(then);
  }
  return {sum, way.length_cells + way.turn_rad / math::pi};
}

Exploration::State Exploration::best(const Ways& ways, const Gain& gain, Stream& draws) const {
  std::array<double, headings_max> worth{};
  double best = -std::numeric_limits<double>::infinity(), largest = 0.0;
  for (std::size_t i = 0; i < ways.count; ++i) {
    const grid::Move move = judged(ways.list[i], gain);
    const double gained = options_.weights.gain * move.gain;
    const double paid = options_.weights.cost * move.cost;
    worth[i] = gained - paid;
    require(std::isfinite(worth[i]), "exploration: gains are finite");
    best = std::max(best, worth[i]);
    largest = std::max({largest, std::fabs(gained), paid});
  }
  std::array<std::size_t, headings_max> equal{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < ways.count; ++i) {
    if (best - worth[i] <= equal_within * largest) equal[count++] = i;
  }
  return ways.list[equal[count == 1 ? 0 : draws.below(count)]].first;
}

}  // namespace hearsay
