#include "agents/trails/trail_witness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Of an even number of values the lower one of the two in the middle: half of them have come.
double median(std::vector<double> values) {
  if (values.empty()) return none;
  const std::size_t middle = (values.size() - 1) / 2;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle),
                   values.end());
  return values[middle];
}

}  // namespace

TrailWitness::TrailWitness(Simulation& simulation, const RobotWorld& world, Options options)
    : simulation_(simulation), world_(world), options_(std::move(options)) {
  require(options_.wrong_m > 0.0, "trail witness: a wrong crumb has an error above 0");
  const auto wants = [&](const char* name) {
    return std::find(options_.series.begin(), options_.series.end(), name) != options_.series.end();
  };
  wanted_ = {.pose = wants("robot_x_m") || wants("robot_y_m") || wants("robot_heading_rad"),
             .trips = wants("trips_so_far"),
             .trips_an_hour = wants("trips_an_hour"),
             .crumbs = wants("crumbs_alive"),
             .error = wants("crumb_error_m") || wants("crumbs_wrong_share"),
             .hops = wants("hearsay_hops_mean"),
             .trip_length = wants("trip_length_m"),
             .trip_duration = wants("trip_duration_s")};
}

std::size_t TrailWitness::index(int robot) const {
  require(robot >= 0 && static_cast<std::size_t>(robot) < robots_.size(),
          "trail witness: there is no such robot");
  return static_cast<std::size_t>(robot);
}

void TrailWitness::watch(AgentId agent, int robot, const TrailMind& mind) {
  require(static_cast<std::size_t>(robot) == robots_.size(),
          "trail witness: robots in ascending number");
  Robot& watched = robots_.emplace_back();
  watched.agent = agent;
  watched.robot = robot;
  watched.mind = &mind;
}

void TrailWitness::sets_off(int robot) {
  Robot& r = robots_[index(robot)];
  r.set_off = simulation_.now();
  r.set_off_m = r.distance_m;
}

void TrailWitness::drove(int robot, double length_m, bool blocked, Doing doing, double dt_s) {
  Robot& r = robots_[index(robot)];
  r.distance_m += length_m;
  r.spent_s[static_cast<std::size_t>(doing)] += dt_s;
  if (blocked) r.blocked_s += dt_s;
}

bool TrailWitness::arrived(int robot, trails::EventId event) {
  Robot& r = robots_[index(robot)];
  const std::string& name = world_.name_of(event);
  if (!r.set_off) return false;
  const Time now = simulation_.now();
  const Trip trip{r.distance_m - r.set_off_m, (now - *r.set_off).seconds()};
  r.trips.push_back(trip);
  team_trips_.push_back(now);
  if (!r.first_arrival) r.first_arrival = now;
  const std::optional<Time> change = world_.changed();
  if (change && *r.set_off >= *change && r.recovered_from != change) {
    r.recovered_from = change;
    r.recovery_s = (now - *change).seconds();
  }
  r.set_off.reset();
  simulation_.record().event(now, r.agent, "arrived",
                             name + ' ' + std::to_string(r.trips.size()) + ' ' +
                                 std::to_string(trip.length_m) + ' ' +
                                 std::to_string(trip.duration_s));
  return true;
}

bool TrailWitness::all_arrived() {
  return std::all_of(robots_.begin(), robots_.end(), [this](const Robot& robot) {
    return robot.first_arrival || (options_.up && !options_.up(robot.agent));
  });
}

void TrailWitness::dropped(int robot) {
  if (!wanted_.error && !wanted_.hops && !options_.crumbs) return;
  robots_[index(robot)].dropped.push_back(world_.pose(robot));
}

void TrailWitness::told(int robot, std::span<const trails::Crumb> crumbs) {
  if (!wanted_.error && !wanted_.hops && !options_.crumbs) return;
  Robot& r = robots_[index(robot)];
  require(crumbs.size() == r.dropped.size(), "trail witness: crumbs told that were not dropped");
  for (std::size_t i = 0; i < crumbs.size(); ++i) {
    const trails::Crumb& crumb = crumbs[i];
    const drive::Pose& at = r.dropped[i];
    if (wanted_.error || wanted_.hops) {
      book_.insert(crumb.identity, static_cast<std::uint32_t>(truth_.size()));
      truth_.push_back({at.x_m, at.y_m});
    }
    if (!options_.crumbs) continue;
    simulation_.record().event(simulation_.now(), r.agent, "crumb",
                               world_.name_of(crumb.event) + ' ' + std::to_string(at.x_m) + ' ' +
                                   std::to_string(at.y_m) + ' ' + std::to_string(at.heading_rad) +
                                   ' ' + std::to_string(crumb.distance_s));
  }
  r.dropped.clear();
}

std::uint8_t TrailWitness::hops_of(int robot, std::uint32_t number) const {
  const std::vector<std::uint8_t>& hops = robots_[static_cast<std::size_t>(robot)].hops;
  return number < hops.size() ? hops[number] : std::uint8_t{0};
}

void TrailWitness::learned(int robot, trails::RobotId from,
                           std::span<const trails::Identity> crumbs) {
  if (!wanted_.hops) return;
  Robot& r = robots_[index(robot)];
  r.hops.resize(truth_.size(), 0);
  for (const trails::Identity& crumb : crumbs) {
    const auto number = book_.find(crumb);
    if (!number) continue;
    require(from < robots_.size(), "trail witness: a crumb from nobody");
    const int before = hops_of(static_cast<int>(from), *number);
    r.hops[*number] = static_cast<std::uint8_t>(std::min(before + 1, 255));
  }
}

void TrailWitness::start() { schedule_sample(Time()); }

void TrailWitness::schedule_sample(Time at) {
  simulation_.schedule(at, Phase::observe, [this, at] {
    sample();
    if (at == simulation_.end()) return;
    schedule_sample(std::min(at + options_.period, simulation_.end()));
  });
}

void TrailWitness::keep(AgentId agent, const char* name, double value) {
  if (std::find(options_.series.begin(), options_.series.end(), name) == options_.series.end()) {
    return;
  }
  Record& record = simulation_.record();
  record.series(simulation_.now(), agent, record.name(""), record.name(name), value);
}

void TrailWitness::sample() {
  last_sample_ = simulation_.now();
  for (const Robot& robot : robots_) {
    const AgentId agent = robot.agent;
    const drive::Pose& pose = world_.pose(robot.robot);
    if (wanted_.pose) {
      keep(agent, "robot_x_m", pose.x_m);
      keep(agent, "robot_y_m", pose.y_m);
      keep(agent, "robot_heading_rad", pose.heading_rad);
    }
    if (wanted_.trips) keep(agent, "trips_so_far", static_cast<double>(robot.trips.size()));
    if (wanted_.crumbs) {
      keep(agent, "crumbs_alive", static_cast<double>(robot.mind->crumbs_known()));
    }
    if (wanted_.error || wanted_.hops) sample_crumbs(robot);
  }
  if (wanted_.trips) {
    keep(central_agent, "trips_so_far", static_cast<double>(team_trips_.size()));
  }
  if (wanted_.trips_an_hour) {
    const double now_s = (simulation_.now() - Time()).seconds();
    const double span_s = std::min(window_s, now_s);
    const auto since = std::upper_bound(team_trips_.begin(), team_trips_.end(),
                                        Time::at(Duration::seconds(now_s - span_s)));
    const auto trips = static_cast<double>(team_trips_.end() - since);
    keep(central_agent, "trips_an_hour", span_s > 0.0 ? trips * 3600.0 / span_s : none);
  }
}

void TrailWitness::sample_crumbs(const Robot& robot) {
  const drive::Pose& true_pose = world_.pose(robot.robot);
  const drive::Pose believed = robot.mind->believed_pose();
  double squares_m2 = 0.0, hops = 0.0;
  std::size_t crumbs = 0, wrong = 0, heard = 0;
  robot.mind->each_crumb([&](const trails::Crumb& crumb) {
    const auto number = book_.find(crumb.identity);
    if (!number) return;
    // Where it is from here, truly and as the robot has it.
    const plan::Point& laid = truth_[*number];
    const drive::Pose is = drive::relative_to(true_pose, {laid.x_m, laid.y_m, 0.0});
    const drive::Pose seems =
        drive::relative_to(believed, {crumb.position.x_m, crumb.position.y_m, 0.0});
    const double dx = seems.x_m - is.x_m, dy = seems.y_m - is.y_m;
    const double square_m2 = dx * dx + dy * dy;
    squares_m2 += square_m2;
    ++crumbs;
    if (square_m2 > options_.wrong_m * options_.wrong_m) ++wrong;
    const std::uint8_t way = hops_of(robot.robot, *number);
    if (way > 0) hops += way, ++heard;
  });
  const auto mean = [](double sum, std::size_t n) {
    return n == 0 ? none : sum / static_cast<double>(n);
  };
  const AgentId agent = robot.agent;
  keep(agent, "crumb_error_m", std::sqrt(mean(squares_m2, crumbs)));
  keep(agent, "crumbs_wrong_share", mean(static_cast<double>(wrong), crumbs));
  keep(agent, "hearsay_hops_mean", mean(hops, heard));
}

void TrailWitness::leave(const Robot& robot) {
  Record& record = simulation_.record();
  const AgentId agent = robot.agent;
  const auto scalar = [&](const char* name, double value) {
    record.scalar(agent, record.name(name), value);
  };
  double whole_s = 0.0, length_m = 0.0, duration_s = 0.0;
  for (const double spent_s : robot.spent_s) whole_s += spent_s;
  for (const Trip& trip : robot.trips) length_m += trip.length_m, duration_s += trip.duration_s;
  const auto trips = static_cast<double>(robot.trips.size());
  scalar("trips", trips);
  scalar("distance_driven_m", robot.distance_m);
  scalar("trip_length_mean_m", trips > 0.0 ? length_m / trips : none);
  scalar("trip_time_mean_s", trips > 0.0 ? duration_s / trips : none);
  scalar("first_arrival_s",
         robot.first_arrival ? (*robot.first_arrival - Time()).seconds() : never);
  const auto share = [&](Doing doing) {
    return robot.spent_s[static_cast<std::size_t>(doing)] / whole_s;
  };
  scalar("time_following_share", share(Doing::following));
  scalar("time_exploring_share", share(Doing::exploring) + share(Doing::searching));
  scalar("time_panicking_share", share(Doing::panicking));
  scalar("blocked_share", robot.blocked_s / whole_s);
  const auto change = world_.changed();
  if (change) scalar("recovery_s", robot.recovered_from == change ? robot.recovery_s : never);
  const trails::TrailCounts counts = robot.mind->crumbs_counted();
  scalar("crumbs_taken", static_cast<double>(counts.taken));
  scalar("crumbs_known", static_cast<double>(counts.known));
  scalar("crumbs_late", static_cast<double>(counts.late));
  scalar("crumbs_no_room", static_cast<double>(counts.no_room + counts.dropped));
  scalar("crumbs_refused", static_cast<double>(counts.refused));
  if (!wanted_.trip_length && !wanted_.trip_duration) return;
  const std::uint64_t last = std::min<std::uint64_t>(robot.trips.size(), iterations_max);
  for (std::uint64_t i = 0; i < last; ++i) {
    const NameId subject = record.name(std::to_string(i + 1));
    const Trip& trip = robot.trips[i];
    const auto series = [&](const char* name, double value) {
      record.series(simulation_.now(), agent, subject, record.name(name), value);
    };
    if (wanted_.trip_length) series("trip_length_m", trip.length_m);
    if (wanted_.trip_duration) series("trip_duration_s", trip.duration_s);
  }
}

void TrailWitness::leave_team() {
  Record& record = simulation_.record();
  const auto scalar = [&](const char* name, double value) {
    record.scalar(central_agent, record.name(name), value);
  };
  double distance_m = 0.0, duration_s = 0.0, length_m = 0.0;
  std::vector<double> arrivals, recoveries;
  const auto change = world_.changed();
  for (const Robot& robot : robots_) {
    distance_m += robot.distance_m;
    for (const Trip& trip : robot.trips) duration_s += trip.duration_s, length_m += trip.length_m;
    arrivals.push_back(robot.first_arrival ? (*robot.first_arrival - Time()).seconds() : never);
    recoveries.push_back(robot.recovered_from == change ? robot.recovery_s : never);
  }
  const auto trips = static_cast<double>(team_trips_.size());
  scalar("trips", trips);
  scalar("distance_driven_m", distance_m);
  scalar("trip_length_mean_m", trips > 0.0 ? length_m / trips : none);
  scalar("trip_time_mean_s", trips > 0.0 ? duration_s / trips : none);
  scalar("first_arrival_s",
         arrivals.empty() ? none : *std::min_element(arrivals.begin(), arrivals.end()));
  if (change) scalar("recovery_s", median(recoveries));
}

void TrailWitness::finish() {
  if (last_sample_ != simulation_.now()) sample();
  for (const Robot& robot : robots_) leave(robot);
  leave_team();
}

}  // namespace hearsay
