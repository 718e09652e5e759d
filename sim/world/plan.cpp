#include "sim/world/plan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay::plan {
namespace {

std::string text_of(Point p) {
  return "(" + std::to_string(p.x_m) + ", " + std::to_string(p.y_m) + ") m";
}

void check_name(const std::vector<Place>& places, const std::string& name) {
  if (name.empty()) throw InputError("a place needs a name");
  if (std::any_of(places.begin(), places.end(), [&](const Place& p) { return p.name == name; })) {
    throw InputError("place " + name + " is there twice; a name stands for one place");
  }
}

/// Collects steps along one lattice line into the longest runs that have the free side on the same
/// hand, and hands out their ends.
template <typename OneSide, typename Out>
void runs(int length, OneSide&& free_side, Out&& out) {
  int side = 0, begin = 0;
  for (int i = 0; i <= length; ++i) {
    const int here = i == length ? 0 : free_side(i);
    if (here == side) continue;
    if (side != 0) out(begin, i, side);
    side = here;
    begin = i;
  }
}

std::vector<Segment> surface(const Drawing& d) {
  std::vector<Segment> walls;
  const auto put = [&](Point a, Point b) {
    if (walls.size() == walls_max) {
      throw InputError("the drawing has more than " + std::to_string(walls_max) +
                       " straight pieces of wall; rooms are expected, not noise");
    }
    walls.push_back({a, b});
  };
  for (int row = 0; row <= d.rows; ++row) {
    const double y = row * d.cell_m;
    runs(
        d.columns, [&](int i) { return int{d.wall(i, row - 1)} - int{d.wall(i, row)}; },
        [&](int begin, int end, int side) {
          const Point left{begin * d.cell_m, y}, right{end * d.cell_m, y};
          side > 0 ? put(left, right) : put(right, left);
        });
  }
  for (int column = 0; column <= d.columns; ++column) {
    const double x = column * d.cell_m;
    runs(
        d.rows, [&](int i) { return int{d.wall(column - 1, i)} - int{d.wall(column, i)}; },
        [&](int begin, int end, int side) {
          const Point low{x, begin * d.cell_m}, high{x, end * d.cell_m};
          side > 0 ? put(high, low) : put(low, high);
        });
  }
  return walls;
}

}  // namespace

void Drawing::add(const std::string& name, Point at) {
  check_name(places, name);
  const bool inside =
      at.x_m >= 0.0 && at.y_m >= 0.0 && at.x_m < columns * cell_m && at.y_m < rows * cell_m;
  if (!inside || wall(static_cast<int>(at.x_m / cell_m), static_cast<int>(at.y_m / cell_m))) {
    throw InputError("place " + name + " at " + text_of(at) +
                     (inside ? " is in a wall" : " is not in the drawing") +
                     "; a place is in a free cell");
  }
  places.push_back({name, at});
}

Plan::Plan(const Drawing& drawing)
    : width_m_(drawing.columns * drawing.cell_m),
      height_m_(drawing.rows * drawing.cell_m),
      thick_(true),
      walls_(surface(drawing)),
      places_(drawing.places) {}

Plan::Plan(double width_m, double height_m, std::vector<Segment> walls, std::vector<Place> places)
    : width_m_(width_m), height_m_(height_m), places_(std::move(places)) {
  for (const double side : {width_m, height_m}) {
    if (!(side > 0.0 && side <= extent_max_m)) {
      throw InputError("a side of the plan is " + std::to_string(side) +
                       " m; it must be above 0 and at most 100000 m");
    }
  }
  if (walls.size() > walls_max - 4) {
    throw InputError(std::to_string(walls.size()) + " walls; at most " +
                     std::to_string(walls_max - 4) + " are allowed");
  }
  const Point a{0.0, 0.0}, b{width_m, 0.0}, c{width_m, height_m}, d{0.0, height_m};
  walls_ = {{a, b}, {b, c}, {c, d}, {d, a}};
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const Segment& wall = walls[i];
    if (!contains(wall.from) || !contains(wall.to) || wall.from == wall.to) {
      throw InputError("wall " + std::to_string(i) + " from " + text_of(wall.from) + " to " +
                       text_of(wall.to) + " must lie within the plan, its ends apart");
    }
    walls_.push_back(wall);
  }
  std::vector<Place> seen;
  for (const Place& place : places_) {
    check_name(seen, place.name);
    if (!contains(place.at)) {
      throw InputError("place " + place.name + " at " + text_of(place.at) +
                       " must lie within the plan");
    }
    seen.push_back(place);
  }
}

bool Plan::free(Point p) const {
  if (!contains(p)) return false;
  if (!thick_) return true;
  // Surfaces are closed, and what is beyond the plan is wall: who crosses an odd number of them on
  // the way out, to the right, was in the free.
  bool odd = false;
  for (const Segment& wall : walls_) {
    if (wall.from.x_m != wall.to.x_m || wall.from.x_m <= p.x_m) continue;
    const double low_m = std::min(wall.from.y_m, wall.to.y_m);
    const double high_m = std::max(wall.from.y_m, wall.to.y_m);
    if (p.y_m >= low_m && p.y_m < high_m) odd = !odd;
  }
  return odd;
}

Point Plan::place(std::string_view name) const {
  for (const Place& place : places_) {
    if (place.name == name) return place.at;
  }
  std::string known;
  for (const Place& place : places_) known += (known.empty() ? "" : ", ") + place.name;
  throw InputError("the plan has no place " + std::string(name) + "; it has " +
                   (known.empty() ? "none" : known));
}

}  // namespace hearsay::plan
