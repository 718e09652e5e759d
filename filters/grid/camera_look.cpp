#include "filters/grid/camera_look.hpp"

#include <algorithm>
#include <cmath>

#include "filters/grid/footprint.hpp"
#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::grid {
namespace {

using gaussian::CameraPose;
using gaussian::Matrix;
using gaussian::Vector;
using gaussian::Vector3;

/// Squared Mahalanobis distance up to which pixels count.
constexpr double gate = 9.0;

/// Projection without a heap or checks: the caller has looked at the lens.
struct Pixel {
  double u, v;
};
std::optional<Pixel> pixel_of(const gaussian::Intrinsics& lens, const CameraPose& pose,
                              const Vector3& point_m) {
  const Vector3 p = gaussian::in_camera(pose, point_m);
  if (!(p(2) > 0.0)) return std::nullopt;
  const double x = p(0) / p(2), y = p(1) / p(2);
  return Pixel{lens.focal_u * x + lens.skew * y + lens.center_u, lens.focal_v * y + lens.center_v};
}

/// First and last whole number in [from, to], within 0 … count − 1.
struct Whole {
  int first, last;
};
Whole whole_between(double from, double to, int count) {
  return {static_cast<int>(std::clamp(std::ceil(from), 0.0, count + 0.0)),
          static_cast<int>(std::clamp(std::floor(to), -1.0, count - 1.0))};
}

/// d² = a·du² + 2b·du·dv + c·dv².
struct Precision {
  double a, b, c;
};

/// Weights of the pixels of a row, marked and all: exp(−d²/2) from pixel to pixel by
/// multiplication, since d² is quadratic in u.
struct Weights {
  double marked = 0.0, all = 0.0;
};
void add_row(const SegmentedImage& image, const PixelEllipse& at, const Precision& p, int v,
             double decay, Weights& sum) {
  const double dv = v - at.v;
  const double half = p.b * p.b * dv * dv - p.a * (p.c * dv * dv - gate);
  if (half < 0.0) return;
  const double middle = at.u - p.b * dv / p.a, reach_u = std::sqrt(half) / p.a;
  const Whole range = whole_between(middle - reach_u, middle + reach_u, image.width());
  if (range.first > range.last) return;
  const double du = range.first - at.u;
  double weight = math::exp(-0.5 * (p.a * du * du + 2.0 * p.b * du * dv + p.c * dv * dv));
  double factor = math::exp(-0.5 * (p.a * (2.0 * du + 1.0) + 2.0 * p.b * dv));
  const unsigned char* const pixels = image.row(v);
  for (int u = range.first; u <= range.last; ++u) {
    sum.all += weight;
    if (pixels[u] != 0) sum.marked += weight;
    weight *= factor;
    factor *= decay;
  }
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
  if (!(at.uu > 0.0) || !(determinant > 0.0) || !std::isfinite(determinant)) return std::nullopt;
  const double reach_u = std::sqrt(gate * at.uu), reach_v = std::sqrt(gate * at.vv);
  const Whole rows = whole_between(at.v - reach_v, at.v + reach_v, image.height());
  const Whole columns = whole_between(at.u - reach_u, at.u + reach_u, image.width());
  if (rows.first > rows.last || columns.first > columns.last) return std::nullopt;
  const SegmentedImage::Box& box = image.marked();
  const bool apart = box.u_from > columns.last || box.u_to < columns.first ||
                     box.v_from > rows.last || box.v_to < rows.first;
  if (apart) return 0.0;
  const Precision p{at.vv / determinant, -at.uv / determinant, at.uu / determinant};
  const double decay = math::exp(-p.a);
  Weights sum;
  for (int v = rows.first; v <= rows.last; ++v) add_row(image, at, p, v, decay, sum);
  if (!(sum.all > 0.0)) return std::nullopt;
  return std::min(1.0, sum.marked / sum.all);
}

CameraLook::CameraLook(const GridCamera& camera, const Area& area) : camera_(camera), area_(area) {
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

bool CameraLook::look(const CameraPose& pose, const Matrix& covariance) {
  require(covariance.rows() == 6 && covariance.cols() == 6,
          "CameraLook: the covariance of a pose is 6×6");
  require(pose.position_m.allFinite() && pose.axes.allFinite(), "CameraLook: a pose is finite");
  in_view_.clear();
  if (!set_samples(pose, covariance)) return false;
  find_cells(pose);
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
    moved.position_m += e.head<3>();
    samples_[i] = {moved, e(6), e(7), points->weights[i]};
  }
  return true;
}

void CameraLook::find_cells(const CameraPose& pose) {
  const auto reach_m = reach(pose.position_m(2) - camera_.ground_m, camera_.range_max_m);
  if (!reach_m) return;
  const gaussian::Intrinsics& k = camera_.lens;
  const double right = camera_.width - 0.5, low = camera_.height - 0.5;
  Footprint ground = Footprint::around({pose.position_m(0), pose.position_m(1)}, *reach_m);
  const std::array<Vector3, 5> walls = {
      Vector3(0.0, 0.0, 1.0),                            // ahead
      Vector3(k.focal_u, k.skew, k.center_u + 0.5),      // u ≥ −½
      Vector3(-k.focal_u, -k.skew, right - k.center_u),  // u ≤ width − ½
      Vector3(0.0, k.focal_v, k.center_v + 0.5),         // and so v
      Vector3(0.0, -k.focal_v, low - k.center_v)};
  for (const Vector3& wall : walls) ground.cut(pose.position_m, pose.axes * wall, camera_.ground_m);
  for_each_cell(ground, area_, [&](int cell) {
    const Point at = area_.centre(cell);
    const Vector3 point(at.x_m, at.y_m, camera_.ground_m);
    const auto pixel = pixel_of(k, pose, point);
    if (!pixel || !(pixel->u >= -0.5 && pixel->u < right)) return;
    if (!(pixel->v >= -0.5 && pixel->v < low)) return;
    const Vector3 to = point - pose.position_m;
    const double rho = to.dot(to) / (camera_.range_max_m * camera_.range_max_m);
    if (rho < 1.0) in_view_.push_back({cell, faded(camera_.detector, rho)});
  });
}

std::optional<PixelEllipse> CameraLook::ellipse(int cell) const {
  const Point at = area_.centre(cell);
  std::array<Pixel, 2 * dimension + 1> pixels;
  PixelEllipse e{0.0, 0.0, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Sample& s = samples_[i];
    const auto pixel =
        pixel_of(camera_.lens, s.pose, {at.x_m + s.dx_m, at.y_m + s.dy_m, camera_.ground_m});
    if (!pixel) return std::nullopt;
    pixels[i] = *pixel;
    e.u += s.weight * pixel->u;
    e.v += s.weight * pixel->v;
  }
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const double du = pixels[i].u - e.u, dv = pixels[i].v - e.v, weight = samples_[i].weight;
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
