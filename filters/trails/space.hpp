// Localization-spaces: what the position of a crumb is, and which crumbs a robot finds near. Store
// and codec are written against the concept; here is the metric space of LOST, positions in the
// robot's own odometry frame. A space of views (Shamshirdar 2019, section 4.2.1) has embeddings as
// positions and a least similarity as its reach, and no frames to be transformed.
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "filters/trails/trail.hpp"

namespace hearsay::trails {

/// What TrailStore and the codec ask of a space S:
/// - S::Position: a value, equality-comparable.
/// - S::Reach: what "near" means in one query, with the robot's own position in it.
/// - S::Index(S::Options): positions by slot (0, 1, 2, …; a slot has one position at a time), each
/// of
///   an event. add() and remove() them; visit(event, reach, f) calls f(slot) once for each slot of
///   that event near, in any order.
/// - S::numbers: floats a position takes on the air, written and read by put() and get().
/// - S::sound(position): whether the index can hold it. What is not sound is refused, so that
///   nothing that was heard can do harm.
template <typename S>
concept LocalizationSpace = std::equality_comparable<typename S::Position> &&
    std::constructible_from<typename S::Index, const typename S::Options&> &&
    requires(typename S::Index index, const typename S::Index& fixed, std::uint32_t slot,
             EventId event, const typename S::Position& position, const typename S::Reach& reach,
             void (*f)(std::uint32_t), std::span<float> out, std::span<const float> in) {
  index.add(slot, event, position);
  index.remove(slot);
  fixed.visit(event, reach, f);
  { S::sound(position) } -> std::same_as<bool>;
  S::put(position, out);
  { S::get(in) } -> std::same_as<typename S::Position>;
  requires std::same_as<const std::size_t, decltype(S::numbers)>;
};

/// In the frame of one robot. Float: the same number in memory and on the air, 1 mm at 10 km.
struct Point {
  float x_m = 0.0F, y_m = 0.0F;
  friend bool operator==(const Point&, const Point&) = default;
};
inline Point point(double x_m, double y_m) {
  return {static_cast<float>(x_m), static_cast<float>(y_m)};
}

/// What the robot looks at (Sadat & Vaughan, "Blinkered LOST", ICRA 2010: 60–120° wide).
struct Field {
  double heading_rad = 0.0;  ///< its middle
  double width_rad = 0.0;    ///< from edge to edge, in (0, 2π]; its edges belong to it
};

/// Crumbs nearer than `radius_m` (Shamshirdar 2019, section 4.2.5: dist(L_C, L_R) < r), and in the
/// field of view if there is one. A crumb at the robot's very position is in view.
struct MetricReach {
  Point at;
  double radius_m = 1.0;
  std::optional<Field> field = std::nullopt;
};

/// Points in square cells, each cell a linked list for each event; cells are found by a lattice
/// that repeats itself only after as many cells as there are points or more, along rows and along
/// columns: list = (column + row · stride + event · shift) mod lists. A query looks at lists of the
/// cells it touches alone, if these are fewer than the points; else at each point. Small blocks of
/// cells have a list each, so that a point found near need not tell of which cell it is.
class MetricIndex {
 public:
  struct Options {
    double cell_m = 1.0;  ///< best about the sense radius; in [0.01, 1e6]
  };
  /// @throws BrokenInvariant for another cell.
  explicit MetricIndex(const Options& options);

  /// @throws BrokenInvariant for a slot in use, or a position that is not sound.
  void add(std::uint32_t slot, EventId event, const Point& at);
  /// @throws BrokenInvariant for a slot not in use.
  void remove(std::uint32_t slot);
  std::size_t size() const { return size_; }

  /// @throws BrokenInvariant for a position that is not sound, a radius that is negative or no
  /// number, or a field outside its range.
  template <typename F>
  void visit(EventId event, const MetricReach& reach, F&& f) const {
    const Sight sight(reach);
    look(event, sight, [&](std::uint32_t slot, const Cell* cell) {
      const Node& node = nodes_[slot];
      if (node.event != event || !sight.sees(node.at)) return;
      if (cell == nullptr || is_in(node.at, *cell)) f(slot);
    });
  }
  /// How many points such a visit looks at: its cost.
  std::size_t looks(EventId event, const MetricReach& reach) const {
    std::size_t count = 0;
    look(event, Sight(reach), [&](std::uint32_t, const Cell*) { ++count; });
    return count;
  }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t unused = none - 1;
  static constexpr std::uint32_t shift = 0x9e3779b1U;  ///< events lie far apart in the lists, too
  struct Node {
    Point at;
    EventId event = no_event;
    std::uint32_t next = none;
    std::uint32_t before = unused;  ///< in its list; says, too, whether the slot is in use
  };
  struct Cell {
    std::int32_t column = 0, row = 0;
  };
  /// A reach, ready to be asked.
  struct Sight {
    explicit Sight(const MetricReach& reach);
    bool sees(const Point& p) const {
      const double x = double{p.x_m} - double{at.x_m}, y = double{p.y_m} - double{at.y_m};
      const double squared = x * x + y * y;
      if (!(squared < radius_squared)) return false;
      return !has_field || x * heading_x + y * heading_y >= edge_cos * std::sqrt(squared);
    }
    Point at;
    double radius_m, radius_squared;
    bool has_field = false;
    double heading_x = 1.0, heading_y = 0.0, edge_cos = -1.0;
  };
  struct Block {
    bool all = false;
    Cell first, last;
  };
  /// Calls f(slot, cell) for all points that are looked at: with the cell for which, if a list may
  /// be looked at for several, else with null.
  template <typename F>
  void look(EventId event, const Sight& sight, F&& f) const {
    const Block block = block_of(sight);
    if (block.all) {
      for (std::uint32_t slot = 0; slot < nodes_.size(); ++slot) {
        if (nodes_[slot].before != unused) f(slot, nullptr);
      }
      return;
    }
    const bool shared = lists_shared(block);
    Cell cell;
    for (cell.row = block.first.row; cell.row <= block.last.row; ++cell.row) {
      for (cell.column = block.first.column; cell.column <= block.last.column; ++cell.column) {
        for (std::uint32_t slot = heads_[list_of(event, cell)]; slot != none;
             slot = nodes_[slot].next) {
          f(slot, shared ? &cell : nullptr);
        }
      }
    }
  }
  Block block_of(const Sight& sight) const;
  /// Whether two cells of a block are filed in one list.
  bool lists_shared(const Block& block) const;
  Cell cell_of(const Point& at) const;
  bool is_in(const Point& at, const Cell& cell) const;
  std::uint32_t list_of(EventId event, const Cell& cell) const {
    return (static_cast<std::uint32_t>(cell.column) +
            static_cast<std::uint32_t>(cell.row) * stride_ + event * shift) &
           mask_;
  }
  void link(std::uint32_t slot);
  void resize_lists(std::uint32_t bits);

  double cell_m_;
  std::size_t size_ = 0;
  std::uint32_t bits_ = 0, mask_ = 0, stride_ = 1;
  std::vector<std::uint32_t> heads_;  ///< of lists: 2^bits
  std::vector<Node> nodes_;           ///< by slot
};

struct MetricSpace {
  using Position = Point;
  using Reach = MetricReach;
  using Index = MetricIndex;
  using Options = MetricIndex::Options;
  static constexpr std::size_t numbers = 2;
  /// Coordinates beyond it are no odometry.
  static constexpr float position_max_m = 1e6F;

  /// Both coordinates finite and within position_max_m.
  static bool sound(const Point& p) {
    return p.x_m >= -position_max_m && p.x_m <= position_max_m && p.y_m >= -position_max_m &&
           p.y_m <= position_max_m;
  }
  static void put(const Point& p, std::span<float> out) {
    out[0] = p.x_m;
    out[1] = p.y_m;
  }
  static Point get(std::span<const float> in) { return {in[0], in[1]}; }
};
static_assert(LocalizationSpace<MetricSpace>);

}  // namespace hearsay::trails
