#include "filters/grid/camera_look.hpp"

#include <algorithm>
#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::grid {
namespace {

using gaussian::CameraPose;
using gaussian::Matrix;
using gaussian::Matrix3;
using gaussian::Vector;
using gaussian::Vector3;

/// Squared Mahalanobis distance up to which pixels count.
constexpr double gate = 9.0;
/// Of an ellipse in any direction, pixels²: ¼ less rounding.
constexpr double least_variance = 0.24;

struct Pixel {
  double u, v;
};

/// s·(u, v, 1) = H·(x, y, 1) + h·`up` for points (x, y) at height h over the plane z = `ground_m`,
/// s > 0 the distance ahead: H = K·R·(e_x, e_y, (0, 0, z) − t), up = K·R·e_z, eq. 3.57.
struct Projection {
  Matrix3 homography;
  Vector3 up;

  /// Nothing unless the point lies ahead.
  std::optional<Pixel> pixel(Point at, double height_m) const {
    const auto row = [&](int i) {
      const double on_plane =
          homography(i, 0) * at.x_m + homography(i, 1) * at.y_m + homography(i, 2);
      return height_m != 0.0 ? on_plane + height_m * up(i) : on_plane;
    };
    const double ahead = row(2);
    if (!(ahead > 0.0)) return std::nullopt;
    return Pixel{row(0) / ahead, row(1) / ahead};
  }
};
Projection projection_of(const gaussian::Intrinsics& lens, const CameraPose& pose,
                         double ground_m) {
  Matrix3 k;
  k << lens.focal_u, lens.skew, lens.center_u, 0.0, lens.focal_v, lens.center_v, 0.0, 0.0, 1.0;
  const Matrix3 to_pixel = k * pose.axes.transpose();
  Matrix3 homography;
  homography.col(0) = to_pixel.col(0);
  homography.col(1) = to_pixel.col(1);
  homography.col(2) = to_pixel * (Vector3(0.0, 0.0, ground_m) - pose.position_m);
  return {homography, to_pixel.col(2)};
}

/// First and last whole number in [from, to], within 0 … count − 1.
struct Whole {
  int first, last;
};
Whole whole_between(double from, double to, int count) {
  const double low = std::clamp(from, 0.0, count + 0.0);
  const int below = static_cast<int>(low);
  const int first = below < low ? below + 1 : below;
  return {first, to < 0.0 ? -1 : static_cast<int>(std::min(to, count - 1.0))};
}

/// The weight exp(−d²/2) at a pixel, d² = a·du² + 2b·du·dv + c·dv², and how it goes on: it changes
/// by a factor from pixel to pixel, and that by a constant one, since d² is quadratic. Steps along
/// the edge of an ellipse of at least half a pixel keep d below 6.
class Walk {
 public:
  Walk(double a, double b, double c)
      : a_(a),
        b_(b),
        c_(c),
        by_a_(math::exp(-a)),
        by_b_(math::exp(-b)),
        by_c_(math::exp(-c)),
        back_a_(1.0 / by_a_),
        back_b_(1.0 / by_b_) {}

  /// To column `du` and row `dv`, both relative to the centre.
  void jump(double du, double dv) {
    weight_ = math::exp(-0.5 * (a_ * du * du + 2.0 * b_ * du * dv + c_ * dv * dv));
    right_ = math::exp(-0.5 * (a_ * (2.0 * du + 1.0) + 2.0 * b_ * dv));
    down_ = math::exp(-0.5 * (c_ * (2.0 * dv + 1.0) + 2.0 * b_ * du));
  }
  void down() {
    weight_ *= down_;
    down_ *= by_c_;
    right_ *= by_b_;
  }
  void right() {
    weight_ *= right_;
    right_ *= by_a_;
    down_ *= by_b_;
  }
  void left() {
    right_ *= back_a_;
    weight_ /= right_;
    down_ *= back_b_;
  }
  /// Weights of `count` pixels from here to the right, and of the marked ones among them.
  void add_row(const unsigned char* pixels, int count, double& all, double& marked) const {
    double weight = weight_, factor = right_;
    for (int i = 0; i < count; ++i) {
      all += weight;
      if (pixels[i] != 0) marked += weight;
      weight *= factor;
      factor *= by_a_;
    }
  }

 private:
  double a_, b_, c_;
  double by_a_, by_b_, by_c_, back_a_, back_b_;
  double weight_ = 0.0, right_ = 0.0, down_ = 0.0;
};

void require_camera(const GridCamera& camera) {
  require(camera.lens.focal_u > 0.0 && camera.lens.focal_v > 0.0,
          "GridCamera: focal lengths are positive");
  require(camera.width >= 1 && camera.width <= SegmentedImage::side_max && camera.height >= 1 &&
              camera.height <= SegmentedImage::side_max,
          "GridCamera: sides of the image are 1 to 4096");
  require(camera.range_max_m > 0.0 && std::isfinite(camera.range_max_m),
          "GridCamera: the range is positive");
  require(camera.sigma_pixel >= 0.5 && std::isfinite(camera.sigma_pixel),
          "GridCamera: a pixel's place is blurred by at least half a pixel");
  faded(camera.detector, 0.0);
}

}  // namespace

SegmentedImage::SegmentedImage(int width, int height) : width_(width), height_(height) {
  require(width >= 1 && width <= side_max && height >= 1 && height <= side_max,
          "SegmentedImage: sides are 1 to 4096");
  pixels_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  clear();
}

void SegmentedImage::mark(int u, int v) {
  require(u >= 0 && u < width_ && v >= 0 && v < height_, "SegmentedImage: no such pixel");
  pixels_[index(u, v)] = 1;
  marked_ = {std::min(marked_.u_from, u), std::max(marked_.u_to, u), std::min(marked_.v_from, v),
             std::max(marked_.v_to, v)};
}

void SegmentedImage::clear() {
  std::fill(pixels_.begin(), pixels_.end(), static_cast<unsigned char>(0));
  marked_ = {width_, -1, height_, -1};
}

std::optional<double> marked_share(const SegmentedImage& image, const PixelEllipse& at) {
  const double determinant = at.uu * at.vv - at.uv * at.uv;
  const double over_u = at.uu - least_variance, over_v = at.vv - least_variance;
  if (!(over_u > 0.0 && over_u * over_v >= at.uv * at.uv)) return std::nullopt;
  if (!std::isfinite(determinant)) return std::nullopt;
  const double reach_u = std::sqrt(gate * at.uu), reach_v = std::sqrt(gate * at.vv);
  const Whole rows = whole_between(at.v - reach_v, at.v + reach_v, image.height());
  const Whole columns = whole_between(at.u - reach_u, at.u + reach_u, image.width());
  if (rows.first > rows.last || columns.first > columns.last) return std::nullopt;
  const SegmentedImage::Box& box = image.marked();
  const bool inside = at.u >= 0.0 && at.u <= image.width() - 1 && at.v >= 0.0 &&
                      at.v <= image.height() - 1;  // so that there is a pixel in the ellipse
  const bool apart = box.u_from > columns.last || box.u_to < columns.first ||
                     box.v_from > rows.last || box.v_to < rows.first;
  if (inside && apart) return 0.0;
  const double a = at.vv / determinant, b = -at.uv / determinant, c = at.uu / determinant;
  // Of a row: its ellipse's middle, and half its length squared.
  const double slope = at.uv / at.vv;
  const double at_middle = gate * determinant / at.vv, by_dv = determinant / (at.vv * at.vv);
  Walk walk(a, b, c);
  double all = 0.0, marked = 0.0;
  int column = -1;  // where the walk stands; nowhere yet
  for (int v = rows.first; v <= rows.last; ++v) {
    const double dv = v - at.v;
    const double half = std::sqrt(std::max(0.0, at_middle - by_dv * dv * dv));
    const double middle = at.u + slope * dv;
    const Whole range = whole_between(middle - half, middle + half, image.width());
    if (range.first > range.last) {
      column = -1;
      continue;
    }
    if (column < 0) {
      walk.jump(range.first - at.u, dv);
      column = range.first;
    } else {
      walk.down();
    }
    for (; column < range.first; ++column) walk.right();
    for (; column > range.first; --column) walk.left();
    walk.add_row(image.row(v) + range.first, range.last - range.first + 1, all, marked);
  }
  if (!(all > 0.0)) return std::nullopt;
  return std::min(1.0, marked / all);
}

Footprint ground_in_image(const GridCamera& camera, const CameraPose& pose, double margin_m,
                          const Relief* relief) {
  const Slab heights = slab_of(relief, camera.ground_m);
  const auto reach_m = heights.reach(pose.position_m(2), camera.range_max_m);
  if (!reach_m) return {};
  const gaussian::Intrinsics& k = camera.lens;
  const double right = camera.width - 0.5, low = camera.height - 0.5;
  const std::array<Vector3, 5> walls = {
      Vector3(0.0, 0.0, 1.0),                            // ahead
      Vector3(k.focal_u, k.skew, k.center_u + 0.5),      // u ≥ −½
      Vector3(-k.focal_u, -k.skew, right - k.center_u),  // u ≤ width − ½
      Vector3(0.0, k.focal_v, k.center_v + 0.5),         // and so v
      Vector3(0.0, -k.focal_v, low - k.center_v)};
  Footprint ground =
      Footprint::around({pose.position_m(0), pose.position_m(1)}, *reach_m + margin_m);
  for (const Vector3& wall : walls) {
    const Vector3 inward = pose.axes * wall;
    // The margin is along the plane. A wall that is level has none: it cuts all or nothing.
    const double level = std::sqrt(inward(0) * inward(0) + inward(1) * inward(1));
    const double out = level > 0.0 ? margin_m / level : 0.0;
    ground.cut(pose.position_m - out * Vector3(inward(0), inward(1), 0.0), inward,
               heights.before(inward));
  }
  return ground;
}

void cells_in_image(const GridCamera& camera, const CameraPose& pose, const Area& area,
                    std::vector<CellInView>& out, const Relief* relief) {
  require_camera(camera);
  require(pose.position_m.allFinite() && pose.axes.allFinite(), "GridCamera: a pose is finite");
  out.clear();
  relief = uneven(relief, area);
  const double right = camera.width - 0.5, low = camera.height - 0.5;
  const Projection projection = projection_of(camera.lens, pose, camera.ground_m);
  const Vector3 over_plane = pose.position_m - Vector3(0.0, 0.0, camera.ground_m);
  for_each_cell(ground_in_image(camera, pose, 0.0, relief), area, [&](int cell) {
    const Point at = area.centre(cell);
    const double height_m = relief != nullptr ? relief->height_m(cell) : 0.0;
    const auto pixel = projection.pixel(at, height_m);
    if (!pixel || !(pixel->u >= -0.5 && pixel->u < right)) return;
    if (!(pixel->v >= -0.5 && pixel->v < low)) return;
    const Vector3 to = Vector3(at.x_m, at.y_m, camera.ground_m + height_m) - pose.position_m;
    const double rho = to.dot(to) / (camera.range_max_m * camera.range_max_m);
    if (!(rho < 1.0) || (relief != nullptr && !relief->sees(over_plane, cell))) return;
    out.push_back({cell, faded(camera.detector, rho)});
  });
}

CameraLook::CameraLook(const GridCamera& camera, const Area& area, const Relief* relief)
    : camera_(camera), area_(area), relief_(uneven(relief, area)) {
  require_camera(camera);
}

bool CameraLook::look(const CameraPose& pose, const Matrix& covariance) {
  require(covariance.rows() == 6 && covariance.cols() == 6,
          "CameraLook: the covariance of a pose is 6×6");
  in_view_.clear();
  if (!set_samples(pose, covariance)) return false;
  cells_in_image(camera_, pose, area_, in_view_, relief_);
  return true;
}

bool CameraLook::set_samples(const CameraPose& pose, const Matrix& covariance) {
  Matrix errors = Matrix::Zero(dimension, dimension);
  errors.topLeftCorner(6, 6) = covariance;
  const double extent = camera_.cells_have_extent ? area_.cell_m() * area_.cell_m() / 12.0 : 0.0;
  errors(6, 6) = errors(7, 7) = extent;
  // κ = 0: the middle weighs nothing, and no ellipse comes out indefinite.
  const auto points = gaussian::sigma_points({Vector::Zero(dimension), errors}, 0.0);
  if (!points) return false;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Vector& e = points->points[i];
    CameraPose moved = pose.turned(e.segment<3>(3));
    moved.position_m += e.head<3>() - Vector3(e(6), e(7), 0.0);  // a cell moves against it
    const auto [homography, up] = projection_of(camera_.lens, moved, camera_.ground_m);
    samples_[i] = {homography, up, points->weights[i]};
  }
  return true;
}

std::optional<PixelEllipse> CameraLook::ellipse(int cell) const {
  const Point at = area_.centre(cell);
  const double height_m = relief_ != nullptr ? relief_->height_m(cell) : 0.0;
  std::array<double, 2 * dimension + 1> us, vs;
  PixelEllipse e{0.0, 0.0, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Matrix3& h = samples_[i].homography;
    Vector3 raised = h.col(2);
    if (height_m != 0.0) raised += height_m * samples_[i].up;
    const double ahead = h(2, 0) * at.x_m + h(2, 1) * at.y_m + raised(2);
    if (!(ahead > 0.0)) return std::nullopt;
    const double scale = 1.0 / ahead;
    us[i] = (h(0, 0) * at.x_m + h(0, 1) * at.y_m + raised(0)) * scale;
    vs[i] = (h(1, 0) * at.x_m + h(1, 1) * at.y_m + raised(1)) * scale;
    e.u += samples_[i].weight * us[i];
    e.v += samples_[i].weight * vs[i];
  }
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const double du = us[i] - e.u, dv = vs[i] - e.v, weight = samples_[i].weight;
    e.uu += weight * du * du;
    e.uv += weight * du * dv;
    e.vv += weight * dv * dv;
  }
  const double blur = camera_.sigma_pixel * camera_.sigma_pixel;
  e.uu += blur;
  e.vv += blur;
  return e;
}

void CameraLook::judge(const SegmentedImage& image, std::vector<CellLook>& out) const {
  require(image.width() == camera_.width && image.height() == camera_.height,
          "CameraLook: an image of another size");
  out.clear();
  for (const CellInView& in_view : in_view_) {
    const auto at = ellipse(in_view.cell);
    const auto share = at ? marked_share(image, *at) : std::nullopt;
    if (!share) continue;
    out.push_back(
        {in_view.cell, log_likelihood_ratio(in_view.detector, *share), *share, 1.0 - *share});
  }
}

}  // namespace hearsay::grid
