// Images of a grid of cells as a camera over them sees it, segmented pixel by pixel: the other side
// of filters/grid/camera_look.hpp, which judges cells by such images.
//
// A pixel looks along the ray through its centre. Where the ray meets the plane of the cells in one
// that holds the thing sought, the pixel is marked with probability P_D, elsewhere with P_F, both
// faded with the distance of that point (Merino 2007, eq. 4.14–4.15). At the range both are ½, and
// so they are for a pixel that looks farther, or over the horizon: it tells nothing. (Cells close
// to the range are judged by pixels on either side of it.)
//
// Over a relief a pixel shows the cell that its ray comes under first (grid::Relief::first_met()),
// or the plane around, if none.
//
// Pixel (u, v) has draw v·width + u of its image, 32 bits, whatever is true. Two truths, seen from
// one place with the same draws, differ at pixels that show the difference and at no other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "filters/gaussian/camera.hpp"
#include "filters/grid/area.hpp"
#include "filters/grid/camera_look.hpp"
#include "sim/kernel/leg.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {

class TruthImage {
 public:
  /// Two draws a word, of the 131,072 words that belong to one count of a Stream.
  static constexpr int pixels_max = 262144;

  /// Hangs `depression_rad` (0 … π/2) below the horizon. A relief is not copied. @throws
  /// BrokenInvariant outside that, or the camera's ranges, for more pixels or a relief of another
  /// area.
  TruthImage(const grid::GridCamera& camera, double depression_rad, const grid::Area& area,
             const grid::Relief* relief = nullptr);

  /// At (x, y, z), m, turned towards a heading. @throws BrokenInvariant unless all is finite.
  gaussian::CameraPose pose(const Point& place_m, double heading_rad) const;

  /// The image from there. `truth`: 1 for each cell with the thing sought, 0 for others. Valid
  /// until the next call. Costs as much as there are pixels, and as many again if the height is not
  /// that of the call before; a glance at each cell in view; and for true ones the pixels that show
  /// them. Over a relief instead a ray a pixel, over the cells that lie below it from the highest
  /// height down. @throws BrokenInvariant for a truth about another number of cells.
  const grid::SegmentedImage& draw(const Point& place_m, double heading_rad,
                                   std::span<const unsigned char> truth, Stream draws);

 private:
  void set_thresholds(double z_m);
  void set_thresholds_over_relief(const gaussian::CameraPose& pose,
                                  std::span<const unsigned char> truth);
  void expect_true_cells(const gaussian::CameraPose& pose, std::span<const unsigned char> truth);
  void expect_cell(const gaussian::CameraPose& pose, int cell);
  void mark(Stream& draws);

  grid::GridCamera camera_;
  double depression_rad_;
  grid::Area area_;
  const grid::Relief* relief_;  ///< nothing if level
  grid::SegmentedImage image_;
  // Of all pixels, row by row, for one height: a draw below it is a mark.
  double z_m_ = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::uint32_t> detected_, false_alarm_;  // if it shows a true cell, and if not
  std::vector<std::uint32_t> threshold_;  // of this image; between images, those of false alarms
  std::vector<std::size_t> showing_;      // pixels that show true cells
};

}  // namespace hearsay
