// agents.motion: what files may say, what they may not, and what becomes of it.
#include "scenarios/motion_spec.hpp"

#include <gtest/gtest.h>

#include "scenarios/motion.hpp"
#include "temp_files.hpp"

namespace hearsay {
namespace {

using Points = std::vector<std::array<double, 2>>;

class MotionSpecs : public InTempDirectory {
 protected:
  static Scenario load(const std::string& agents, const std::vector<std::string>& set = {}) {
    write("s.toml", "duration_s = 9\n" + agents);
    return load_scenario("s.toml", sets(set), {});
  }
  static Scenario with(const std::string& motion) {
    return load("[[agents]]\nmotion = { " + motion + " }\n");
  }
  static std::string error(const std::string& agents, const std::vector<std::string>& set = {}) {
    return error_of([&] { load(agents, set); });
  }
  static std::string error_with(const std::string& motion) {
    return error_of([&] { with(motion); });
  }
  static std::string track_error(const std::string& rows) {
    write("t.csv", rows);
    return error(
        "[[agents]]\nname = \"uav\"\ncount = 2\nmotion = { kind = \"track\", file = \"t.csv\" }\n");
  }
};

constexpr const char* wander =
    "kind = \"random-waypoint\", area_m = [[0, 0], [100, 50]], speed_min_m_per_s = 1, "
    "speed_max_m_per_s = 2";
constexpr const char* roam =
    "kind = \"gauss-markov\", area_m = [[0, 0], [100, 50]], speed_mean_m_per_s = 5, "
    "speed_sigma_m_per_s = 1, direction_sigma_rad = 0.5, alpha = 0.9";

TEST_F(MotionSpecs, EveryFieldArrives) {
  const auto motion = [](const std::string& text) { return *with(text).agents[0].motion; };
  const MotionSpec tour = motion(
      "kind = \"waypoints\", altitude_m = 30, points_m = [[0, 1], [2.5, -3]], speed_m_per_s = 4, "
      "pause_s = 5, repeat = \"loop\"");
  EXPECT_EQ(tour.kind, "waypoints");
  EXPECT_EQ(tour.altitude_m, 30.0);
  EXPECT_EQ(tour.points_m, (Points{{0.0, 1.0}, {2.5, -3.0}}));
  EXPECT_EQ(tour.speed_m_per_s, 4.0);
  EXPECT_EQ(tour.pause_s, 5.0);
  EXPECT_EQ(tour.repeat, "loop");
  const MotionSpec mower = motion(
      "kind = \"lawn-mower\", area_m = [[9, 8], [-1, 0]], lane_spacing_m = 2, speed_m_per_s = 4");
  EXPECT_EQ(mower.area_m, (Points{{9.0, 8.0}, {-1.0, 0.0}}));
  EXPECT_EQ(mower.lane_spacing_m, 2.0);
  EXPECT_FALSE(mower.repeat);
  const MotionSpec wanderer = motion(wander + std::string(", pause_min_s = 3, pause_max_s = 4"));
  EXPECT_EQ(wanderer.speed_min_m_per_s, 1.0);
  EXPECT_EQ(wanderer.speed_max_m_per_s, 2.0);
  EXPECT_EQ(wanderer.pause_min_s, 3.0);
  EXPECT_EQ(wanderer.pause_max_s, 4.0);
  const MotionSpec roamer =
      motion(roam + std::string(", direction_mean_rad = 0.25, update_period_s = 2"));
  EXPECT_EQ(roamer.speed_mean_m_per_s, 5.0);
  EXPECT_EQ(roamer.speed_sigma_m_per_s, 1.0);
  EXPECT_EQ(roamer.direction_mean_rad, 0.25);
  EXPECT_EQ(roamer.direction_sigma_rad, 0.5);
  EXPECT_EQ(roamer.alpha, 0.9);
  EXPECT_EQ(roamer.update_period_s, 2.0);
  EXPECT_FALSE(load("[[agents]]\n").agents[0].motion);
}

TEST_F(MotionSpecs, CanonicalTextReadsBackAsItself) {
  const std::string text = canonical_text(
      load("[[agents]]\nmotion = { " + std::string(wander) +
           " }\n[[agents]]\nposition_m = [1, 2]\nmotion = { kind = \"waypoints\", points_m = [[0, "
           "1], [0.1, 1e9]], speed_m_per_s = 3 }\n"));
  write("t.toml", text);
  EXPECT_EQ(canonical_text(load_scenario("t.toml", {}, {})), text);
  EXPECT_NE(text.find("points_m = [[0.0, 1.0], [0.1, 1e+09]]"), std::string::npos) << text;
}

TEST_F(MotionSpecs, SetReachesIt) {
  const std::string agents = "[[agents]]\ncount = 2\nmotion = { " + std::string(roam) + " }\n";
  EXPECT_EQ(load(agents, {"agents.motion.alpha=0.5"}).agents[0].motion->alpha, 0.5);
  EXPECT_EQ(error(agents, {"agents.motion.alpha=1.5"}),
            "--set agents.motion.alpha=1.5: agents[0].motion.alpha = 1.5: must be between 0 and 1");
}

TEST_F(MotionSpecs, AHoveringAgentNeedsAPlace) {
  EXPECT_EQ(error_with(""),
            "s.toml:3: agents[0].motion: kind \"hover\" needs to know where: position_m or circle");
  const Scenario s = load("[[agents]]\nposition_m = [3, 4]\nmotion = { altitude_m = 50 }\n");
  EXPECT_EQ(AgentPaths(s, agent_positions(s), 1).next(0, Time()).from_m, (Point{3, 4, 50}));
}

TEST_F(MotionSpecs, KindsNeedTheirKeys) {
  EXPECT_EQ(
      error_with("kind = \"waypoints\", speed_m_per_s = 1"),
      "s.toml:3: agents[0].motion: kind \"waypoints\" needs points_m, as [[0, 0], [100, 50]]");
  EXPECT_EQ(error_with("kind = \"waypoints\", points_m = [[0, 0]]"),
            "s.toml:3: agents[0].motion: kind \"waypoints\" needs speed_m_per_s");
  EXPECT_EQ(error_with("kind = \"lawn-mower\", speed_m_per_s = 1, lane_spacing_m = 1"),
            "s.toml:3: agents[0].motion: kind \"lawn-mower\" needs area_m, as [[0, 0], [100, 50]]");
  EXPECT_EQ(error_with("kind = \"lawn-mower\", speed_m_per_s = 1, area_m = [[0, 0], [1, 1]]"),
            "s.toml:3: agents[0].motion: kind \"lawn-mower\" needs lane_spacing_m");
  EXPECT_EQ(error_with("kind = \"random-waypoint\", area_m = [[0, 0], [1, 1]]"),
            "s.toml:3: agents[0].motion: kind \"random-waypoint\" needs speed_min_m_per_s");
  EXPECT_EQ(error_with("kind = \"gauss-markov\", area_m = [[0, 0], [1, 1]]"),
            "s.toml:3: agents[0].motion: kind \"gauss-markov\" needs speed_mean_m_per_s");
  EXPECT_EQ(error_with("kind = \"track\""),
            "s.toml:3: agents[0].motion: kind \"track\" needs file, a CSV file t_s,agent,x_m,y_m");
}

TEST_F(MotionSpecs, KeysOfOtherKindsAreRefused) {
  EXPECT_EQ(error_with("speed_m_per_s = 1"),
            "s.toml:3: agents[0].motion.speed_m_per_s: only for kind = \"waypoints\" or "
            "\"lawn-mower\"; found \"hover\"");
  EXPECT_EQ(error_with(std::string(wander) + ", alpha = 0.5"),
            "s.toml:3: agents[0].motion.alpha: only for kind = \"gauss-markov\"; found "
            "\"random-waypoint\"");
  EXPECT_EQ(error_with(std::string(wander) + ", pause_s = 1"),
            "s.toml:3: agents[0].motion.pause_s: only for kind = \"waypoints\"; found "
            "\"random-waypoint\"");
  EXPECT_EQ(error_with("kind = \"waypoints\", points_m = [[0, 0]], speed_m_per_s = 1, area_m = "
                       "[[0, 0], [1, 1]]"),
            "s.toml:3: agents[0].motion.area_m: only for kind = \"lawn-mower\", "
            "\"random-waypoint\" or \"gauss-markov\"; found \"waypoints\"");
  EXPECT_EQ(error_with(std::string(roam) + ", file = \"t.csv\""),
            "s.toml:3: agents[0].motion.file: only for kind = \"track\"; found \"gauss-markov\"");
}

TEST_F(MotionSpecs, ValuesOutOfRangeAreRefused) {
  EXPECT_EQ(error_with("kind = \"fly\""),
            "s.toml:3: agents[0].motion.kind = \"fly\": unknown; allowed: hover, waypoints, "
            "lawn-mower, random-waypoint, gauss-markov, track, steered, white-noise-acceleration");
  EXPECT_EQ(error_with("speed = 1"),
            "s.toml:3: unknown key 'speed' in [agents[0].motion]; allowed: kind, altitude_m, "
            "points_m, speed_m_per_s, pause_s, repeat, area_m, lane_spacing_m, speed_min_m_per_s, "
            "speed_max_m_per_s, pause_min_s, pause_max_s, speed_mean_m_per_s, "
            "speed_sigma_m_per_s, direction_mean_rad, direction_sigma_rad, alpha, "
            "update_period_s, velocity_m_per_s, acceleration_psd_m2_per_s3, file");
  EXPECT_EQ(error_with("kind = \"waypoints\", speed_m_per_s = 0"),
            "s.toml:3: agents[0].motion.speed_m_per_s = 0: must be greater than 0");
  EXPECT_EQ(error_with(std::string(wander) + ", pause_max_s = -1"),
            "s.toml:3: agents[0].motion.pause_max_s = -1: must be at least 0");
  EXPECT_EQ(error_with("kind = \"random-waypoint\", area_m = [[0, 0], [9, 9]], speed_min_m_per_s "
                       "= 0, speed_max_m_per_s = 1"),
            "s.toml:3: agents[0].motion.speed_min_m_per_s = 0: must be greater than 0");
  EXPECT_EQ(error_with("altitude_m = 1e13"),
            "s.toml:3: agents[0].motion.altitude_m = 1e+13: must be between "
            "-1000000000000 and 1000000000000");
}

TEST_F(MotionSpecs, PointsAreArraysOfTwoNumbers) {
  const auto points = [](const std::string& text) {
    return error_with("kind = \"waypoints\", speed_m_per_s = 1, points_m = " + text);
  };
  EXPECT_EQ(points("3"),
            "s.toml:3: agents[0].motion.points_m = 3: expected an array of points, as [[0, 0], "
            "[100, 50]], found an integer");
  EXPECT_EQ(points("[1, 2]"),
            "s.toml:3: agents[0].motion.points_m[0] = 1: expected a point, as [100, 50], found an "
            "integer");
  EXPECT_EQ(points("[[1, 2], [1, 2, 3]]"),
            "s.toml:3: agents[0].motion.points_m[1] = [1, 2, 3]: must have 2 coordinates");
  EXPECT_EQ(points("[[1, \"2\"]]"),
            "s.toml:3: agents[0].motion.points_m[0][1] = \"2\": expected a number, found a string");
  EXPECT_EQ(points("[[nan, 2]]"),
            "s.toml:3: agents[0].motion.points_m[0][0] = nan: must be a finite number");
  EXPECT_EQ(points("[[1, 2], [1, 2]], repeat = \"loop\""),
            "s.toml:3: agents[0].motion: waypoints: to repeat, points_m must hold at least two "
            "different points");
}

TEST_F(MotionSpecs, ValuesThatDoNotFitTogetherAreRefused) {
  const auto area = [](const std::string& text) {
    return error_with("kind = \"lawn-mower\", speed_m_per_s = 1, lane_spacing_m = 1, area_m = " +
                      text);
  };
  EXPECT_EQ(area("[[0, 0]]"),
            "s.toml:3: agents[0].motion.area_m = [[0, 0]]: must be two corners, as [[0, 0], [100, "
            "50]]");
  EXPECT_EQ(area("[[0, 0], [9, 0]]"),
            "s.toml:3: agents[0].motion.area_m = [[0, 0], [9, 0]]: must be opposite corners of a "
            "rectangle that is wider and higher than 0");
  EXPECT_EQ(area("[[0, 0], [9, 1e9]]"),
            "s.toml:3: agents[0].motion: the number of lanes must be at most 1e6, not 1000000000");
  EXPECT_EQ(error_with("kind = \"random-waypoint\", area_m = [[0, 0], [9, 9]], speed_min_m_per_s "
                       "= 3, speed_max_m_per_s = 2"),
            "s.toml:3: agents[0].motion.speed_max_m_per_s = 2: must be at least speed_min_m_per_s "
            "(3.0 m/s)");
  EXPECT_EQ(error_with(std::string(wander) + ", pause_min_s = 3"),
            "s.toml:3: agents[0].motion.pause_min_s: needs pause_max_s, too");
  EXPECT_EQ(error_with(std::string(wander) + ", pause_min_s = 3, pause_max_s = 1"),
            "s.toml:3: agents[0].motion.pause_max_s = 1: must be at least pause_min_s (3.0 s)");
  EXPECT_EQ(error_with("kind = \"gauss-markov\", area_m = [[0, 0], [9, 9]], speed_mean_m_per_s = "
                       "1, speed_sigma_m_per_s = 0, direction_sigma_rad = 0, alpha = 1"),
            "s.toml:3: agents[0].motion.alpha = 1: must be less than 1, or nothing is ever "
            "forgotten");
}

TEST_F(MotionSpecs, WhatDrawsItsPlaceMustNotHaveOne) {
  EXPECT_EQ(error("[[agents]]\nposition_m = [0, 0]\nmotion = { " + std::string(wander) + " }\n"),
            "s.toml:3: agents[0].position_m: not with motion.kind = \"random-waypoint\", which "
            "draws where it begins");
  EXPECT_EQ(error("[[agents]]\ncount = 2\ncircle = {}\nmotion = { " + std::string(roam) + " }\n"),
            "s.toml:4: agents[0].circle: not with motion.kind = \"gauss-markov\", which draws "
            "where it begins");
  write("t.csv", "t_s,agent,x_m,y_m\n0,0,1,2\n");
  EXPECT_EQ(error("[[agents]]\nposition_m = [0, 0]\nmotion = { kind = \"track\", file = \"t.csv\" "
                  "}\n"),
            "s.toml:3: agents[0].position_m: not with motion.kind = \"track\", which has it from "
            "its file");
  EXPECT_EQ(error("radio = { topology = \"random-geometric\", side_m = 9, range_m = 1 }\n[[agents]]"
                  "\nmotion = { " +
                  std::string(roam) + " }\n"),
            "s.toml:4: agents[0].motion: not with topology = \"random-geometric\", which draws "
            "where agents stand");
}

TEST_F(MotionSpecs, TracksAreReadByNumberOrName) {
  write("t.csv",
        "t_s,agent,x_m,y_m\n0,uav0,1,2\n# the other\n3,1,5,5\n2,0,3,2\n4,uav0,3,6\n0,base,9,9\n");
  const Scenario s = load(
      "[[agents]]\nname = \"uav\"\ncount = 2\n"
      "motion = { kind = \"track\", file = \"t.csv\", altitude_m = 7 }\n"
      "[[agents]]\nname = \"base\"\nposition_m = [0, 0]\n");
  AgentPaths paths(s, agent_positions(s), 1);
  const Leg first = paths.next(0, Time());
  EXPECT_EQ(first.at(Time::at(1_s)), (Point{2, 2, 7}));
  EXPECT_EQ(first.end, Time::at(2_s));
  EXPECT_EQ(paths.next(0, Time()).at(Time::at(3_s)), (Point{3, 4, 7}));
  EXPECT_EQ(paths.next(1, Time()).from_m, (Point{5, 5, 7}));
  EXPECT_EQ(paths.next(2, Time()).from_m, (Point{0, 0, 0})) << "base has no track";
}

TEST_F(MotionSpecs, TracksStandBesideTheScenario) {
  std::filesystem::create_directories("sub");
  write("sub/t.csv", "t_s,agent,x_m,y_m\n0,0,1,2\n");
  write("sub/s.toml",
        "duration_s = 1\n[[agents]]\nmotion = { kind = \"track\", file = \"t.csv\" }\n");
  EXPECT_EQ(load_scenario("sub/s.toml", {}, {}).agents[0].motion->file, "sub/t.csv");
  write("other.csv", "t_s,agent,x_m,y_m\n0,0,3,4\n");
  const auto set = sets({"agents.motion.file=other.csv"});
  EXPECT_EQ(load_scenario("sub/s.toml", set, {}).agents[0].motion->file, "other.csv");
}

TEST_F(MotionSpecs, BadTracksAreRefusedByFileAndLine) {
  const std::string head = "t_s,agent,x_m,y_m\n0,0,1,2\n";
  EXPECT_EQ(track_error(head + "0,1,1,2\n"), "no error");
  EXPECT_EQ(track_error(head), "s.toml:5: agents[0].motion.file: t.csv has no row of agent 'uav1'");
  EXPECT_EQ(track_error(head + "0,1,1,2\n3,0,1,2\n\n2,0,1,1\n"),
            "t.csv:6: t_s = 2: must be after the time of the same agent on line 4");
  EXPECT_EQ(track_error(head + "0,uav0,1,2\n"),
            "t.csv:3: t_s = 0: must be after the time of the same agent on line 2");
  EXPECT_EQ(track_error(head + "1,uav2,1,2\n"),
            "t.csv:3: agent = \"uav2\": there is no such agent; did you mean 'uav0'?");
  EXPECT_EQ(track_error(head + "1,2,1,2\n"),
            "t.csv:3: agent = 2: there is no agent 2; they are 0 … 1");
  EXPECT_EQ(track_error(head + "soon,1,1,2\n"), "t.csv:3: t_s = \"soon\": must be a number");
  EXPECT_EQ(track_error(head + "-1,1,1,2\n"), "t.csv:3: t_s = -1: must be at least 0");
  EXPECT_EQ(track_error(head + "2e9,1,1,2\n"), "t.csv:3: t_s = 2e9: must be at most 1000000000");
  EXPECT_EQ(track_error(head + "1,1,here,2\n"), "t.csv:3: x_m = \"here\": must be a number");
  EXPECT_EQ(track_error(head + "1,1,1,-2e12\n"), "t.csv:3: y_m = -2e12: must be within ±1e12 m");
  EXPECT_NE(track_error("t_s,agent,x_m\n0,0,1\n").find("y_m"), std::string::npos);
  EXPECT_NE(track_error(head + "1,1,1\n").find("t.csv:3"), std::string::npos);
  EXPECT_EQ(error("[[agents]]\nmotion = { kind = \"track\", file = \"\" }\n"),
            "s.toml:3: agents[0].motion.file: missing; which CSV file t_s,agent,x_m,y_m");
  EXPECT_NE(error("[[agents]]\nmotion = { kind = \"track\", file = \"no.csv\" }\n").find("no.csv"),
            std::string::npos);
}

TEST_F(MotionSpecs, AgentsOfAnEntryGoTheirOwnWays) {
  const Scenario s =
      load("[[agents]]\ncount = 2\nmotion = { " + std::string(wander) +
           " }\n[[agents]]\ncount = 2\ncircle = { radius_m = 10 }\n"
           "motion = { kind = \"waypoints\", points_m = [[0, 0], [0, 9]], speed_m_per_s = 2 }\n"
           "[[agents]]\nposition_m = [5, 5]\n");
  EXPECT_TRUE(has_motion(s));
  EXPECT_FALSE(has_motion(load("[[agents]]\n")));
  const auto first_legs = [&](std::uint64_t seed) {
    AgentPaths paths(s, agent_positions(s), seed);
    std::vector<Leg> legs;
    for (AgentId a = 0; a < 5; ++a) legs.push_back(paths.next(a, Time()));
    return legs;
  };
  const auto legs = first_legs(1), again = first_legs(1), other = first_legs(2);
  EXPECT_NE(legs[0].from_m, legs[1].from_m);
  EXPECT_EQ(legs[0].from_m, again[0].from_m);
  EXPECT_NE(legs[0].from_m, other[0].from_m);
  EXPECT_EQ(legs[2].from_m, (Point{10, 0, 0}));
  EXPECT_EQ(legs[2].end, Time::at(5_s));
  EXPECT_NEAR(legs[3].from_m[0], -10.0, 1e-12);
  EXPECT_EQ(legs[4].from_m, (Point{5, 5, 0}));
  EXPECT_EQ(legs[4].end, Time::never());
}

}  // namespace
}  // namespace hearsay
