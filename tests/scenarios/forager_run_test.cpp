// Whole runs of foragers, from their files: how long their ways are, and that they get shorter.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/math/functions.hpp"
#include "tests/scenarios/forager_bed.hpp"

namespace hearsay {
namespace {

constexpr double speed_m_per_s = 0.25, radius_m = 0.25, margin_m = 0.12;

/// One robot with perfect odometry, who hears nobody.
const std::string lone = R"(duration_s = 700
[world.plan]
file = "plan.txt"
[radio]
topology = "full"
rate_bps = 1_000_000
[record]
series_period_s = 5
[[agents]]
kind = "forager"
robot = { start = "A", scatter_m = 0.5, speed_m_per_s = 0.25, turn_rad_per_s = 1.0, rays = 90 }
task = { events = ["A", "B"] }
trails = { navigation = "map", exploration = "corridor" }
talk = { policy = "never" }
)";

class ForagerRun : public ForagerBed {
 protected:
  /// A floor of the room.
  static std::string shipped(const std::string& text, const std::string& name) {
    return with(text, "plan.txt", HEARSAY_SOURCE_DIR "/scenarios/lost/plans/" + name + ".txt");
  }
  /// All but the first of a robot.
  static std::vector<double> later(std::vector<double> trips) {
    if (!trips.empty()) trips.erase(trips.begin());
    return trips;
  }
  void SetUp() override {
    ForagerBed::SetUp();
    series_ = {"trip_length_m", "trip_duration_s"};
  }
};

/// From A to B through the corridor of the room for a disc, as a taut string: around the corner at
/// the left of the way (19 m, 4.5 m), across, around the one at its right (22 m, 13.5 m).
double taut_m(double disc_m) {
  struct P {
    double x, y;
  };
  const P a{10.75, 2.75}, left{19.0, 4.5}, right{22.0, 13.5}, b{30.25, 15.25};
  const auto length = [](P p, P q) { return math::hypot(q.x - p.x, q.y - p.y); };
  const auto angle = [](P p, P q) { return math::atan2(q.y - p.y, q.x - p.x); };
  const double r = disc_m, d1 = length(a, left), d = length(left, right), d2 = length(right, b);
  const double first = angle(a, left) - math::asin(r / d1);
  const double middle = angle(left, right) + math::asin(2.0 * r / d);
  const double last = angle(right, b) - math::asin(r / d2);
  return std::sqrt(d1 * d1 - r * r) + r * (middle - first) + std::sqrt(d * d - 4.0 * r * r) +
         r * (middle - last) + std::sqrt(d2 * d2 - r * r);
}

// An event happens 1 m from its place. It is noticed at a tick, up to 2.5 cm later, at both ends of
// a trip. Where it turns around a robot stands until it is off by 1.2 rad, so π − 1.2 s, and has
// lost no more than π s, as if it had stood until it was all around.
TEST_F(ForagerRun, WhoHasTheMapNeedsTheTimeOfAStraightWay) {
  write("plan.txt", straight_corridor(40, 2));
  const Values values = run(lone);
  const double way_m = 17.5 - 2.0;
  const std::vector<double> lengths = later(values.by_trip(0, "trip_length_m"));
  const std::vector<double> durations = later(values.by_trip(0, "trip_duration_s"));
  ASSERT_GE(lengths.size(), 8U);
  for (const double length : lengths) {
    EXPECT_GE(length, way_m - 1e-6);
    EXPECT_LE(length, way_m + 0.05 + 0.05) << "and a little arc";
  }
  for (const double duration : durations) {
    EXPECT_GE(duration, way_m / speed_m_per_s + math::pi - 1.2 - 1e-6);
    EXPECT_LE(duration, (way_m + 0.1) / speed_m_per_s + math::pi + 0.1);
  }
  EXPECT_EQ(values.scalar(0, "time_exploring_share"), 0.0);
  EXPECT_EQ(values.scalar(0, "crumbs_laid"), 0.0);
  EXPECT_EQ(values.scalar(0, "trips"), values.scalar(central_agent, "trips"));
}

TEST_F(ForagerRun, WhoHasTheMapGoesRoundCornersAsATautString) {
  const double least_m = taut_m(radius_m) - 2.0;
  // It keeps a margin at corners; and there are the ticks.
  const double most_m = taut_m(radius_m + margin_m) - 2.0 + 0.1;
  EXPECT_NEAR(taut_m(0.3), 27.0, 0.05) << "as the page about the plans has it";
  const Values values = run(shipped(lone, "corridor"));
  const std::vector<double> lengths = later(values.by_trip(0, "trip_length_m"));
  const std::vector<double> durations = later(values.by_trip(0, "trip_duration_s"));
  ASSERT_GE(lengths.size(), 4U);
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_GE(lengths[i], least_m);
    EXPECT_LE(lengths[i], most_m);
    // At each of two corners it slows down; nowhere else.
    EXPECT_GE(durations[i], least_m / speed_m_per_s + math::pi - 1.2);
    EXPECT_LE(durations[i], most_m / speed_m_per_s + math::pi + 0.1 + 2.0 * 0.5);
  }
}

// The first trip is a search; the way back is the way it came, less the detours that a sense radius
// of 1 m cuts off; none is much longer than the one before.
TEST_F(ForagerRun, ALoneRobotFollowsItsOwnTrailAndCutsCorners) {
  // However long it searches, what it laid then is there on the way back.
  const std::string trails =
      with(shipped(lone, "corridor"), "\"map\"", "\"trails\", age_max_s = 2000");
  const double least_m = taut_m(radius_m) - 2.0;
  const Values values = run(with(trails, "duration_s = 700", "duration_s = 1300"));
  const std::vector<double> lengths = values.by_trip(0, "trip_length_m");
  ASSERT_GE(lengths.size(), 5U);
  EXPECT_GE(lengths.front(), least_m);
  for (std::size_t i = 1; i < lengths.size(); ++i) {
    EXPECT_GE(lengths[i], least_m);
    EXPECT_LE(lengths[i], 1.1 * least_m);
    EXPECT_LE(lengths[i], lengths[i - 1] + 0.5);
  }
  EXPECT_LE(lengths.back(), least_m + 1.5);
  EXPECT_GT(values.scalar(0, "time_following_share"), 0.4);
  // Without trails it searches each time.
  const Values searching = run(with(shipped(lone, "corridor"), "\"map\"", "\"explore\""));
  EXPECT_GT(searching.scalar(0, "trip_length_mean_m"), 1.2 * least_m);
  EXPECT_EQ(searching.scalar(0, "time_following_share"), 0.0);
}

TEST_F(ForagerRun, WithPerfectOdometryCrumbsAreWhereTheyWereLaid) {
  series_ = {"crumb_error_m", "crumbs_wrong_share", "crumbs_alive"};
  write("plan.txt", straight_corridor(40, 8));
  const std::string trails = with(lone, "\"map\"", "\"trails\"");
  const std::string respawned = with(with(trails, "[\"A\", \"B\"]", "[\"B\"], respawn = true"),
                                     "\"trails\",", "\"trails\", laying = \"completed\",");
  for (const std::string& text : {trails, respawned}) {
    const Values values = run(text);
    double most = 0.0, alive = 0.0;
    for (const auto& [time, error] : values.over_time(0, "crumb_error_m")) {
      if (!std::isnan(error)) most = std::max(most, error);
    }
    for (const auto& [time, crumbs] : values.over_time(0, "crumbs_alive")) {
      alive = std::max(alive, crumbs);
    }
    EXPECT_LT(most, 1e-4);
    EXPECT_GT(alive, 20.0);
    EXPECT_GE(values.scalar(0, "trips"), 3.0);
  }
}

/// A team whose members begin in frames of their own.
std::string team(int robots) {
  return with(with(with(lone, "\"map\"", "\"trails\""), "\"never\"", "\"at-once\""),
              "kind = \"forager\"\n",
              "kind = \"forager\"\ncount = " + std::to_string(robots) + "\n");
}

TEST_F(ForagerRun, TwoRobotsConvergeToShortTrips) {
  series_.push_back("hearsay_hops_mean");
  const double least_m = taut_m(radius_m) - 2.0;
  const Values values =
      run(with(shipped(team(2), "corridor"), "duration_s = 700", "duration_s = 1500"));
  for (const AgentId id : {0, 1}) {
    const std::vector<double> lengths = values.by_trip(id, "trip_length_m");
    ASSERT_GE(lengths.size(), 6U) << id;
    for (std::size_t i = lengths.size() - 3; i < lengths.size(); ++i) {
      EXPECT_GE(lengths[i], least_m) << id;
      EXPECT_LE(lengths[i], 1.1 * least_m) << id;
    }
    EXPECT_GT(values.scalar(id, "crumbs_taken"), 100.0);
    EXPECT_GT(values.scalar(id, "messages_no_frame"), 0.0) << "at first they have no two places";
    EXPECT_EQ(values.over_time(id, "hearsay_hops_mean").rbegin()->second, 1.0);
  }
}

TEST_F(ForagerRun, OneSeedGivesOneRun) {
  const std::string text =
      with(shipped(team(3), "corridor"), "duration_s = 700", "duration_s = 150");
  const std::string once = run(text, 5).digested, again = run(text, 5).digested;
  EXPECT_TRUE(once == again);
  EXPECT_FALSE(once == run(text, 6).digested);
}

TEST_F(ForagerRun, TrailsOfEveryKindBringRobotsTogether) {
  write("plan.txt", straight_corridor(40, 8));
  for (const std::string kind :
       {"parameters = \"thesis-2019-text\", trail_end = \"search\", age_max_s = 600",
        "parameters = \"thesis-2019-code\", trail_end = \"search\", trail_end_s = 1.5",
        "lanes = \"so-lost\"", "lanes = \"highway\"", "field_rad = 2.0", "relay = true",
        "transform = \"optimistic\"", "transform = \"as-is\""}) {
    const std::string laid =
        with(with(team(2), "exploration", kind + ", exploration"), "rays = 90",
             kind.ends_with("\"as-is\"") ? "rays = 90, frame = \"shared\"" : "rays = 90");
    const Values values = run(with(laid, "at-once", kind[0] == 'p' ? "at-event" : "at-once"));
    EXPECT_GE(values.scalar(central_agent, "trips"), 8.0) << kind;
    for (const AgentId id : {0, 1}) {
      EXPECT_GT(values.scalar(id, "time_following_share"), 0.3) << kind << id;
      EXPECT_GT(values.scalar(id, "crumbs_taken"), values.scalar(id, "crumbs_laid")) << kind << id;
    }
  }
}

// A robot in blinkers stands on a crumb and sees none that leads on: those are behind it.
TEST_F(ForagerRun, NobodyStaysForEverOnACrumbThatLeadsNowhere) {
  series_ = {"robot_x_m", "robot_y_m"};
  write("plan.txt", straight_corridor(40, 8));
  const std::string dense = with(team(2), "series_period_s = 5", "series_period_s = 1");
  const std::string blinkered = with(dense, "exploration", "field_rad = 2.0, exploration");
  double panicking = 0.0;
  for (const std::uint64_t seed : {4, 5, 6, 7}) {
    const Values values = run(blinkered, seed);
    for (const AgentId id : {0, 1}) {
      const auto x_m = values.over_time(id, "robot_x_m"), y_m = values.over_time(id, "robot_y_m");
      double still_s = 0.0, longest_s = 0.0;
      for (double time = 1.0; time <= 700.0; time += 1.0) {
        const double dx = x_m.at(time) - x_m.at(time - 1.0), dy = y_m.at(time) - y_m.at(time - 1.0);
        still_s = math::hypot(dx, dy) < 0.01 ? still_s + 1.0 : 0.0;
        longest_s = std::max(longest_s, still_s);
      }
      // 2 s until it panics; then it may turn around before it drives.
      EXPECT_LE(longest_s, 10.0) << id;
      panicking += values.scalar(id, "time_panicking_share");
    }
    EXPECT_GE(values.scalar(central_agent, "trips"), 12.0);
  }
  EXPECT_GT(panicking, 0.0) << "nobody came to such a crumb";
}

// Shamshirdar 2019, figure 4.5: the last crumb was dropped on the way to the event, before it
// happened; who stays there does not come to it.
TEST_F(ForagerRun, WithoutSearchARobotStaysOnTheLastCrumbOfATrail) {
  write("plan.txt", straight_corridor(40, 8));
  const std::string thesis =
      with(with(lone, "\"map\"", "\"trails\""), "exploration",
           R"(parameters = "thesis-2019-text", trail_end = "END", exploration)");
  const Values stuck = run(with(thesis, "END", "none")),
               searching = run(with(thesis, "END", "search"));
  EXPECT_LE(stuck.scalar(0, "trips"), 4.0);
  EXPECT_GE(searching.scalar(0, "trips"), 10.0);
}

TEST_F(ForagerRun, InASharedFrameWhatIsHeardIsRightToo) {
  series_ = {"crumb_error_m"};
  write("plan.txt", straight_corridor(40, 8));
  const std::string shared = with(team(3), "rays = 90", "rays = 90, frame = \"shared\"");
  const Values values = run(with(shared, "exploration", "transform = \"as-is\", exploration"));
  for (const AgentId id : {0, 1, 2}) {
    for (const auto& [time, error] : values.over_time(id, "crumb_error_m")) {
      EXPECT_TRUE(std::isnan(error) || error < 1e-4) << time;
    }
    EXPECT_GT(values.scalar(id, "crumbs_heard"), 100.0);
  }
}

}  // namespace
}  // namespace hearsay
