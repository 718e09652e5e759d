// What looks say about cells, and a sensor that tells only that something is there. Merino 2007,
// sections 4.2.1 and 4.5; table B.1. The camera is in filters/grid/camera_look.hpp.
//
// A detector sees what is there with probability P_D, and what is not with P_F. Both fade towards
// ½, at which a look says nothing: P(ρ) = P(1 − ρ) + ½ρ, with ρ = (d/d_max)² for the distance d
// (eq. 4.14–4.15).
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "filters/gaussian/camera.hpp"
#include "filters/grid/bernoulli.hpp"
#include "filters/grid/beta.hpp"
#include "filters/grid/relief.hpp"

namespace hearsay::grid {

/// Both in (0, 1).
struct Detector {
  double p_detect, p_false;
  friend bool operator==(const Detector&, const Detector&) = default;
};

struct NamedDetector {
  std::string_view name;
  Detector detector;
};
/// Of fire in images, Merino 2007, table B.1: "infrared", "visual", "combined".
std::span<const NamedDetector> detectors();
/// Nothing for an unknown name.
std::optional<Detector> detector_by_name(std::string_view name);

/// ρ in [0, 1]. @throws BrokenInvariant outside, or for probabilities that are not in (0, 1).
Detector faded(const Detector& detector, double rho);

/// log p(z|x)/p(z|x̄), nats, where the share `seen` in [0, 1] of what shows the cell was classified
/// as the thing sought, the rest as background (eq. 4.9–4.13 in 4.11): p(z|x) = s·P_D +
/// (1−s)(1−P_D), p(z|x̄) likewise with P_F. Share 0 is negative information.
double log_likelihood_ratio(const Detector& detector, double seen);

/// A cell that a sensor looks at, and how well.
struct CellInView {
  int cell;
  Detector detector;
};
/// What a look says about a cell: to Bernoulli grids a ratio, to Beta grids counts.
struct CellLook {
  int cell;
  double ratio;  ///< log p(z|x)/p(z|x̄), nats
  double m, n;   ///< detections and non-detections, ≥ 0
};
void add(std::span<const CellLook> looks, BernoulliGrid& grid);
void add(std::span<const CellLook> looks, BetaGrid& grid);

/// A sensor without bearing: something is in its field of view, a cone, or not.
struct PresenceSensor {
  Detector detector;
  double range_max_m;     ///< > 0
  double angle_max_rad;   ///< half the opening angle, off the axis, in (0, π]
  double ground_m = 0.0;  ///< height of the level plane of the cells
};

/// The cells with centres nearer than range_max_m and less off the axis (the pose's z) than
/// angle_max_rad, rising. 1 − ρ = (1 − (d/d_max)²)(1 − (φ/φ_max)²): the text draws both factors
/// (figure 4.5) and prints the first. Costs as much as there are cells in an octagon around the
/// cone's ground (up to π/2.2 off axis; beyond in a square around the range). `out` is overwritten,
/// its storage reused. On a relief as by cells_in_image(). @throws BrokenInvariant outside the
/// ranges above, or for a relief of another area.
void cells_in_view(const PresenceSensor& sensor, const gaussian::CameraPose& pose, const Area& area,
                   std::vector<CellInView>& out, const Relief* relief = nullptr);

/// What the answer says about each of S cells in view. Bernoulli: eq. 4.16–4.19. Beta: m = 1/S if
/// something was detected (it is in one of them), n = 1 if not (eq. 4.32–4.33).
void presence_look(std::span<const CellInView> cells, bool detected, std::vector<CellLook>& out);

}  // namespace hearsay::grid
