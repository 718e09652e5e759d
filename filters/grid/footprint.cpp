#include "filters/grid/footprint.hpp"

#include "sim/kernel/error.hpp"

namespace hearsay::grid {

Footprint Footprint::around(Point centre, double reach_m) {
  Footprint square;
  square.count_ = 4;
  square.corners_[0] = {centre.x_m - reach_m, centre.y_m - reach_m};
  square.corners_[1] = {centre.x_m + reach_m, centre.y_m - reach_m};
  square.corners_[2] = {centre.x_m + reach_m, centre.y_m + reach_m};
  square.corners_[3] = {centre.x_m - reach_m, centre.y_m + reach_m};
  return square;
}

void Footprint::cut(const gaussian::Vector3& on_wall, const gaussian::Vector3& inward,
                    double ground_m) {
  // One wall of Sutherland and Hodgman, Comm. ACM 17(1), 1974.
  const auto before_wall = [&](const Point& p) {
    return inward(0) * (p.x_m - on_wall(0)) + inward(1) * (p.y_m - on_wall(1)) +
           inward(2) * (ground_m - on_wall(2));
  };
  const std::array<Point, corners_max> old = corners_;
  const std::size_t old_count = count_;
  count_ = 0;
  const auto keep = [this](const Point& p) {
    require(count_ < corners_max, "footprint: more than 8 cuts");
    corners_[count_++] = p;
  };
  for (std::size_t i = 0; i < old_count; ++i) {
    const Point& from = old[i];
    const Point& to = old[(i + 1) % old_count];
    const double d_from = before_wall(from), d_to = before_wall(to);
    if (d_from >= 0.0) keep(from);
    if ((d_from >= 0.0) == (d_to >= 0.0)) continue;
    const double share = d_from / (d_from - d_to);
    keep({from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m)});
  }
}

double Footprint::square_metres() const {
  double twice = 0.0;
  for (std::size_t i = 2; i < count_; ++i) {
    const Point &a = corners_[0], &b = corners_[i - 1], &c = corners_[i];
    twice += (b.x_m - a.x_m) * (c.y_m - a.y_m) - (c.x_m - a.x_m) * (b.y_m - a.y_m);
  }
  return 0.5 * twice;
}

std::optional<Footprint::Stretch> Footprint::along(double y_m) const {
  std::optional<Stretch> stretch;
  for (std::size_t i = 0; i < count_; ++i) {
    const Point& from = corners_[i];
    const Point& to = corners_[(i + 1) % count_];
    if (y_m < std::min(from.y_m, to.y_m) || y_m > std::max(from.y_m, to.y_m)) continue;
    const double rise = to.y_m - from.y_m;
    const double x =
        rise == 0.0 ? from.x_m : from.x_m + (y_m - from.y_m) / rise * (to.x_m - from.x_m);
    if (!stretch) stretch = Stretch{x, x};
    stretch->from_m = std::min(stretch->from_m, x);
    stretch->to_m = std::max(stretch->to_m, x);
  }
  return stretch;
}

std::optional<double> reach(double height_m, double range_m) {
  const double square = (range_m - height_m) * (range_m + height_m);
  if (!(height_m > 0.0) || !(square > 0.0)) return std::nullopt;
  return std::sqrt(square);
}

}  // namespace hearsay::grid
