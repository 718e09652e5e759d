// Plans: the walls and the named places of a level floor.
//
// A plan lies in 0 … width × 0 … height metres, y up. Its walls are segments without thickness, and
// it is closed: nobody who is not in a wall gets out. One that is drawn in cells, as text or as a
// bitmap, has thick walls, of which the plan holds the surface: the lines between wall and free
// cells, what lies beyond the drawing counting as wall, each as long as it is straight. A segment
// of a drawing has the free side on its left.
//
// A text drawing has a character a cell, the first line at the top:
//     #            wall
//     space or .   free
//     A-Z, a-z     free, and the place of that name is in the middle of the cell; each letter once
// Lines are equally long and end with a line feed, which may have a carriage return before it and
// may be missing from the last.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hearsay::plan {

struct Point {
  double x_m = 0.0, y_m = 0.0;
  friend bool operator==(const Point&, const Point&) = default;
};
/// With both ends; never of length 0.
struct Segment {
  Point from, to;
};
struct Place {
  std::string name;
  Point at;
};
/// With sides above 0.
struct Rectangle {
  Point min, max;
};
/// The body of a robot, or what else is round.
struct Disc {
  Point at;
  double radius_m = 0.0;
};

inline constexpr int side_max = 4096;              ///< cells a side of a drawing
inline constexpr std::size_t walls_max = 1000000;  ///< segments of a plan
inline constexpr double cell_min_m = 0.001, cell_max_m = 20.0;
inline constexpr double extent_max_m = 1e5;  ///< a side; places are then exact to 2e-11 m

/// A floor cut into square cells.
struct Drawing {
  int columns = 0, rows = 0;        ///< 1 … side_max
  double cell_m = 1.0;              ///< side of a cell, cell_min_m … cell_max_m
  std::vector<std::uint8_t> walls;  ///< 1 wall, 0 free: row by row from the bottom, each from x = 0
  std::vector<Place> places;

  /// Any cell; beyond the drawing all is wall.
  bool wall(int column, int row) const {
    return column < 0 || row < 0 || column >= columns || row >= rows ||
           walls[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                 static_cast<std::size_t>(column)] != 0;
  }
  /// Adds a place. @throws InputError for an empty name or one that is there already, or a point
  /// that is not in a free cell.
  void add(const std::string& name, Point at);
};

/// Reads a text drawing. `name` stands for the text in messages.
/// @throws InputError with line and column, what was found and what is allowed: another character,
/// a letter that is there twice, lines of different lengths, more than side_max lines or columns,
/// no free cell, `cell_m` outside its range.
Drawing parse_text(std::string_view text, const std::string& name, double cell_m);
/// The same from a file. @throws InputError, also if it cannot be read.
Drawing read_text(const std::string& file, double cell_m);

/// Reads a bitmap in PNG, of any kind: a pixel is a wall if its luminance (0.2126 R + 0.7152 G +
/// 0.0722 B of the values as stored, over white where it is transparent) is below `threshold`,
/// 1 … 255. It has no places: see Drawing::add().
/// @throws InputError for what is no whole PNG, for more than side_max pixels a side, no free
/// pixel, `cell_m` or `threshold` outside its range.
Drawing parse_png(std::string_view bytes, const std::string& name, double cell_m,
                  int threshold = 128);
/// The same from a file of at most 64 MiB. @throws InputError, also if it cannot be read.
Drawing read_png(const std::string& file, double cell_m, int threshold = 128);

class Plan {
 public:
  /// @throws InputError for a drawing with more than walls_max segments.
  explicit Plan(const Drawing& drawing);
  /// Walls in any direction; the four outer sides are added in front of them.
  /// @throws InputError for sides outside (0, extent_max_m], a wall or a place that is not within
  /// them or not finite, a wall of length 0, too many walls, an empty name, a name used twice.
  Plan(double width_m, double height_m, std::vector<Segment> walls, std::vector<Place> places = {});

  double width_m() const { return width_m_; }
  double height_m() const { return height_m_; }
  std::span<const Segment> walls() const { return walls_; }
  std::span<const Place> places() const { return places_; }
  /// @throws InputError that names the places there are, if there is none of that name.
  Point place(std::string_view name) const;
  /// Whether the point is outside of thick walls. Those of a drawing are; a plan of segments has
  /// none. Goes through all walls.
  bool free(Point p) const;
  /// Whether the point is within the outer sides or on them.
  bool contains(Point p) const {
    return p.x_m >= 0.0 && p.y_m >= 0.0 && p.x_m <= width_m_ && p.y_m <= height_m_;
  }

 private:
  double width_m_, height_m_;
  bool thick_ = false;
  std::vector<Segment> walls_;
  std::vector<Place> places_;
};

}  // namespace hearsay::plan
