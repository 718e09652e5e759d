// What scenarios of foragers must not say: refused with file, line, key and what is allowed.
#include <gtest/gtest.h>

#include <string>

#include "tests/scenarios/temp_files.hpp"
#include "tests/scenarios/with.hpp"

namespace hearsay {
namespace {

const std::string scenario = R"(duration_s = 600
[world.plan]
file = "floor.txt"
cell_m = 0.5
[radio]
topology = "full"
[[agents]]
kind = "forager"
count = 4
robot = { start = "A" }
task = { events = ["A", "B"] }
trails = { parameters = "lost-2002" }
talk = { policy = "at-once" }
)";
const std::string floor_text =
    "##########\n"
    "#A..#...B#\n"
    "#...#....#\n"
    "#.......C#\n"
    "##########\n";

class ForagerChecks : public InTempDirectory {
 protected:
  void SetUp() override {
    InTempDirectory::SetUp();
    write("floor.txt", floor_text);
  }
  static std::string error(const std::string& text) {
    write("s.toml", text);
    return error_of([] { load_scenario("s.toml", {}, {}); });
  }
  static std::string changed(const std::string& from, const std::string& to) {
    return error(with(scenario, from, to));
  }
  static std::string robot(const std::string& keys) {
    return changed("start = \"A\"", "start = \"A\", " + keys);
  }
  static std::string trails(const std::string& keys) {
    return changed("parameters = \"lost-2002\"", keys);
  }
  static std::string talk(const std::string& keys) { return changed("policy = \"at-once\"", keys); }
  /// In [world.plan], as line 5.
  static std::string plan(const std::string& line) {
    return changed("cell_m = 0.5\n", "cell_m = 0.5\n" + line + "\n");
  }
  /// In the last [[agents]], as line 14.
  static std::string agent(const std::string& line) { return error(scenario + line + "\n"); }
  /// The entry begins in line 14.
  static std::string second(const std::string& keys) {
    return error(scenario + "[[agents]]\n" + keys);
  }
  /// [[world.sources]] stands in line 5.
  static std::string sources(const std::string& keys) { return plan("[[world.sources]]\n" + keys); }
};

TEST_F(ForagerChecks, AWholeOneIsWell) { EXPECT_EQ(error(scenario), "no error"); }

TEST_F(ForagerChecks, AFloorNeedsForagersAndForagersNeedAFloor) {
  const std::string lone = "duration_s = 9\nworld = { plan = { file = \"floor.txt\" } }\n";
  const std::string without = "without effect: no agent is of kind \"forager\"";
  EXPECT_EQ(error(lone + "[[agents]]\nkind = \"source\"\n"), "s.toml:2: world.plan: " + without);
  EXPECT_EQ(error(with(lone, "plan = { file = \"floor.txt\" }", "sources = [{ name = \"A\" }]") +
                  "[[agents]]\nkind = \"source\"\n"),
            "s.toml:2: world.sources: " + without);
  EXPECT_EQ(error("duration_s = 9\nrecord = { crumbs = \"on\" }\n[[agents]]\nkind = \"source\"\n"),
            "s.toml:2: record.crumbs: " + without);
  EXPECT_EQ(error(scenario + "[record]\ncrumbs = \"on\"\n"), "no error");
  EXPECT_EQ(error(with(scenario, "[world.plan]\nfile = \"floor.txt\"\ncell_m = 0.5\n", "")),
            "s.toml: world.plan: missing; agents of kind \"forager\" need a floor, as plan = { "
            "file = \"plan.txt\" }");
}

TEST_F(ForagerChecks, NoOtherWorldGoesWithIt) {
  EXPECT_EQ(plan("[world.log]\ndirectory = \"x\"\n"),
            "s.toml:5: world.log: no agent has a sensor of kind \"log\" that would read it");
  EXPECT_EQ(plan("[world]\ntargets = [{ position_m = [1, 1] }]"),
            "s.toml:6: world.targets: without effect: agents of kind \"forager\" have "
            "world.sources instead");
  EXPECT_EQ(plan("[world.area]\n"),
            "s.toml:5: world.area: without effect: no agent is of kind \"explorer\"");
}

TEST_F(ForagerChecks, APlanIsRead) {
  EXPECT_EQ(changed("file = \"floor.txt\"", "file = \"flor.txt\""),
            "s.toml:3: world.plan.file: there is no file \"flor.txt\"");
  EXPECT_EQ(changed("file = \"floor.txt\"", "file = \"flor.png\""),
            "s.toml:3: world.plan.file: there is no file \"flor.png\"");
  EXPECT_EQ(changed("file = \"floor.txt\"", "file = \".\""), ".: not a file");
  EXPECT_EQ(changed("file = \"floor.txt\"\n", ""),
            "s.toml:2: world.plan.file: missing; which drawing in text, or bitmap in PNG?");
  write("floor.txt", with(floor_text, "C", "B"));
  EXPECT_EQ(error(scenario),
            "floor.txt:2: column 9: place B is also in line 4; each letter is allowed once");
  write("floor.txt", with(floor_text, "C", "*"));
  EXPECT_EQ(error(scenario),
            "floor.txt:4: column 9: found \"*\"; allowed are # (wall), space and . (free), A-Z "
            "and a-z (places)");
  EXPECT_EQ(changed("cell_m = 0.5", "cell_m = 0"),
            "s.toml:4: world.plan.cell_m = 0: must be between 0.001 and 20");
}

TEST_F(ForagerChecks, APlanMayBeABitmap) {
  // 3 × 3 pixels of luminance 0, but 200 in the middle and 100 to the right of it.
  const unsigned char png[] = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
      0x52, 0x00, 0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x03, 0x08, 0x00, 0x00, 0x00, 0x00, 0x73,
      0x43, 0xea, 0x63, 0x00, 0x00, 0x00, 0x0f, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x60,
      0x00, 0x81, 0x13, 0x29, 0x20, 0x12, 0x00, 0x06, 0xb0, 0x01, 0x2d, 0x5d, 0xfe, 0x34, 0xfd,
      0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  write("floor.png", std::string(reinterpret_cast<const char*>(png), sizeof png));
  const std::string places =
      "places = [{ name = \"A\", position_m = [1.5, 1.5] }, { name = \"B\", position_m = [2.5, "
      "1.5] }]\n";
  const auto bitmap = [&](const std::string& lines) {
    return error(with(with(scenario, "floor.txt", "floor.png"), "cell_m = 0.5\n", places + lines));
  };
  EXPECT_EQ(bitmap("cell_m = 1\nwall_below = 50\n"), "no error");
  EXPECT_EQ(bitmap("cell_m = 1\n"),
            "s.toml:4: world.plan.places[1]: place B at (2.500000, 1.500000) m is in a wall; a "
            "place is in a free cell");
  EXPECT_EQ(plan("wall_below = 100"),
            "s.toml:5: world.plan.wall_below: only for bitmaps, whose file ends in .png");
}

TEST_F(ForagerChecks, PlacesHaveNamesOfTheirOwnAndAreFree) {
  const auto places = [&](const std::string& entry) { return plan("places = [" + entry + "]"); };
  EXPECT_EQ(places("{ name = \"door\", position_m = [1, 1] }"), "no error");
  const std::string at = "s.toml:5: world.plan.places[0]";
  EXPECT_EQ(places("{ position_m = [1, 1] }"), at + ".name: missing");
  EXPECT_EQ(places("{ name = \"door\" }"), at + ".position_m: missing");
  EXPECT_EQ(places("{ name = \"a door\", position_m = [1, 1] }"),
            at + ".name = \"a door\": must not contain blanks");
  EXPECT_EQ(places("{ name = \"anywhere\", position_m = [1, 1] }"),
            at + ".name = \"anywhere\": means something else in robot.start; take another name");
  EXPECT_EQ(places("{ name = \"B\", position_m = [1, 1] }").substr(0, at.size()), at);
  EXPECT_NE(places("{ name = \"door\", position_m = [9, 1] }").find("not in the drawing"),
            std::string::npos);
}

TEST_F(ForagerChecks, BarriersAreWithinThePlanForAWhile) {
  const auto barrier = [&](const std::string& keys) {
    return plan("barriers = [{ " + keys + " }]");
  };
  const std::string at = "s.toml:5: world.plan.barriers[0]";
  EXPECT_EQ(barrier("corner_m = [5, 2.5], opposite_m = [0, 0], from_s = 5, until_s = 6"),
            "no error");
  const std::string missing = ": missing; the barrier is a rectangle between two opposite corners";
  EXPECT_EQ(barrier("corner_m = [1, 1]"), at + ".opposite_m" + missing);
  EXPECT_EQ(barrier("opposite_m = [1, 1]"), at + ".corner_m" + missing);
  EXPECT_EQ(barrier("corner_m = [1, 1], opposite_m = [2, 2.6]"),
            at + ".opposite_m = [2, 2.6]: is not within the plan of 5.0 m × 2.5 m");
  EXPECT_EQ(barrier("corner_m = [1, -0.1], opposite_m = [2, 2]"),
            at + ".corner_m = [1, -0.1]: is not within the plan of 5.0 m × 2.5 m");
  EXPECT_EQ(barrier("corner_m = [1, 1], opposite_m = [2, 1]"),
            at + ".opposite_m: the barrier must be wider and higher than 0");
  EXPECT_EQ(barrier("corner_m = [1, 1], opposite_m = [2, 2], from_s = 5, until_s = 5"),
            at + ".until_s: must be after from_s (5.0 s)");
}

TEST_F(ForagerChecks, SourcesAreAtPlacesAndMoveToPlaces) {
  EXPECT_EQ(sources("name = \"B\"\nunits = 3\n"
                    "moves = [{ at_s = 1, place = \"C\" }, { at_s = 2, place = \"B\" }]"),
            "no error");
  EXPECT_EQ(sources("units = 3"), "s.toml:5: world.sources[0].name: missing; a place of the plan");
  EXPECT_EQ(sources("name = \"D\""),
            "s.toml:6: world.sources[0].name = \"D\": unknown place of the plan; allowed: A, B, C");
  EXPECT_EQ(sources("name = \"C\""),
            "s.toml:6: world.sources[0].name: without effect: \"C\" is in nobody's task");
  EXPECT_EQ(sources("name = \"B\"\n[[world.sources]]\nname = \"B\""),
            "s.toml:8: world.sources[1].name: two sources are called 'B'");
  const auto moves = [&](const std::string& list) {
    return sources("name = \"B\"\nmoves = [" + list + "]");
  };
  const std::string at = "s.toml:7: world.sources[0].moves";
  EXPECT_EQ(moves("{ place = \"C\" }"), at + "[0].at_s: missing");
  EXPECT_EQ(moves("{ at_s = 3 }"), at + "[0].place: missing; a place of the plan");
  EXPECT_EQ(moves("{ at_s = 3, place = \"C\" }, { at_s = 3, place = \"A\" }"),
            at + "[1].at_s = 3: must be after the move before it (3.0 s)");
  EXPECT_EQ(moves("{ at_s = 3, place = \"E\" }"),
            at + "[0].place = \"E\": unknown place of the plan; allowed: A, B, C");
}

TEST_F(ForagerChecks, OtherAgentsHaveNothingOfAForager) {
  const std::string only = "only for kind = \"forager\"; found \"source\"";
  const std::string source = "kind = \"source\"\n";
  EXPECT_EQ(second(source), "no error");
  EXPECT_EQ(second(source + "robot = { start = \"A\" }"), "s.toml:16: agents[1].robot: " + only);
  EXPECT_EQ(second(source + "task = { events = [\"A\"] }"), "s.toml:16: agents[1].task: " + only);
  EXPECT_EQ(second(source + "trails = {}"), "s.toml:16: agents[1].trails: " + only);
  EXPECT_EQ(second(source + "talk = { policy = \"at-event\" }"),
            "s.toml:16: agents[1].talk.policy: \"at-event\" is " + only);
  EXPECT_EQ(second("kind = \"tracker\""),
            "s.toml:15: agents[1].kind: \"tracker\" does not go with agents of kind \"forager\"");
  EXPECT_EQ(error("duration_s = 9\n[[agents]]\ntalk = { policy = \"at-once\" }\n"),
            "s.toml:3: agents[0].talk.policy: \"at-once\" is only for kind = \"forager\"; found "
            "\"estimator\"");
}

TEST_F(ForagerChecks, AForagerHasWhatItNeeds) {
  EXPECT_EQ(changed("robot = { start = \"A\" }\n", ""),
            "s.toml:7: agents[0].robot: missing; as robot = { start = \"A\" }");
  EXPECT_EQ(changed("task = { events = [\"A\", \"B\"] }\n", ""),
            "s.toml:7: agents[0].task: missing; as task = { events = [\"A\", \"B\"] }");
  EXPECT_EQ(changed("trails = { parameters = \"lost-2002\" }\n", ""),
            "s.toml:7: agents[0].trails: missing; as trails = { parameters = \"lost-2002\" }");
}

TEST_F(ForagerChecks, AForagerSteersItself) {
  const std::string where = "not for kind \"forager\": robot.start says where it begins";
  EXPECT_EQ(agent("position_m = [1, 1]"), "s.toml:14: agents[0].position_m: " + where);
  EXPECT_EQ(agent("circle = { radius_m = 1 }"), "s.toml:14: agents[0].circle: " + where);
  EXPECT_EQ(agent("motion = { kind = \"steered\" }"),
            "s.toml:14: agents[0].motion: not for kind \"forager\": it steers itself, and "
            "robot.start says where it begins");
  EXPECT_EQ(agent("sensor = { kind = \"position\" }"),
            "s.toml:14: agents[0].sensor.kind: not for kind \"forager\": it has the scanner of "
            "agents.robot");
  EXPECT_EQ(agent("estimator = { fusion = \"naive\" }"),
            "s.toml:14: agents[0].estimator: without effect: kind = \"forager\" has agents.trails "
            "instead");
  const std::string explorers = "only for kind = \"explorer\"; found \"forager\"";
  EXPECT_EQ(agent("grid = { fusion = \"naive\" }"), "s.toml:14: agents[0].grid: " + explorers);
  EXPECT_EQ(agent("exploration = {}"), "s.toml:14: agents[0].exploration: " + explorers);
  EXPECT_EQ(agent("traffic = { period_s = 1 }"),
            "s.toml:14: agents[0].traffic: only for kind = \"source\"; found \"forager\"");
}

TEST_F(ForagerChecks, ARobotBeginsAtAPlace) {
  EXPECT_EQ(changed("start = \"A\"", "start = \"anywhere\""), "no error");
  EXPECT_EQ(changed("start = \"A\"", "radius_m = 0.2"),
            "s.toml:10: agents[0].robot.start: missing; a place of the plan, or \"anywhere\"");
  EXPECT_EQ(
      changed("start = \"A\"", "start = \"Z\""),
      "s.toml:10: agents[0].robot.start = \"Z\": unknown place of the plan; allowed: A, B, C");
  EXPECT_EQ(
      changed("topology = \"full\"", "topology = \"random-geometric\"\nrange_m = 5\nside_m = 9"),
      "s.toml:12: agents[0].robot: not with topology = \"random-geometric\", which draws "
      "where agents stand");
  // Its place is known to radios that reach so far.
  EXPECT_EQ(changed("topology = \"full\"", "topology = \"disk\"\nrange_m = 5"), "no error");
}

TEST_F(ForagerChecks, ARobotIsSomethingThatARunCanBear) {
  EXPECT_EQ(robot("rays = 7"), "s.toml:10: agents[0].robot.rays = 7: must be between 8 and 4096");
  EXPECT_EQ(robot("control_period_s = 4e-6"), "no error");
  EXPECT_EQ(robot("control_period_s = 2e-6"),
            "s.toml:10: agents[0].robot.control_period_s: more than 2e8 steps in a run");
  EXPECT_EQ(robot("speed_m_per_s = 500, control_period_s = 2"), "no error");
  EXPECT_EQ(robot("speed_m_per_s = 500, control_period_s = 2.1"),
            "s.toml:10: agents[0].robot.control_period_s: at 500.0 m/s it drives more than 1000 m "
            "within it");
  EXPECT_EQ(robot("turn_rad_per_s = 1000, control_period_s = 0.11"),
            "s.toml:10: agents[0].robot.control_period_s: at 1000.0 rad/s it turns by more than "
            "100 rad within it");
  EXPECT_EQ(changed("count = 4", "count = 24414"), "no error");
  EXPECT_EQ(changed("count = 4", "count = 24415"),
            "s.toml:12: agents[0].trails: more than 1e8 crumbs, for all foragers together; lower "
            "crumbs_max");
  const std::string few = with(scenario, "\"lost-2002\"", "\"lost-2002\", crumbs_max = 9");
  EXPECT_EQ(error(with(few, "count = 4", "count = 55555")), "no error");
  EXPECT_EQ(
      error(with(few, "count = 4", "count = 55556")),
      "s.toml:10: agents[0].robot: more than 1e7 rays, for all foragers together; lower rays");
}

TEST_F(ForagerChecks, RobotsThatShareAFloorAreAlike) {
  const std::string rest = "kind = \"forager\"\ntask = { events = [\"B\", \"C\"] }\n";
  EXPECT_EQ(second(rest + "robot = { start = \"C\", rays = 90 }\ntrails = {}\n"), "no error");
  EXPECT_EQ(second(rest + "robot = { start = \"C\", radius_m = 0.3 }\ntrails = {}\n"),
            "s.toml:17: agents[1].robot.radius_m = 0.3: must be that of agents[0] (0.25 m), as of "
            "all foragers");
  EXPECT_EQ(second(rest + "trails = {}\nrobot = { start = \"C\", control_period_s = 0.2 }\n"),
            "s.toml:18: agents[1].robot.control_period_s = 0.2: must be that of agents[0] (0.1 s), "
            "as of all foragers");
  EXPECT_EQ(second(rest + "robot = { start = \"C\" }\n"
                          "trails = { parameters = \"thesis-2019-code\" }\n"),
            "s.toml:18: agents[1].trails.distance: its crumbs and those of agents[0] count "
            "different distances; all foragers of a run count the same");
}

TEST_F(ForagerChecks, ATaskIsOfKnownEvents) {
  const auto task = [&](const std::string& keys) {
    return changed("events = [\"A\", \"B\"]", keys);
  };
  EXPECT_EQ(task("respawn = true"),
            "s.toml:11: agents[0].task.events: missing; names of sources or places");
  EXPECT_EQ(task("events = [\"B\"]"),
            "s.toml:11: agents[0].task.events: one event alone needs respawn = true, or the robot "
            "is there for ever");
  EXPECT_EQ(
      task("events = [\"B\", \"X\"]"),
      "s.toml:11: agents[0].task.events[1] = \"X\": unknown place of the plan; allowed: A, B, C");
  EXPECT_EQ(task("events = [\"B\", \"B\"]"),
            "s.toml:11: agents[0].task.events[1] = \"B\": stands there twice");
  std::string many;
  for (char c = 'a'; c <= 'q'; ++c) many += std::string(c == 'a' ? "" : ", ") + '"' + c + '"';
  EXPECT_EQ(task("events = [" + many + "]"),
            "s.toml:11: agents[0].task.events: has 17 events; at most 16 are allowed");
}

TEST_F(ForagerChecks, WhoIsCarriedBackLaysWhatItHasCompleted) {
  const auto carried = [](const std::string& events, const std::string& trails) {
    return error(with(with(with(scenario, "[\"A\", \"B\"]", events + ", respawn = true"),
                           "parameters = \"lost-2002\"", trails),
                      "policy = \"at-once\"", "policy = \"at-event\""));
  };
  const std::string refused =
      "s.toml:11: agents[0].task.respawn = true: needs agents.trails.laying = \"completed\": "
      "crumbs "
      "laid at once lead back to the last event, and who is carried away from there lays none; "
      "found \"at-once\"";
  for (const char* events : {"[\"B\"]", "[\"A\", \"B\"]"}) {
    EXPECT_EQ(carried(events, ""), refused + ", by parameters \"lost-2002\"");
    EXPECT_EQ(carried(events, "parameters = \"thesis-2019-code\", laying = \"at-once\""), refused);
    const std::string as_is = ", transform = \"as-is\"";
    EXPECT_EQ(carried(events, "laying = \"completed\"" + as_is), "no error");
    EXPECT_EQ(carried(events, "parameters = \"thesis-2019-text\"" + as_is), "no error");
    // These lay nothing anyway.
    EXPECT_EQ(carried(events, "navigation = \"map\""), "no error");
    EXPECT_EQ(carried(events, "navigation = \"explore\""), "no error");
  }
}

TEST_F(ForagerChecks, WithOneEventNobodyHasTwoPlacesInCommon) {
  const auto one = [](const std::string& trails, const std::string& policy) {
    return error(with(with(with(scenario, "[\"A\", \"B\"]", "[\"B\"], respawn = true"),
                           "parameters = \"lost-2002\"", "laying = \"completed\"" + trails),
                      "policy = \"at-once\"", "policy = \"" + policy + '"'));
  };
  EXPECT_EQ(one("", "at-event"),
            "s.toml:12: agents[0].trails.transform: \"pessimistic\" needs two events: with one "
            "place in common it drops all that it hears; allowed here: \"optimistic\", \"as-is\"");
  EXPECT_EQ(one(", transform = \"optimistic\"", "at-event"), "no error");
  EXPECT_EQ(one("", "never"), "no error");
}

TEST_F(ForagerChecks, TalkIsOfCrumbs) {
  for (const char* policy : {"at-event", "periodic", "never"}) {
    EXPECT_EQ(talk("policy = \"" + std::string(policy) + "\""), "no error") << policy;
  }
  EXPECT_EQ(talk("policy = \"on-update\""),
            "s.toml:13: agents[0].talk.policy: kind \"forager\" knows \"at-once\", \"at-event\", "
            "\"periodic\" and \"never\" alone; found \"on-update\"");
  EXPECT_EQ(talk("policy = \"periodic\", period_s = 2e-6"),
            "s.toml:13: agents[0].talk.period_s: more than 2e8 talks in a run");
  EXPECT_EQ(talk("content = \"diagonal\""),
            "s.toml:13: agents[0].talk.content: kind \"forager\" says whole crumbs; found "
            "\"diagonal\"");
  EXPECT_EQ(talk("service = \"acknowledged\""),
            "s.toml:13: agents[0].talk.service: kind \"forager\" knows \"broadcast\" alone; found "
            "\"acknowledged\"");
  EXPECT_EQ(trails("laying = \"completed\""),
            "s.toml:13: agents[0].talk.policy: \"at-once\" needs agents.trails.laying = "
            "\"at-once\": the crumbs of a trail that is told when it is completed have no "
            "distances before");
}

TEST_F(ForagerChecks, AQueueHoldsAPacket) {
  const auto queue = [](const std::string& bytes) {
    return changed("topology = \"full\"",
                   "topology = \"full\"\nheader_bytes = 8\nqueue_bytes_max = " + bytes);
  };
  EXPECT_EQ(queue("1408"), "no error");
  EXPECT_EQ(queue("1407"),
            "s.toml:8: radio.queue_bytes_max = 1407: smaller than one packet: one of "
            "packet_bytes_max of a forager takes 1408 bytes with headers");
}

TEST_F(ForagerChecks, TrailsSayNothingWithoutEffect) {
  const std::string at = "s.toml:12: agents[0].trails.";
  EXPECT_EQ(trails("trail_crumbs_max = 9"),
            at + "trail_crumbs_max: only for laying = \"completed\"; found \"at-once\", by "
                 "parameters \"lost-2002\"");
  EXPECT_EQ(trails("laying = \"completed\", lanes = \"so-lost\""),
            at + "lanes: \"so-lost\" needs laying = \"at-once\", whose crumbs say where their "
                 "robot was going; found \"completed\"");
  EXPECT_EQ(trails("parameters = \"thesis-2019-code\", lanes = \"highway\""),
            at + "lanes: \"highway\" needs laying = \"at-once\", whose crumbs say where their "
                 "robot was going; found \"completed\", by parameters \"thesis-2019-code\"");
  EXPECT_EQ(trails("lanes = \"so-lost\", field_rad = 1"), "no error");
  EXPECT_EQ(trails("life_arrivals = 1"), "no error");
  EXPECT_EQ(trails("parameters = \"thesis-2019-code\", life_arrivals = 1"),
            at + "life_arrivals: 1 needs laying = \"at-once\": a trail that is told at an arrival "
                 "has that behind it; found \"completed\", by parameters \"thesis-2019-code\"");
  for (const char* key :
       {"lanes = \"so-lost\"", "field_rad = 1", "random_chance = 0.5", "random_falls_by = 0.5"}) {
    const std::string text(key);
    EXPECT_EQ(trails("navigation = \"map\", " + text),
              at + text.substr(0, text.find(' ')) +
                  ": without effect with navigation = \"map\"; only with \"trails\"");
  }
  EXPECT_EQ(trails("navigation = \"explore\", sense_radius_m = 2"), "no error");  // an axis
  EXPECT_EQ(trails("trail_end = \"none\", trail_end_s = 1"),
            at + "trail_end_s: without effect with trail_end = \"none\"");
  EXPECT_EQ(trails("random_falls_by = 0.1"), at + "random_falls_by: needs a random_chance above 0");
  EXPECT_EQ(trails("random_falls_by = 0.1, random_chance = 0"),
            at + "random_falls_by: needs a random_chance above 0");
  EXPECT_EQ(trails("random_falls_by = 0.1, random_chance = 0.1"), "no error");
  EXPECT_EQ(trails("transform = \"as-is\", scale = false"),
            at + "scale: without effect with transform = \"as-is\"");
  EXPECT_EQ(trails("field_rad = 0.05"),
            at + "field_rad = 0.05: must be between 0.1 and 6.283185307179586");
}

TEST_F(ForagerChecks, ASetOfParametersSaysWhatIsNotGiven) {
  const std::string thesis = with(scenario, "policy = \"at-once\"", "policy = \"at-event\"");
  const auto text = [&](const std::string& keys) {
    return error(with(thesis, "\"lost-2002\"", "\"thesis-2019-text\", " + keys));
  };
  EXPECT_EQ(text("trail_crumbs_max = 9"), "no error");  // its trails are completed
  EXPECT_EQ(text("age_max_s = 9, life_arrivals = 3"), "no error");
  // It tells how local search fades, but there is none unless the file says so.
  EXPECT_EQ(text("random_falls_by = 0.01"),
            "s.toml:12: agents[0].trails.random_falls_by: needs a random_chance above 0");
}

TEST_F(ForagerChecks, APacketHoldsACrumbAndThePlacesOfAllEvents) {
  // By its type (filters/trails/codec.hpp): header 4, head 24, length of places 4 and 4 to the next
  // multiple of 8, 24 a place, length of crumbs and padding 8, a crumb 32, length of positions 4,
  // two floats for each of these.
  const auto bytes = [](int places) {
    return 4 + 24 + 8 + 24 * places + 8 + 32 + 4 + 8 * (places + 1);
  };
  const std::string other =
      "kind = \"forager\"\nrobot = { start = \"B\" }\ntask = { events = [\"B\", \"C\"] }\n";
  const auto with_bytes = [&](int max) {
    return other + "trails = { packet_bytes_max = " + std::to_string(max) + " }\n";
  };
  EXPECT_EQ(bytes(3), 184);
  EXPECT_EQ(second(with_bytes(184)), "no error");
  EXPECT_EQ(second(with_bytes(183)),
            "s.toml:18: agents[1].trails.packet_bytes_max = 183: a crumb and the places of 3 "
            "events take 184 bytes");
  EXPECT_EQ(trails("packet_bytes_max = " + std::to_string(bytes(2))), "no error");
}

}  // namespace
}  // namespace hearsay
