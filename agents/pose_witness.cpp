#include "agents/pose_witness.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {

PoseWitness::PoseWitness(Simulation& simulation, Options options)
    : simulation_(simulation), options_(std::move(options)), central_(options_.central) {
  require(options_.names.size() == options_.journeys.size() &&
              options_.central.start.size() == options_.names.size(),
          "a pose witness needs a name and a journey for each robot");
  for (const Journey& journey : options_.journeys) odometers_.emplace_back(journey.drives);
  for (const std::string& name : options_.names) {
    names_.push_back(simulation_.record().name(name));
  }
}

void PoseWitness::watch(AgentId agent, PoseMind& mind) {
  watched_.push_back({.agent = agent, .mind = &mind, .sums = {}});
}

void PoseWitness::advance(std::size_t robot) {
  odometers_[robot].advance(simulation_.now(), [&](Time, double forward, double turn, double dt_s) {
    central_.drive(static_cast<int>(robot), forward, turn, dt_s);
  });
}

void PoseWitness::saw_place(AgentId agent, const Eigen::Vector2d& place_m,
                            const localization::RelativeSighting& seen) {
  advance(static_cast<std::size_t>(agent));
  central_.saw_place(agent, place_m, seen);
}

void PoseWitness::saw_robot(AgentId agent, AgentId other,
                            const localization::RelativeSighting& seen) {
  advance(static_cast<std::size_t>(agent));
  advance(static_cast<std::size_t>(other));
  central_.saw_robot(agent, other, seen);
}

void PoseWitness::start() { schedule_sample(Time()); }

void PoseWitness::schedule_sample(Time at) {
  simulation_.schedule(at, Phase::observe, [this, at] {
    sample();
    if (at == simulation_.end()) return;
    schedule_sample(std::min(at + options_.series_period, simulation_.end()));
  });
}

std::optional<localization::Pose> PoseWitness::truth(std::size_t robot) const {
  const std::vector<TruePose>& truth = options_.journeys[robot].truth;
  const auto at = std::lower_bound(truth.begin(), truth.end(), simulation_.now(),
                                   [](const TruePose& pose, Time now) { return pose.time < now; });
  if (at == truth.end() || at->time != simulation_.now()) return std::nullopt;
  return at->pose;
}

void PoseWitness::sample() {
  central_sums_.begin_sample();
  for (std::size_t robot = 0; robot < odometers_.size(); ++robot) {
    advance(robot);
    const auto i = static_cast<int>(robot);
    sample(central_agent, robot, central_.pose(i), central_.covariance(i), central_sums_);
  }
  for (Watched& watched : watched_) {
    watched.sums.begin_sample();
    const std::optional<PoseBelief> own = watched.mind->own_pose();
    if (!own) continue;
    sample(watched.agent, static_cast<std::size_t>(watched.agent), own->pose, own->covariance,
           watched.sums);
  }
}

void PoseWitness::sample(AgentId agent, std::size_t robot, const localization::Pose& pose,
                         const Eigen::Matrix3d& covariance, Sums& sums) {
  const auto there = truth(robot);
  if (!there) return;
  const Eigen::Vector3d error(pose.x_m - there->x_m, pose.y_m - there->y_m,
                              math::wrap_angle(pose.heading_rad - there->heading_rad));
  const Eigen::LLT<Eigen::Matrix3d> cholesky(covariance);
  require(cholesky.info() == Eigen::Success, "a pose's covariance is not positive definite");
  const double nees = error.dot(cholesky.solve(error));
  Record& record = simulation_.record();
  const auto keep = [&](Metric metric, double value) {
    const auto& wanted = options_.series;
    if (std::find(wanted.begin(), wanted.end(), metric) == wanted.end()) return;
    record.series(simulation_.now(), agent, names_[robot],
                  record.name(metrics()[static_cast<std::size_t>(metric)].name), value);
  };
  keep(Metric::rms_error_m, error.head<2>().norm() / std::sqrt(2.0));
  keep(Metric::claimed_sigma_m, std::sqrt(0.5 * covariance.topLeftCorner<2, 2>().trace()));
  keep(Metric::nees, nees);
  keep(Metric::x_m, pose.x_m);
  keep(Metric::y_m, pose.y_m);
  keep(Metric::x_error_m, error.x());
  keep(Metric::y_error_m, error.y());
  ++sums.last;
  sums.last_distance_m += error.head<2>().norm();
  sums.last_variance_m2 += 0.5 * covariance.topLeftCorner<2, 2>().trace();
  ++sums.samples;
  sums.distance_m += error.head<2>().norm();
  sums.heading_rad2 += error.z() * error.z();
  sums.nees += nees;
}

void PoseWitness::leave(AgentId agent, const Sums& sums) {
  Record& record = simulation_.record();
  const auto scalar = [&](const char* name, double value) {
    record.scalar(agent, record.name(name), value);
  };
  scalar("distance_error_m", sums.last_distance_m / sums.last);
  scalar("final_claimed_sigma_m", std::sqrt(sums.last_variance_m2 / sums.last));
  const double n = sums.samples;
  scalar("position_error_mean_m", sums.distance_m / n);
  scalar("heading_error_rms_rad", std::sqrt(sums.heading_rad2 / n));
  scalar("pose_anees", sums.nees / (3.0 * n));
}

void PoseWitness::finish() {
  Record& record = simulation_.record();
  record.scalar(central_agent, record.name("state_dimension"), 3.0);
  leave(central_agent, central_sums_);
  for (const Watched& watched : watched_) leave(watched.agent, watched.sums);
}

}  // namespace hearsay
