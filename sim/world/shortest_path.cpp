#include "sim/world/shortest_path.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"
#include "sim/world/collision.hpp"

namespace hearsay::plan {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();
constexpr double diagonal = 1.41421356237309504880;

double distance(Point a, Point b) { return math::hypot(b.x_m - a.x_m, b.y_m - a.y_m); }

double length(const std::vector<Point>& points) {
  double sum = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += distance(points[i - 1], points[i]);
  return sum;
}

/// One search. Ends and grid points are joined where the disc can go straight.
class Search {
 public:
  Search(const WallIndex& walls, Point from, Point to, double radius_m, double spacing_m)
      : walls_(walls), from_(from), to_(to), radius_m_(radius_m), spacing_m_(spacing_m) {
    const double columns = std::floor(walls.width_m() / spacing_m) + 1.0;
    const double rows = std::floor(walls.height_m() / spacing_m) + 1.0;
    require(columns * rows <= 33554432.0, "path: at most 2^25 points of the grid");
    columns_ = static_cast<int>(columns);
    rows_ = static_cast<int>(rows);
    nodes_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  }

  bool can_go(Point a, Point b) const { return !advance(walls_, a, b, radius_m_).blocked; }

  /// The grid's way, ends included; empty if there is none.
  std::vector<Point> run() {
    for_each_near(from_, [&](int node) { reach(node, distance(from_, at(node)), start); });
    std::vector<std::pair<int, double>> last;
    for_each_near(to_, [&](int node) { last.emplace_back(node, distance(at(node), to_)); });
    double best = never;
    int end = start;
    while (!open_.empty() && open_.top().first < best) {
      const int node = open_.top().second;
      open_.pop();
      if (std::exchange(of(node).done, true)) continue;
      for (const auto& [exit, rest_m] : last) {
        if (exit == node && of(node).cost_m + rest_m < best) {
          best = of(node).cost_m + rest_m;
          end = node;
        }
      }
      expand(node);
    }
    std::vector<Point> points;
    if (end == start) return points;
    points.push_back(to_);
    for (int node = end; node != start; node = of(node).before) points.push_back(at(node));
    points.push_back(from_);
    std::reverse(points.begin(), points.end());
    return points;
  }

 private:
  static constexpr int start = -1;
  struct Node {
    double cost_m = never;
    double room_m = -1.0;  // clearance, as far as it matters; below 0: not looked at
    int before = start;
    bool done = false;
  };

  Node& of(int node) { return nodes_[static_cast<std::size_t>(node)]; }
  Point at(int node) const { return {node % columns_ * spacing_m_, node / columns_ * spacing_m_}; }
  double room(int node) {
    Node& n = of(node);
    if (n.room_m < 0.0) n.room_m = clearance(walls_, at(node), radius_m_ + diagonal * spacing_m_);
    return n.room_m;
  }

  /// Octile distance to the goal, less what the last leg, of at most 2√2 spacings in any direction,
  /// can be shorter than along the grid: so it is never more than the way that is left.
  double ahead(int node) const {
    const Point p = at(node);
    const double dx = std::fabs(to_.x_m - p.x_m), dy = std::fabs(to_.y_m - p.y_m);
    const double octile = std::max(dx, dy) + (diagonal - 1.0) * std::min(dx, dy);
    return std::max(0.0, octile - 0.24 * spacing_m_);
  }

  void reach(int node, double cost_m, int before) {
    Node& n = of(node);
    if (n.done || cost_m >= n.cost_m) return;
    n.cost_m = cost_m;
    n.before = before;
    open_.emplace(cost_m + ahead(node), node);
  }

  /// The points within two spacings that can be gone to straight.
  template <typename F>
  void for_each_near(Point p, F&& f) {
    const int column = static_cast<int>(p.x_m / spacing_m_),
              row = static_cast<int>(p.y_m / spacing_m_);
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 2); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 2); ++c) {
        const int node = r * columns_ + c;
        if (room(node) >= radius_m_ && can_go(p, at(node)) && can_go(at(node), p)) f(node);
      }
    }
  }

  void expand(int node) {
    const int column = node % columns_, row = node / columns_;
    for (int dr = -1; dr <= 1; ++dr) {
      for (int dc = -1; dc <= 1; ++dc) {
        const int c = column + dc, r = row + dr;
        if ((dr == 0 && dc == 0) || c < 0 || r < 0 || c >= columns_ || r >= rows_) continue;
        const int next = r * columns_ + c;
        if (of(next).done || room(next) < radius_m_) continue;
        const double step = (dr != 0 && dc != 0 ? diagonal : 1.0) * spacing_m_;
        // Far enough from all walls at one end, there is none on the way.
        const bool wide = std::max(room(node), room(next)) >= radius_m_ + step;
        if (!wide && !can_go(at(node), at(next))) continue;
        reach(next, of(node).cost_m + step, node);
      }
    }
  }

  const WallIndex& walls_;
  Point from_, to_;
  double radius_m_, spacing_m_;
  int columns_ = 0, rows_ = 0;
  std::vector<Node> nodes_;
  using Open = std::pair<double, int>;  // ties go to the lower node
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open_;
};

/// Leaves out what can be left out: from each point straight to the last that can be gone to.
std::vector<Point> pull(const Search& search, const std::vector<Point>& points) {
  std::vector<Point> tight{points.front()};
  for (std::size_t i = 0; i + 1 < points.size();) {
    std::size_t j = points.size() - 1;
    while (j > i + 1 && !search.can_go(points[i], points[j])) --j;
    tight.push_back(points[j]);
    i = j;
  }
  return tight;
}

/// Cuts each corner as deep as the walls let: once round.
std::vector<Point> cut(const Search& search, const std::vector<Point>& points) {
  constexpr double worth_m = 1e-4;
  std::vector<Point> tight{points.front()};
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Point a = tight.back(), b = points[i], c = points[i + 1];
    if (search.can_go(a, c)) continue;
    const double before = distance(a, b), after = distance(b, c);
    // Equally far on both sides, at most as far as the shorter leg, or half of what is a kink next.
    const double most = std::min(before, after);
    const auto ends = [&](double depth) {
      const double s = depth / before, t = depth / after;
      return std::pair<Point, Point>{{b.x_m + s * (a.x_m - b.x_m), b.y_m + s * (a.y_m - b.y_m)},
                                     {b.x_m + t * (c.x_m - b.x_m), b.y_m + t * (c.y_m - b.y_m)}};
    };
    double low = 0.0, high = most;
    for (int halvings = 0; halvings < 30; ++halvings) {
      const double depth = halvings == 0 ? most : 0.5 * (low + high);
      const auto [p, q] = ends(depth);
      const bool free = search.can_go(a, p) && search.can_go(p, q) && search.can_go(q, c);
      (free ? low : high) = depth;
      if (low == most) break;
    }
    const auto [p, q] = ends(low);
    if (2.0 * low - distance(p, q) < worth_m) {
      tight.push_back(b);
      continue;
    }
    if (!(p == a)) tight.push_back(p);
    if (!(q == c)) tight.push_back(q);
  }
  tight.push_back(points.back());
  return tight;
}

}  // namespace

std::optional<Path> shortest_path(const WallIndex& walls, Point from, Point to, double radius_m,
                                  double spacing_m) {
  require(walls.contains(from) && walls.contains(to), "path: an end outside the plan");
  require(radius_m >= radius_min_m, "path: a radius of 1 µm or more");
  require(spacing_m > 0.0, "path: a spacing above 0");
  if (clearance(walls, from, radius_m) < radius_m || clearance(walls, to, radius_m) < radius_m) {
    return std::nullopt;
  }
  Search search(walls, from, to, radius_m, spacing_m);
  if (search.can_go(from, to)) return Path{{from, to}, distance(from, to)};
  std::vector<Point> points = search.run();
  if (points.empty()) return std::nullopt;
  points = pull(search, points);
  constexpr int rounds_max = 40;
  constexpr double gain_min_m = 1e-5;
  double now = length(points);
  for (int round = 0; round < rounds_max; ++round) {
    points = cut(search, points);
    const double before = std::exchange(now, length(points));
    if (before - now < gain_min_m) break;
  }
  return Path{std::move(points), now};
}

}  // namespace hearsay::plan
