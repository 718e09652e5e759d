#include "agents/trails/trail_witness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

using Doing = TrailWitness::Doing;
constexpr double never = std::numeric_limits<double>::infinity();

/// What a robot knows, made by hand.
class Mind final : public TrailMind {
 public:
  Mind(const trails::MetricStore& store, std::function<drive::Pose()> believed)
      : store_(store), believed_(std::move(believed)) {}
  std::size_t crumbs_known() const override { return store_.size(); }
  trails::TrailCounts crumbs_counted() const override { return store_.counts(); }
  void each_crumb(const std::function<void(const trails::Crumb&)>& look) const override {
    store_.for_each(look);
  }
  drive::Pose believed_pose() const override { return believed_(); }

 private:
  const trails::MetricStore& store_;
  std::function<drive::Pose()> believed_;
};

/// Robots on an empty floor whose ways, thoughts and talks are made by hand.
class TrailsWatched : public testing::Test {
 protected:
  TrailsWatched() : simulation_({.end = Time::at(100_s)}) {}

  void watch(int robots, TrailWitness::Options options,
             std::vector<RobotWorld::Barrier> barriers = {}) {
    world_ = std::make_unique<RobotWorld>(
        simulation_,
        RobotWorld::Options{
            .plan = std::make_shared<const plan::Plan>(50.0, 50.0, std::vector<plan::Segment>()),
            .barriers = std::move(barriers),
            .sources = {{.name = "A", .at = {5.0, 5.0}, .units = {}, .moves = {}},
                        {.name = "B", .at = {9.0, 5.0}, .units = {}, .moves = {}}},
            .floor = {}});
    if (options.period == Duration()) options.period = 25_s;
    witness_ = std::make_unique<TrailWitness>(simulation_, *world_, options);
    for (int robot = 0; robot < robots; ++robot) {
      const Stream draws(1, Purpose("start"), Entity::agent(robot));
      world_->add({.at = plan::Point{5.0, 2.0 + 2.0 * robot}, .heading_rad = 0.0}, draws);
      stores_.emplace_back(trails::StoreOptions{.robot = static_cast<trails::RobotId>(robot)});
      // Agents are numbered otherwise than robots.
      minds_.emplace_back(stores_.back(), [this, robot] { return believed_.at(robot); });
      witness_->watch(10 + robot, robot, minds_.back());
      believed_[robot] = world_->pose(robot);
    }
  }
  void at(double time_s, std::function<void()> what) {
    simulation_.schedule(Time::at(Duration::seconds(time_s)), Phase::act, std::move(what));
  }
  void carry(int robot, double x_m, double y_m, double heading_rad) {
    const Stream draws(1, Purpose("carry"), Entity::agent(robot));
    ASSERT_TRUE(
        world_->carry(robot, {.at = plan::Point{x_m, y_m}, .heading_rad = heading_rad}, draws));
  }
  /// The robot lays a crumb where it is, which it takes for `there`, and tells of it.
  trails::Crumb lay(int robot, std::uint32_t number, const trails::Point& there) {
    const trails::Crumb crumb{.event = 0,
                              .goal = trails::no_event,
                              .position = there,
                              .distance_s = 7.5F,
                              .created_s = simulation_.now().seconds(),
                              .identity = {static_cast<trails::RobotId>(robot), 0, number}};
    witness_->dropped(robot);
    witness_->told(robot, {&crumb, 1});
    merge(robot, crumb);
    return crumb;
  }
  void merge(int robot, const trails::Crumb& crumb) {
    stores_[static_cast<std::size_t>(robot)].merge(crumb, simulation_.now().seconds());
  }
  void run() {
    world_->start();
    witness_->start();
    const RunEnd end = simulation_.run();
    EXPECT_TRUE(end.ok()) << end.message;
    witness_->finish();
  }

  double scalar(AgentId agent, const std::string& name) const {
    for (const ScalarRow& row : simulation_.record().scalars()) {
      if (row.agent == agent && simulation_.record().text(row.name) == name) return row.value;
    }
    ADD_FAILURE() << "no " << name << " of " << agent;
    return -1.0;
  }
  bool has_scalar(AgentId agent, const std::string& name) const {
    for (const ScalarRow& row : simulation_.record().scalars()) {
      if (row.agent == agent && simulation_.record().text(row.name) == name) return true;
    }
    return false;
  }
  /// By time in seconds.
  std::map<double, double> series(AgentId agent, const std::string& name) const {
    std::map<double, double> values;
    for (const SeriesRow& row : simulation_.record().series()) {
      if (row.agent == agent && simulation_.record().text(row.name) == name) {
        values[row.time.seconds()] = row.value;
      }
    }
    return values;
  }
  /// By subject.
  std::map<std::string, double> by_trip(AgentId agent, const std::string& name) const {
    std::map<std::string, double> values;
    for (const SeriesRow& row : simulation_.record().series()) {
      if (row.agent != agent || simulation_.record().text(row.name) != name) continue;
      EXPECT_EQ(row.time, Time::at(100_s));
      values[simulation_.record().text(row.subject)] = row.value;
    }
    return values;
  }
  std::vector<std::string> events(const std::string& kind) const {
    std::vector<std::string> rows;
    for (const EventRow& row : simulation_.record().events()) {
      if (simulation_.record().text(row.kind) != kind) continue;
      rows.push_back(std::to_string(row.agent) + " " + row.detail);
    }
    return rows;
  }

  Simulation simulation_;
  std::unique_ptr<RobotWorld> world_;
  std::unique_ptr<TrailWitness> witness_;
  std::deque<trails::MetricStore> stores_;
  std::deque<Mind> minds_;
  std::map<int, drive::Pose> believed_;
};

TEST_F(TrailsWatched, TripsHaveTheLengthsAndTimesThatWereDriven) {
  watch(2, {.series = {"trips_so_far", "trip_length_m", "trip_duration_s"}});
  at(5, [&] {
    witness_->drove(0, 3.0, false, Doing::exploring, 5.0);
    EXPECT_FALSE(witness_->arrived(0, 0)) << "not set off: no trip";
    EXPECT_FALSE(witness_->all_arrived());
    witness_->sets_off(0);
  });
  at(30, [&] {
    witness_->drove(0, 4.0, true, Doing::following, 10.0);
    witness_->drove(0, 1.5, false, Doing::searching, 15.0);
    EXPECT_TRUE(witness_->arrived(0, 1));
    EXPECT_FALSE(witness_->arrived(0, 1)) << "the trip is over";
    witness_->sets_off(0);
  });
  at(40, [&] { witness_->sets_off(1); });
  at(50, [&] {
    witness_->drove(0, 2.0, false, Doing::panicking, 12.0);
    witness_->drove(0, 0.0, true, Doing::waiting, 8.0);
    witness_->arrived(0, 0);
    EXPECT_FALSE(witness_->all_arrived());
    witness_->sets_off(0);
  });
  at(80, [&] {
    witness_->drove(1, 8.0, false, Doing::following, 40.0);
    witness_->arrived(1, 1);
    EXPECT_TRUE(witness_->all_arrived());
    witness_->drove(0, 6.0, false, Doing::following, 30.0);
  });
  run();

  EXPECT_EQ(by_trip(10, "trip_length_m"), (std::map<std::string, double>{{"1", 5.5}, {"2", 2.0}}));
  EXPECT_EQ(by_trip(10, "trip_duration_s"),
            (std::map<std::string, double>{{"1", 25.}, {"2", 20.}}));
  EXPECT_EQ(by_trip(11, "trip_length_m"), (std::map<std::string, double>{{"1", 8.0}}));
  EXPECT_EQ(scalar(10, "trips"), 2.0);
  EXPECT_EQ(scalar(10, "distance_driven_m"), 16.5);
  EXPECT_EQ(scalar(10, "trip_length_mean_m"), 3.75);
  EXPECT_EQ(scalar(10, "trip_time_mean_s"), 22.5);
  EXPECT_EQ(scalar(10, "first_arrival_s"), 30.0);
  EXPECT_EQ(scalar(10, "time_following_share"), 40.0 / 80.0);
  EXPECT_EQ(scalar(10, "time_exploring_share"), 20.0 / 80.0) << "or searching";
  EXPECT_EQ(scalar(10, "time_panicking_share"), 12.0 / 80.0);
  EXPECT_EQ(scalar(10, "blocked_share"), 18.0 / 80.0);
  EXPECT_EQ(scalar(central_agent, "trips"), 3.0);
  EXPECT_EQ(scalar(central_agent, "distance_driven_m"), 24.5);
  EXPECT_EQ(scalar(central_agent, "trip_length_mean_m"), 15.5 / 3.0);
  EXPECT_EQ(scalar(central_agent, "trip_time_mean_s"), 85.0 / 3.0);
  EXPECT_EQ(scalar(central_agent, "first_arrival_s"), 30.0);
  EXPECT_FALSE(has_scalar(10, "recovery_s")) << "nothing changed";
  const std::map<double, double> so_far = {{0, 0}, {25, 0}, {50, 2}, {75, 2}, {100, 2}};
  EXPECT_EQ(series(10, "trips_so_far"), so_far) << "samples are the last of their instant";
  EXPECT_EQ(series(central_agent, "trips_so_far").at(100.0), 3.0);
  EXPECT_EQ(events("arrived"),
            (std::vector<std::string>{"10 B 1 5.500000 25.000000", "10 A 2 2.000000 20.000000",
                                      "11 B 1 8.000000 40.000000"}));
}

TEST_F(TrailsWatched, WhoNeverArrivesHasNoTrips) {
  watch(1, {});
  at(1, [&] { witness_->sets_off(0); });
  run();
  EXPECT_EQ(scalar(10, "trips"), 0.0);
  EXPECT_EQ(scalar(10, "first_arrival_s"), never);
  EXPECT_TRUE(std::isnan(scalar(10, "trip_length_mean_m")));
  EXPECT_TRUE(std::isnan(scalar(central_agent, "trip_time_mean_s")));
  EXPECT_EQ(scalar(central_agent, "first_arrival_s"), never);
  EXPECT_TRUE(simulation_.record().series().empty()) << "none was asked for";
}

TEST_F(TrailsWatched, PosesAreTheTrueOnes) {
  watch(2, {.series = {"robot_x_m", "robot_y_m", "robot_heading_rad"}});
  at(30, [&] { carry(1, 20.5, 30.25, -1.5); });
  run();
  EXPECT_EQ(series(11, "robot_x_m").at(25.0), 5.0);
  EXPECT_EQ(series(11, "robot_x_m").at(50.0), 20.5);
  EXPECT_EQ(series(11, "robot_y_m").at(50.0), 30.25);
  EXPECT_EQ(series(11, "robot_heading_rad").at(50.0), -1.5);
  EXPECT_EQ(series(10, "robot_y_m").at(100.0), 2.0);
}

// A crumb at distance d from a robot that is wrong by an angle seems to be off by the chord.
TEST_F(TrailsWatched, ARobotThatIsTurnedByAnAngleFindsCrumbsOffByTheChord) {
  const double heading = 2.9, theta = 0.4;
  const std::vector<plan::Point> places = {{10.0, 12.0}, {20.0, 8.0}, {31.0, 40.0}};
  const plan::Point here{10.0, 10.0};
  const double chord = 2.0 * math::sin(0.5 * theta);
  std::vector<double> errors;
  for (const plan::Point& p : places) {
    errors.push_back(chord * math::hypot(p.x_m - here.x_m, p.y_m - here.y_m));
  }
  watch(1, {.series = {"crumb_error_m", "crumbs_wrong_share", "crumbs_alive"},
            .wrong_m = 0.5 * (errors[0] + errors[1])});
  at(10, [&] {
    for (std::uint32_t i = 0; i < 3; ++i) {
      carry(0, places[i].x_m, places[i].y_m, 0.1 * i);
      // It is right about the places; its frame is the world's.
      lay(0, i, trails::point(places[i].x_m, places[i].y_m));
    }
    carry(0, here.x_m, here.y_m, heading);
    believed_[0] = {here.x_m, here.y_m, math::wrap_angle(heading + theta)};
  });
  at(40, [&] { believed_[0] = world_->pose(0); });
  at(60, [&] { believed_[0] = {here.x_m - 3.0, here.y_m + 4.0, heading}; });
  run();
  const std::map<double, double> error = series(10, "crumb_error_m");
  double squares = 0.0;
  for (const double e : errors) squares += e * e;
  EXPECT_TRUE(std::isnan(error.at(0.0))) << "no crumbs";
  EXPECT_NEAR(error.at(25.0), std::sqrt(squares / 3.0), 1e-5);
  EXPECT_NEAR(error.at(50.0), 0.0, 1e-5);
  EXPECT_NEAR(error.at(75.0), 5.0, 1e-5) << "moved aside: for all crumbs the same";
  EXPECT_NEAR(series(10, "crumbs_wrong_share").at(25.0), 2.0 / 3.0, 1e-12);
  EXPECT_EQ(series(10, "crumbs_wrong_share").at(50.0), 0.0);
  EXPECT_EQ(series(10, "crumbs_alive"),
            (std::map<double, double>{{0, 0}, {25, 3}, {50, 3}, {75, 3}, {100, 3}}));
}

TEST_F(TrailsWatched, AFrameOfItsOwnIsNoError) {
  watch(1, {.series = {"crumb_error_m"}});
  const drive::Pose frame{7.0, -3.0, 1.1};  // of its odometry
  at(10, [&] {
    carry(0, 14.0, 22.0, 0.3);
    const drive::Pose there = drive::relative_to(frame, world_->pose(0));
    lay(0, 0, trails::point(there.x_m, there.y_m));
    carry(0, 30.0, 11.0, -2.0);
    believed_[0] = drive::relative_to(frame, world_->pose(0));
  });
  run();
  EXPECT_NEAR(series(10, "crumb_error_m").at(25.0), 0.0, 1e-5);
}

TEST_F(TrailsWatched, HearsayTakesOneHopMoreWithEachRelay) {
  watch(4, {.series = {"hearsay_hops_mean"}});
  at(10, [&] {
    const trails::Crumb crumb = lay(0, 0, {});
    const auto pass = [&](int from, int to) {
      merge(to, crumb);
      witness_->learned(to, static_cast<trails::RobotId>(from), {&crumb.identity, 1});
    };
    pass(0, 1);
    pass(1, 2);
    pass(2, 3);
  });
  at(30, [&] {
    // A second one, straight to the last: a mean of 3 and 1.
    const trails::Crumb crumb = lay(0, 1, {});
    merge(3, crumb);
    witness_->learned(3, 0, {&crumb.identity, 1});
  });
  run();
  EXPECT_TRUE(std::isnan(series(10, "hearsay_hops_mean").at(25.0))) << "it heard none";
  for (const int hops : {1, 2, 3}) {
    EXPECT_EQ(series(10 + hops, "hearsay_hops_mean").at(25.0), hops);
  }
  EXPECT_EQ(series(13, "hearsay_hops_mean").at(50.0), 2.0);
}

TEST_F(TrailsWatched, CrumbsAreEventsWhereTheyWereTrulyLaid) {
  watch(1, {.crumbs = true});
  at(10, [&] {
    carry(0, 14.0, 22.5, 0.25);
    lay(0, 0, {100.0F, 200.0F});
    witness_->dropped(0);
    witness_->gave_up(0);
    EXPECT_NO_THROW(witness_->told(0, {})) << "what was given up is not told";
    witness_->dropped(0);
    EXPECT_THROW(witness_->told(0, {}), BrokenInvariant);
  });
  run();
  EXPECT_EQ(events("crumb"),
            std::vector<std::string>{"10 A 14.000000 22.500000 0.250000 7.500000"});
}

TEST_F(TrailsWatched, RecoveryIsTheFirstTripThatBeganAfterTheLastChange) {
  // Up at 10 s: who was on the way then has not recovered by arriving.
  watch(4, {}, {{.area = {{40.0, 40.0}, {41.0, 41.0}}, .from = Time::at(10_s)}});
  const auto trip = [&](int robot, double from_s, double to_s) {
    at(from_s, [this, robot] { witness_->sets_off(robot); });
    at(to_s, [this, robot] { witness_->arrived(robot, 0); });
  };
  trip(0, 5, 12);
  trip(0, 12, 31);
  trip(0, 31, 33);
  trip(1, 9, 60);
  trip(2, 20, 41);
  trip(3, 15, 28);
  run();
  EXPECT_EQ(scalar(10, "recovery_s"), 21.0);
  EXPECT_EQ(scalar(11, "recovery_s"), never);
  EXPECT_EQ(scalar(12, "recovery_s"), 31.0);
  EXPECT_EQ(scalar(13, "recovery_s"), 18.0);
  EXPECT_EQ(scalar(central_agent, "recovery_s"), 21.0) << "half of the robots have";
}

TEST_F(TrailsWatched, AnotherChangeIsToBeRecoveredFromAnew) {
  watch(2, {},
        {{.area = {{40.0, 40.0}, {41.0, 41.0}}, .from = Time::at(10_s), .until = Time::at(50_s)}});
  const auto trip = [&](int robot, double from_s, double to_s) {
    at(from_s, [this, robot] { witness_->sets_off(robot); });
    at(to_s, [this, robot] { witness_->arrived(robot, 0); });
  };
  trip(0, 20, 40);
  trip(1, 20, 40);
  trip(1, 55, 62);
  run();
  EXPECT_EQ(scalar(10, "recovery_s"), never);
  EXPECT_EQ(scalar(11, "recovery_s"), 12.0);
}

TEST(TrailWitness, TripsAnHourAreThoseOfTheLastTenMinutes) {
  Simulation simulation({.end = Time::at(2000_s)});
  RobotWorld world(
      simulation,
      {.plan = std::make_shared<const plan::Plan>(9.0, 9.0, std::vector<plan::Segment>()),
       .barriers = {},
       .sources = {{.name = "A", .at = {5.0, 5.0}, .units = {}, .moves = {}}},
       .floor = {}});
  TrailWitness witness(simulation, world, {.period = 100_s, .series = {"trips_an_hour"}});
  world.add({}, Stream(1, Purpose("start"), Entity::agent(0)));
  trails::MetricStore store({});
  const Mind mind(store, [] { return drive::Pose(); });
  witness.watch(0, 0, mind);
  std::vector<std::int64_t> arrivals;
  Stream draws(3, Purpose("arrivals"), Entity::agent(0));
  for (std::int64_t s = 7; s < 2000; s += 1 + static_cast<std::int64_t>(draws.below(90))) {
    arrivals.push_back(s);
    simulation.schedule(Time::at(1_s * s), Phase::act, [&] {
      witness.sets_off(0);
      witness.arrived(0, 0);
    });
  }
  witness.start();
  EXPECT_TRUE(simulation.run().ok());
  std::size_t samples = 0;
  for (const SeriesRow& row : simulation.record().series()) {
    ASSERT_EQ(row.agent, central_agent);
    ++samples;
    const double now = row.time.seconds(), span = std::fmin(now, 600.0);
    int trips = 0;
    for (const std::int64_t s : arrivals) trips += s <= now && s > now - 600.0;
    if (now == 0.0) {
      EXPECT_TRUE(std::isnan(row.value));
    } else {
      EXPECT_NEAR(row.value, trips * 3600.0 / span, 1e-9) << now;
    }
  }
  EXPECT_EQ(samples, 21U);
}

}  // namespace
}  // namespace hearsay
