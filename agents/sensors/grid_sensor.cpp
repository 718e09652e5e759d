#include "agents/sensors/grid_sensor.hpp"

#include <algorithm>
#include <cmath>

#include "filters/gaussian/geolocation.hpp"
#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

bool is_sigma(double sigma) { return sigma >= 0.0 && std::isfinite(sigma); }

/// Probability that a presence sensor fires: ½ρ₀ + P_F(ρ_x − ρ₀) + P_D(1 − ρ_x). Faded by ρ, P_F is
/// ½ρ + P_F(1 − ρ), and P_D − P_F is (1 − ρ) times what it was. At least one cell in view.
double fires(std::span<const grid::CellInView> in_view, std::span<const unsigned char> truth) {
  double clearest = 0.0, clearest_true = 0.0, p_false = 0.5;
  for (const auto& [cell, detector] : in_view) {
    const double clear = detector.p_detect - detector.p_false;
    if (clear > clearest) {
      clearest = clear;
      p_false = detector.p_false;
    }
    if (truth[static_cast<std::size_t>(cell)] != 0) clearest_true = std::max(clearest_true, clear);
  }
  return p_false + clearest_true;
}

}  // namespace

GridSensor::Eye GridSensor::eye_of(const Options& options, const grid::Area& area) {
  const grid::Detector& detector = options.detector;
  require(detector.p_detect > detector.p_false,
          "GridSensor: what is there is seen with a greater probability than what is not");
  require(options.depression_rad >= 0.0 && options.depression_rad <= 0.5 * math::pi,
          "GridSensor: it looks 0 to π/2 below the horizon");
  if (const Presence* const presence = std::get_if<Presence>(&options.kind)) {
    const grid::PresenceSensor sensor{.detector = detector,
                                      .range_max_m = options.range_max_m,
                                      .angle_max_rad = presence->angle_max_rad};
    std::vector<grid::CellInView> none;
    grid::cells_in_view(sensor, gaussian::looking({0.0, 0.0, 0.0}, 0.0, 0.0), area, none,
                        options.relief.get());
    return sensor;  // its ranges have been looked at
  }
  const Camera& camera = std::get<Camera>(options.kind);
  require(is_sigma(camera.sigma_position_m) && is_sigma(camera.sigma_attitude_rad),
          "GridSensor: the sigmas of a pose are not negative");
  const grid::GridCamera lens{.lens = camera.lens,
                              .width = camera.width,
                              .height = camera.height,
                              .detector = detector,
                              .range_max_m = options.range_max_m,
                              .sigma_pixel = camera.sigma_pixel};
  const gaussian::Matrix errors =
      gaussian::look_covariance({camera.sigma_position_m, camera.sigma_attitude_rad, 0.0});
  return Imager{lens,
                TruthImage(lens, options.depression_rad, area, options.relief.get()),
                grid::CameraLook(lens, area, options.relief.get()),
                camera.sigma_position_m,
                camera.sigma_attitude_rad,
                errors.topLeftCorner(6, 6)};
}

GridSensor::GridSensor(const Options& options, const grid::Area& area)
    : depression_rad_(options.depression_rad),
      area_(area),
      relief_(options.relief),
      eye_(eye_of(options, area)) {}

gaussian::CameraPose GridSensor::pose(const Point& place_m, double heading_rad) const {
  return gaussian::looking({place_m[0], place_m[1], place_m[2]}, heading_rad, depression_rad_);
}

void GridSensor::take(Imager& imager, const Point& place_m, double heading_rad,
                      std::span<const unsigned char> truth, const Draws& draws) {
  const Entity entity = Entity::agent(draws.agent);
  Stream noise = Stream::at(draws.seed, Purpose("pose of a camera"), entity, draws.count);
  gaussian::Vector3 shift, turn;
  for (double& n : shift.reshaped()) n = imager.sigma_position_m * noise.normal();
  for (double& n : turn.reshaped()) n = imager.sigma_attitude_rad * noise.normal();
  gaussian::CameraPose believed = pose(place_m, heading_rad).turned(turn);
  believed.position_m += shift;
  if (!imager.look.look(believed, imager.covariance) || imager.look.in_view().empty()) return;
  const Stream pixels = Stream::at(draws.seed, Purpose("pixels"), entity, draws.count);
  imager.look.judge(imager.truth.draw(place_m, heading_rad, truth, pixels), looks_);
}

void GridSensor::take(const grid::PresenceSensor& sensor, const Point& place_m, double heading_rad,
                      std::span<const unsigned char> truth, const Draws& draws) {
  grid::cells_in_view(sensor, pose(place_m, heading_rad), area_, in_view_, relief_.get());
  if (in_view_.empty()) return;
  const double u =
      Stream::uniform_at(draws.seed, Purpose("presence"), Entity::agent(draws.agent), draws.count);
  grid::presence_look(in_view_, u < fires(in_view_, truth), looks_);
}

std::span<const grid::CellLook> GridSensor::look(const Point& place_m, double heading_rad,
                                                 std::span<const unsigned char> truth,
                                                 std::uint64_t seed, AgentId agent,
                                                 std::uint64_t count) {
  require(truth.size() == static_cast<std::size_t>(area_.cells()),
          "GridSensor: a truth is about all cells");
  looks_.clear();
  std::visit(
      [&](auto& eye) {
        take(eye, place_m, heading_rad, truth, {seed, agent, count});
      },
      eye_);
  return looks_;
}

std::span<const grid::CellInView> GridSensor::view(const Point& place_m, double heading_rad) {
  const gaussian::CameraPose from = pose(place_m, heading_rad);
  if (const Imager* const imager = std::get_if<Imager>(&eye_)) {
    grid::cells_in_image(imager->camera, from, area_, in_view_, relief_.get());
  } else {
    grid::cells_in_view(std::get<grid::PresenceSensor>(eye_), from, area_, in_view_, relief_.get());
  }
  return in_view_;
}

}  // namespace hearsay
