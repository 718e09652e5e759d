// world.area.heights: heights of cells in CSV files.
#include "scenarios/heights.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/scenarios/explorer_bed.hpp"

namespace hearsay {
namespace {

const std::string scenario = R"(duration_s = 30
[world]
area = { columns = 3, rows = 2, cell_m = 5.0, heights = "hills.csv" }
targets = [{ name = "alarm", position_m = [12.5, 7.5] }]
[radio]
topology = "full"
[record]
series = ["cells_detected_share"]
[[agents]]
kind = "explorer"
position_m = [2.5, 2.5]
motion = { kind = "steered", altitude_m = 20 }
exploration = { speed_m_per_s = 5 }
sensor = { kind = "presence", detector = "infrared", range_max_m = 60, angle_max_rad = 0.9 }
talk = { policy = "never" }
)";
const std::string header = "x0,x1,x2\n";

class Heights : public ExplorerBed {
 protected:
  std::string with_file(const std::string& content) {
    write("hills.csv", content);
    return error(scenario);
  }
};

TEST_F(Heights, StandLikeAMapWithTheFarRowFirst) {
  EXPECT_EQ(with_file("# a hill\n" + header + "4,5,6\n1,2.5,-3\n"), "no error");
  const auto loaded = load_scenario("s.toml", {}, {});
  const grid::Relief& relief = *loaded.world.area->relief;
  const double expected[] = {1, 2.5, -3, 4, 5, 6};
  for (int cell = 0; cell < 6; ++cell) EXPECT_EQ(relief.height_m(cell), expected[cell]);
  EXPECT_EQ(with_file("x2,x0,x1\n6,4,5\n-3,1,2.5\n"), "no error");  // columns by their names
  const auto again = load_scenario("s.toml", {}, {});
  for (int cell = 0; cell < 6; ++cell) {
    EXPECT_EQ(again.world.area->relief->height_m(cell), expected[cell]);
  }
}

TEST_F(Heights, OfAnotherSizeAreRefused) {
  EXPECT_EQ(with_file("x0,x1\n1,2\n1,2\n"),
            "hills.csv:1: there is no column 'x2'; the header has: x0, x1");
  EXPECT_EQ(with_file("x0,x1,x2,x3\n1,2,3,4\n1,2,3,4\n"),
            "hills.csv: has a column 'x3', but world.area.columns is 3");
  EXPECT_EQ(with_file(header + "1,2,3\n"),
            "hills.csv: number of rows is 1, but world.area.rows is 2");
  EXPECT_EQ(with_file(header + "1,2,3\n1,2,3\n1,2,3\n"),
            "hills.csv: number of rows is 3, but world.area.rows is 2");
  EXPECT_EQ(with_file(header + "1,2,3\n1,2\n"),
            "hills.csv:3: number of fields is 2; the header has 3");
  EXPECT_EQ(with_file("1,2,3\n1,2,3\n"),
            "hills.csv:1: there is no column 'x0'; the header has: 1, 2, 3");
}

TEST_F(Heights, ThatAreNoneAreRefused) {
  EXPECT_EQ(with_file(header + "1,2,3\n1,,3\n"), "hills.csv:3: x1 = \"\": must be a number");
  EXPECT_EQ(with_file(header + "1,2,high\n1,2,3\n"),
            "hills.csv:2: x2 = \"high\": must be a number");
  EXPECT_EQ(with_file(header + "1,2,3\ninf,2,3\n"),
            "hills.csv:3: x0 = inf: must be a finite number");
  EXPECT_EQ(with_file(header + "1,2,3\n-2e6,2,3\n"),
            "hills.csv:3: x0 = -2e6: must be within ±1e6 m");
  EXPECT_EQ(error(with(scenario, "hills.csv", "")),
            "s.toml:3: world.area.heights: missing; which CSV file x0,x1,x2 and so on");
  EXPECT_EQ(error(with(scenario, "hills.csv", "no.csv")), "no.csv: there is no such file");
}

TEST_F(Heights, AreBelowAllWhoLook) {
  EXPECT_EQ(with_file(header + "1,2,3\n1,20,3\n"),
            "hills.csv:3: x1 = 20: must be less than agents[0].motion.altitude_m (20.0 m)");
  EXPECT_EQ(with_file(header + "1,2,3\n1,19.9,3\n"), "no error");
  const std::string second =
      "[[agents]]\nkind = \"explorer\"\nposition_m = [2.5, 2.5]\n"
      "motion = { kind = \"hover\", altitude_m = 10 }\ntalk = { policy = \"never\" }\n";
  EXPECT_EQ(error(scenario + second), "no error");  // it has no sensor
  EXPECT_EQ(error(scenario + second +
                  "sensor = { kind = \"presence\", detector = \"infrared\", range_max_m = 60, "
                  "angle_max_rad = 0.9 }\n"),
            "hills.csv:3: x1 = 19.9: must be less than agents[1].motion.altitude_m (10.0 m)");
}

TEST_F(Heights, OfZeroChangeNothingAndOfAHillDo) {
  EXPECT_EQ(with_file(header + "0,0,0\n0,0,0\n"), "no error");
  const Values none = run(with(scenario, ", heights = \"hills.csv\"", ""));
  EXPECT_TRUE(run(scenario).digested == none.digested);
  write("hills.csv", header + "0,0,18\n0,0,18\n");
  EXPECT_FALSE(run(scenario).digested == none.digested);
}

TEST_F(Heights, AreFoundFromTheScenarioFile) {
  std::filesystem::create_directories("hilly");
  write("hilly/hills.csv", header + "1,2,3\n1,2,3\n");
  write("hilly/s.toml", scenario);
  EXPECT_EQ(load_scenario("hilly/s.toml", {}, {}).world.area->heights, "hilly/hills.csv");
  EXPECT_EQ(error_of([&] {
              load_scenario("hilly/s.toml", sets({"world.area.heights=\"hills.csv\""}), {});
            }),
            "hills.csv: there is no such file");
}

}  // namespace
}  // namespace hearsay
