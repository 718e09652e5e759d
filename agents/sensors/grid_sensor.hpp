// Sensors of agents with certainty grids: what they see of the truth, as the looks that grids add.
// What a look says about cells is in filters/grid/camera_look.hpp and sensors.hpp.
//
// A camera. It hangs as it should: towards the heading, so far below the horizon. Its image is
// drawn from there (agents/sensors/truth_image.hpp). Its owner believes a pose that is off by
// noise, and judges the cells from there.
//
// A presence sensor (Merino 2007, eq. 4.16–4.19) gives one answer, while each cell is judged as if
// it alone decided. The answer drawn here is decided by how far the sensor sees. Of a cell with
// fade ρ (0: seen best; 1: not at all) it has a clear view with probability 1 − ρ, and then of all
// cells with less fade, too. With a clear view of a true cell it fires with P_D; otherwise, with a
// clear view of any, with P_F; else with ½:
//
//   p = ½ρ₀ + P_F(ρ_x − ρ₀) + P_D(1 − ρ_x),
//
// ρ₀ the least fade of all cells in view, ρ_x the least of the true ones, 1 if there are none. So
// p is P_D for a true cell at distance 0 on the axis. With one cell in view it is the faded P_D or
// P_F by which that cell is judged, so that beliefs come out calibrated; with more, looks are as
// ambiguous as they are. Nothing jumps where a true cell leaves the view (had each of them its own
// faded P_D, which is ½ at the edge, a few that are barely in view would set it off for certain).
// Several true cells do no more than the one seen best: the text's sensor tells neither far from
// small nor one from many.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "agents/sensors/truth_image.hpp"
#include "filters/gaussian/camera.hpp"
#include "filters/grid/area.hpp"
#include "filters/grid/camera_look.hpp"
#include "filters/grid/sensors.hpp"
#include "sim/kernel/ids.hpp"
#include "sim/kernel/leg.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {

class GridSensor {
 public:
  /// An image is segmented pixel by pixel.
  struct Camera {
    gaussian::Intrinsics lens;
    int width, height;                ///< pixels, width·height ≤ TruthImage::pixels_max
    double sigma_position_m = 0.0;    ///< of the pose it believes, each axis, ≥ 0 …
    double sigma_attitude_rad = 0.0;  ///< … and about each axis of its own, ≥ 0
    double sigma_pixel = 0.5;         ///< as in grid::GridCamera, ≥ ½
  };
  /// As grid::PresenceSensor; it knows where it is.
  struct Presence {
    double angle_max_rad;  ///< in (0, π]
  };
  struct Options {
    grid::Detector detector;                 ///< at distance 0; 0 < P_F < P_D < 1
    double range_max_m;                      ///< > 0
    double depression_rad = 0.5 * math::pi;  ///< of its view below the horizon, 0 … π/2
    std::variant<Camera, Presence> kind;
    std::shared_ptr<const grid::Relief> relief = nullptr;  ///< of the same area; none: level
  };
  /// @throws BrokenInvariant outside these ranges.
  GridSensor(const Options& options, const grid::Area& area);

  /// The `count`-th look of `agent` from its true place (x, y, and the height over the plane z = 0
  /// of level cells, m), flying towards `heading_rad`; at most one a cell, in rising order.
  /// `truth`: 1 for each cell with the thing sought, 0 for others. Empty if it sees no cell.
  /// Nothing that is drawn depends on the place or the truth, so the same count meets the same
  /// luck. Valid until the next call. @throws BrokenInvariant for a truth about another number of
  /// cells, a place that is not finite.
  std::span<const grid::CellLook> look(const Point& place_m, double heading_rad,
                                       std::span<const unsigned char> truth, std::uint64_t seed,
                                       AgentId agent, std::uint64_t count);

  /// The cells that would be in view from there if the pose were known, rising, with their
  /// detectors: what a gain is expected of. Costs as much as there are of these. Valid until the
  /// next call of anything.
  std::span<const grid::CellInView> view(const Point& place_m, double heading_rad);

 private:
  struct Imager {
    grid::GridCamera camera;
    TruthImage truth;
    grid::CameraLook look;
    double sigma_position_m, sigma_attitude_rad;
    gaussian::Matrix covariance;  ///< of the pose it believes, 6×6
  };
  using Eye = std::variant<Imager, grid::PresenceSensor>;
  static Eye eye_of(const Options& options, const grid::Area& area);
  /// Whose draws.
  struct Draws {
    std::uint64_t seed;
    AgentId agent;
    std::uint64_t count;
  };
  void take(Imager& imager, const Point& place_m, double heading_rad,
            std::span<const unsigned char> truth, const Draws& draws);
  void take(const grid::PresenceSensor& sensor, const Point& place_m, double heading_rad,
            std::span<const unsigned char> truth, const Draws& draws);
  gaussian::CameraPose pose(const Point& place_m, double heading_rad) const;

  double depression_rad_;
  grid::Area area_;
  std::shared_ptr<const grid::Relief> relief_;  // the eye looks at it, too
  Eye eye_;
  std::vector<grid::CellInView> in_view_;
  std::vector<grid::CellLook> looks_;
};

}  // namespace hearsay
