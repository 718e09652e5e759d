// A camera over a grid on a level plane or a relief, nadir or tilted. Merino 2007, sections 3.5 and
// 4.2.1.
//
// An image was segmented: each pixel is taken for the thing sought, or for background. Where a cell
// is in the image is uncertain, since the camera's pose is, and since a cell is not a point. The
// unscented transform (Algorithm 3.5) makes an ellipse of it, and the cell is judged by the pixels
// in the ellipse, by their weight under the Gaussian (eq. 4.11 and 4.31; figure 4.3). Cells are
// judged one by one, although cells that share pixels do depend on each other (eq. 4.8); so does
// the text.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "filters/gaussian/camera.hpp"
#include "filters/gaussian/propagation.hpp"
#include "filters/grid/footprint.hpp"
#include "filters/grid/relief.hpp"
#include "filters/grid/sensors.hpp"

namespace hearsay::grid {

/// Pixels (u, v) have their centres at whole numbers, 0 ≤ u < width, 0 ≤ v < height.
class SegmentedImage {
 public:
  static constexpr int side_max = 4096;
  /// All background. @throws BrokenInvariant unless both sides are 1 … side_max.
  SegmentedImage(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  bool at(int u, int v) const { return pixels_[index(u, v)] != 0; }
  /// Marks a pixel as the thing sought.
  void mark(int u, int v);
  void clear();

  /// Sides of the least upright rectangle around all marks, edges included; empty (from > to) if
  /// there are none.
  struct Box {
    int u_from, u_to, v_from, v_to;
  };
  const Box& marked() const { return marked_; }
  const unsigned char* row(int v) const { return pixels_.data() + index(0, v); }

 private:
  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(u);
  }
  int width_, height_;
  Box marked_{};
  std::vector<unsigned char> pixels_;
};

/// N(μ, Σ) in the image, pixels and pixels².
struct PixelEllipse {
  double u, v;
  double uu, uv, vv;
};

/// The share of marked pixels in the ellipse d² ≤ 9, by their weight exp(−d²/2); pixels outside the
/// image are left out. Nothing if there is none inside, or if Σ is less than half a pixel wide in
/// some direction or not finite. Costs as much as there are pixels in the ellipse, and next to
/// nothing where no mark is near.
std::optional<double> marked_share(const SegmentedImage& image, const PixelEllipse& ellipse);

struct GridCamera {
  gaussian::Intrinsics lens;
  int width, height;      ///< of the image, pixels
  Detector detector;      ///< of a pixel, at distance 0
  double range_max_m;     ///< P_D and P_F reach ½ there, eq. 4.14–4.15; > 0
  double ground_m = 0.0;  ///< height of the level plane of the cells
  /// What blurs a pixel's place beside the pose, in pixels. At least ½: the sum over pixels then
  /// stands for the integral to 1 %.
  double sigma_pixel = 0.5;
  bool cells_have_extent = true;  ///< adds the variance of a point in its cell, cell²/12 an axis
};

/// What of the plane is in the image and nearer than range_max_m (squared off), and `margin_m` ≥ 0
/// more on every side; nothing unless the camera is above the plane and it within reach. Of a
/// relief: a polygon around all that is so at its cells' heights.
Footprint ground_in_image(const GridCamera& camera, const gaussian::CameraPose& pose,
                          double margin_m = 0.0, const Relief* relief = nullptr);

/// The cells with centres in the image and nearer than range_max_m, rising, with P_D and P_F at
/// their distance: costs as much as there are of these. `out` is overwritten, its storage reused.
/// On a relief cells have their heights, and those whose centres are hidden by others are not in
/// view (Relief::sees()): each costs a ray. All or nothing: of a cell in view others may hide a
/// part. @throws BrokenInvariant outside the ranges above, for a pose that is not finite, or a
/// relief of another area.
void cells_in_image(const GridCamera& camera, const gaussian::CameraPose& pose, const Area& area,
                    std::vector<CellInView>& out, const Relief* relief = nullptr);

/// A look from one place: which cells are in view, and where in the image they are. Reused from
/// look to look it allocates nothing once warm.
class CameraLook {
 public:
  /// A relief is not copied. @throws BrokenInvariant outside the ranges above, or for a relief of
  /// another area.
  CameraLook(const GridCamera& camera, const Area& area, const Relief* relief = nullptr);

  /// Takes a pose, believed to be off by a position (3, m, world) and a small rotation (3, rad,
  /// about the camera's axes) of this covariance (6×6), and finds the cells in view. False, with
  /// nothing in view, if the covariance is indefinite or not finite. @throws BrokenInvariant for
  /// another shape.
  bool look(const gaussian::CameraPose& pose, const gaussian::Matrix& covariance);

  /// As by cells_in_image().
  std::span<const CellInView> in_view() const { return in_view_; }

  /// Nothing if a sigma point has the cell behind it.
  std::optional<PixelEllipse> ellipse(int cell) const;

  /// What an image from there says about each cell in view. @throws BrokenInvariant for an image of
  /// another size.
  void judge(const SegmentedImage& image, std::vector<CellLook>& out) const;

 private:
  /// A sigma point, camera and cell shifted: s·(u, v, 1) = H·(x, y, 1) + h·`up` for a cell's centre
  /// at height h over the plane.
  struct Sample {
    gaussian::Matrix3 homography;
    gaussian::Vector3 up;
    double weight;
  };
  static constexpr int dimension = 8;
  bool set_samples(const gaussian::CameraPose& pose, const gaussian::Matrix& covariance);

  GridCamera camera_;
  Area area_;
  const Relief* relief_;  ///< nothing if level
  std::array<Sample, 2 * dimension + 1> samples_;
  std::vector<CellInView> in_view_;
};

}  // namespace hearsay::grid
