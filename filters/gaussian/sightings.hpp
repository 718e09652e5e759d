// Measurements that are not linear in the state: z = h(x) + v, v ~ N(0, S). The state x (n) begins
// with a position of d = 2 or 3 coordinates, in metres; what follows it (a velocity) is not seen.
//
// A model has `value(x)`, h(x) (m); `jacobian(x)`, ∂h/∂x (m×n); and `difference(a, b)`, a − b (m)
// with angles wrapped to (−π, π]. Value and Jacobian are nothing where h is not defined: for a
// bearing to one's own place, or a point behind the camera. Angles are counter-clockwise, in rad.
#pragma once

#include <concepts>
#include <optional>

#include "filters/gaussian/belief.hpp"
#include "filters/gaussian/camera.hpp"

namespace hearsay::gaussian {

template <typename Model>
concept MeasurementModel = requires(const Model& model, const Vector& v) {
  { model.value(v) } -> std::same_as<std::optional<Vector>>;
  { model.jacobian(v) } -> std::same_as<std::optional<Matrix>>;
  { model.difference(v, v) } -> std::same_as<Vector>;
};

/// Who looks: where it stands (d = 2 or 3), and which way its bearings count from.
struct Observer {
  Vector place_m;
  double heading_rad = 0.0;
};

/// d = 2: (range, bearing). d = 3: (range, bearing, elevation above the horizon).
struct RangeBearing {
  Observer observer;
  std::optional<Vector> value(const Vector& x) const;
  std::optional<Matrix> jacobian(const Vector& x) const;
  Vector difference(const Vector& a, const Vector& b) const;
};

/// The same without the range: d = 2: (bearing); d = 3: (bearing, elevation).
struct BearingOnly {
  Observer observer;
  std::optional<Vector> value(const Vector& x) const;
  std::optional<Matrix> jacobian(const Vector& x) const;
  Vector difference(const Vector& a, const Vector& b) const;
};

/// The pixel (u, v) of a camera whose pose is known (eq. 3.57). d = 3, or d = 2 for a state in the
/// plane z = plane_m.
struct CameraPixel {
  Intrinsics camera;
  CameraPose pose;
  std::optional<double> plane_m;  ///< given: d = 2
  std::optional<Vector> value(const Vector& x) const;
  std::optional<Matrix> jacobian(const Vector& x) const;
  Vector difference(const Vector& a, const Vector& b) const { return a - b; }
};

}  // namespace hearsay::gaussian
