#include "sim/world/plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "sim/kernel/error.hpp"
#include "tests/sim/world/floors.hpp"

namespace hearsay::plan {
namespace {

template <typename F>
std::string complaint(F&& f) {
  try {
    f();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string complaint_of(const std::string& text, double cell_m = 1.0) {
  return complaint([&] { parse_text(text, "plan.txt", cell_m); });
}

TEST(Plan, ADrawingHasItsFirstLineAtTheTop) {
  const Drawing d = parse_text("####\n#.B#\n#A #\n# ##\n####\n", "plan.txt", 0.5);
  EXPECT_EQ(d.columns, 4);
  EXPECT_EQ(d.rows, 5);
  EXPECT_FALSE(d.wall(1, 1));
  EXPECT_TRUE(d.wall(2, 1));
  EXPECT_FALSE(d.wall(2, 2));
  EXPECT_TRUE(d.wall(-1, 2) && d.wall(4, 2) && d.wall(1, 5) && d.wall(1, -1));
  const Plan plan(d);
  EXPECT_EQ(plan.width_m(), 2.0);
  EXPECT_EQ(plan.height_m(), 2.5);
  EXPECT_EQ(plan.place("A"), (Point{0.75, 1.25}));
  EXPECT_EQ(plan.place("B"), (Point{1.25, 1.75}));
}

TEST(Plan, LineEndsOfEitherKindAndNoneAtTheEndAreRead) {
  EXPECT_EQ(parse_text("#A\r\n. \r\n", "p", 1.0).walls, parse_text("#A\n. ", "p", 1.0).walls);
}

TEST(Plan, WallsOfARoomAreItsInnerSidesWithTheRoomOnTheirLeft) {
  const Plan plan(parse_text("#####\n#   #\n#   #\n#####\n", "p", 2.0));
  const auto walls = plan.walls();
  ASSERT_EQ(walls.size(), 4u);
  for (const Segment& s : walls) {
    const double left =
        (s.to.x_m - s.from.x_m) * (4.0 - s.from.y_m) - (s.to.y_m - s.from.y_m) * (5.0 - s.from.x_m);
    EXPECT_GT(left, 0.0);
  }
  EXPECT_EQ(walls[0].from, (Point{2.0, 2.0}));
  EXPECT_EQ(walls[0].to, (Point{8.0, 2.0}));
}

TEST(Plan, WhatLiesBeyondADrawingIsWall) {
  EXPECT_EQ(Plan(parse_text("  \n  \n", "p", 1.0)).walls().size(), 4u);
}

TEST(Plan, WallsCoverEachStepBetweenWallAndFreeOnceAndAreAsLongAsTheyAreStraight) {
  Stream stream(1, Purpose("plans"), Entity{0});
  for (int round = 0; round < 300; ++round) {
    const Drawing d = random_drawing(stream, 20, 1.0);
    // A step: from a lattice point one to the right (0) or up (1); the side that is free.
    using Step = std::tuple<int, int, int>;
    std::map<Step, int> expected, found, begins, ends;
    for (int y = 0; y <= d.rows; ++y) {
      for (int x = 0; x <= d.columns; ++x) {
        if (x < d.columns && d.wall(x, y) != d.wall(x, y - 1)) {
          expected[{x, y, 0}] = d.wall(x, y) ? -1 : 1;
        }
        if (y < d.rows && d.wall(x, y) != d.wall(x - 1, y)) {
          expected[{x, y, 1}] = d.wall(x, y) ? 1 : -1;
        }
      }
    }
    const Plan plan(d);
    for (const Segment& s : plan.walls()) {
      const bool up = s.from.x_m == s.to.x_m;
      ASSERT_TRUE(up || s.from.y_m == s.to.y_m);
      const int along = static_cast<int>(up ? s.to.y_m - s.from.y_m : s.to.x_m - s.from.x_m);
      const int side = along > 0 ? 1 : -1;
      int x = static_cast<int>(std::min(s.from.x_m, s.to.x_m));
      int y = static_cast<int>(std::min(s.from.y_m, s.to.y_m));
      ++begins[{x, y, up ? side : 2 * side}];
      for (int i = 0; i < std::abs(along); ++i, (up ? y : x) += 1) {
        const bool fresh = found.emplace(Step{x, y, up ? 1 : 0}, side).second;
        ASSERT_TRUE(fresh);
      }
      ++ends[{x, y, up ? side : 2 * side}];
    }
    ASSERT_EQ(found, expected);
    for (const auto& [end, n] : ends) ASSERT_EQ(begins.count(end), 0u) << "could be one piece";
  }
}

TEST(Plan, OtherCharactersAreRefusedWithLineAndColumn) {
  const std::string allowed = "; allowed are # (wall), space and . (free), A-Z and a-z (places)";
  EXPECT_EQ(complaint_of("###\n#7#\n"), "plan.txt:2: column 2: found \"7\"" + allowed);
  EXPECT_EQ(complaint_of("##\n\t#\n"), "plan.txt:2: column 1: found byte 0x09" + allowed);
  EXPECT_EQ(complaint_of("#\xc3\n"), "plan.txt:1: column 2: found byte 0xc3" + allowed);
  EXPECT_EQ(complaint_of("a#\n#a\n"),
            "plan.txt:1: column 1: place a is also in line 2; each letter is allowed once");
}

TEST(Plan, LinesOfOtherLengthsAndSizesBeyondBoundsAreRefused) {
  EXPECT_EQ(complaint_of(""), "plan.txt: the drawing is empty");
  EXPECT_EQ(complaint_of("##\n\n##\n"), "plan.txt:2: 0 columns; 1 … 4096 are allowed");
  EXPECT_EQ(complaint_of("##\n##\n###\n"),
            "plan.txt:3: 3 columns; line 1 has 2, and all must have as many");
  EXPECT_EQ(complaint_of(std::string(4097, '.')), "plan.txt:1: 4097 columns; 1 … 4096 are allowed");
  std::string tall;
  for (int i = 0; i < 4096; ++i) tall += ".\n";
  EXPECT_EQ(complaint_of(tall), "no error");
  EXPECT_EQ(complaint_of(tall + "."), "plan.txt:4097: more than 4096 lines; no more are allowed");
  EXPECT_EQ(complaint_of("##\n##\n"), "plan.txt: all is wall; at least one cell must be free");
  for (const double cell : {0.0, -1.0, 1e-4, 20.5, std::nan("")}) {
    EXPECT_THAT(complaint_of(".", cell), testing::EndsWith("0.001 … 20 m are allowed"));
  }
}

TEST(Plan, AMissingFileIsNamed) {
  EXPECT_EQ(complaint([] { read_text("/nowhere/plan.txt", 1.0); }),
            "/nowhere/plan.txt: no such file");
  EXPECT_EQ(complaint([] { read_text("/", 1.0); }), "/: not a file");
}

TEST(Plan, NoiseInPlaceOfRoomsIsRefusedBeforeItFillsMemory) {
  Drawing d{.columns = 1200, .rows = 1200, .cell_m = 1.0, .walls = {}, .places = {}};
  for (int i = 0; i < 1200 * 1200; ++i) d.walls.push_back((i + i / 1200) % 2);
  EXPECT_THAT(complaint([&] { Plan{d}; }), testing::HasSubstr("more than 1000000 straight pieces"));
}

TEST(Plan, PlacesAreAddedToFreeCellsOnly) {
  Drawing d = parse_text("##\nA#\n", "p", 1.0);
  EXPECT_EQ(complaint([&] { d.add("door", {0.25, 0.75}); }), "no error");
  EXPECT_EQ(Plan(d).place("door"), (Point{0.25, 0.75}));
  EXPECT_THAT(complaint([&] { d.add("A", {0.5, 0.5}); }), testing::HasSubstr("is there twice"));
  EXPECT_THAT(complaint([&] { d.add("", {0.5, 0.5}); }), testing::HasSubstr("needs a name"));
  EXPECT_THAT(complaint([&] { d.add("w", {1.5, 0.5}); }), testing::HasSubstr("is in a wall"));
  for (const Point p : {Point{-0.1, 0.5}, Point{0.5, 2.0}, Point{std::nan(""), 0.5}}) {
    EXPECT_THAT(complaint([&] { d.add("out", p); }), testing::HasSubstr("not in the drawing"));
  }
  EXPECT_EQ(complaint([&] { Plan(d).place("Z"); }), "the plan has no place Z; it has A, door");
}

TEST(Plan, FreeWallsComeBehindTheFourOuterSides) {
  const Plan plan(4.0, 3.0, {{{1.0, 1.0}, {2.0, 2.5}}}, {{"home", {0.5, 0.5}}});
  ASSERT_EQ(plan.walls().size(), 5u);
  EXPECT_EQ(plan.walls()[4].to, (Point{2.0, 2.5}));
  EXPECT_EQ(plan.place("home"), (Point{0.5, 0.5}));
}

TEST(Plan, FreeWallsThatAreNoneAreRefused) {
  const auto of = [](double w, std::vector<Segment> walls, std::vector<Place> places) {
    return complaint([&] { Plan(w, 3.0, walls, places); });
  };
  EXPECT_EQ(of(4.0, {}, {}), "no error");
  EXPECT_THAT(of(0.0, {}, {}), testing::HasSubstr("must be above 0"));
  EXPECT_THAT(of(1e6, {}, {}), testing::HasSubstr("at most 100000 m"));
  EXPECT_THAT(of(std::nan(""), {}, {}), testing::HasSubstr("must be above 0"));
  EXPECT_THAT(of(4.0, {{{1, 1}, {1, 1}}}, {}), testing::StartsWith("wall 0 from"));
  EXPECT_THAT(of(4.0, {{{1, 1}, {2, 1}}, {{1, 1}, {5, 1}}}, {}),
              testing::StartsWith("wall 1 from"));
  EXPECT_THAT(of(4.0, {{{1, std::nan("")}, {2, 1}}}, {}), testing::StartsWith("wall 0 from"));
  EXPECT_THAT(of(4.0, {}, {{"A", {9, 9}}}), testing::HasSubstr("must lie within the plan"));
  EXPECT_THAT(of(4.0, {}, {{"A", {1, 1}}, {"A", {2, 2}}}), testing::HasSubstr("there twice"));
}

/// Whatever the bytes are, a plan comes out or an InputError.
TEST(Plan, DrawingsWithBytesChangedAreReadOrRefused) {
  const std::string good = "######\n#A.  #\n# ## #\n#   B#\n######\n";
  const std::string bytes = std::string("#. \n\rABz0\xff\t") + '\0';
  Stream stream(2, Purpose("bytes"), Entity{0});
  int read = 0, refused = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string text = good;
    for (std::uint64_t changes = 1 + stream.below(3); changes > 0; --changes) {
      const std::size_t at = stream.below(text.size());
      stream.bernoulli(0.9) ? text[at] = bytes[stream.below(bytes.size())]
                            : text.erase(at, 1 + stream.below(7))[0];
      if (text.empty()) break;
    }
    try {
      const Plan plan(parse_text(text, "p", 1.0));
      for (const Place& place : plan.places()) EXPECT_TRUE(plan.contains(place.at));
      ++read;
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(read, 300);
  EXPECT_GT(refused, 300);
}

}  // namespace
}  // namespace hearsay::plan
