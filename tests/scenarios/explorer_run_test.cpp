// Whole runs of explorers, from their files.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "scenarios/explorers.hpp"
#include "tests/scenarios/explorer_bed.hpp"

namespace hearsay {
namespace {

class ExplorerRun : public ExplorerBed {};

// Merino 2007, p. 85: one look of 0.7 by one of three. Each says once what it believes, one after
// another; the run ends before the third does.
const std::string hearsay_of_one = R"(duration_s = 2.5
[world]
area = { columns = 1, rows = 1, cell_m = 10.0 }
targets = [{ position_m = [5, 5] }]
[radio]
topology = "full"
[record]
series = ["cells_hearsay", "cells_detected_share", "multiplicity_max"]
grids = "on"
[[agents]]
kind = "explorer"
position_m = [5, 5]
motion = { kind = "hover", altitude_m = 20 }
sensor = { kind = "presence", p_detect = 0.7, p_false = 0.3, range_max_m = 1e7)"
                                   R"(, angle_max_rad = 1, end_s = 0 }
grid = { fusion = "RULE" }
talk = { phase_s = 1, period_s = 10 }
[[agents]]
kind = "explorer"
position_m = [5, 5]
motion = { kind = "hover" }
grid = { fusion = "RULE" }
talk = { phase_s = 2, period_s = 10 }
[[agents]]
kind = "explorer"
position_m = [5, 5]
motion = { kind = "hover" }
grid = { fusion = "RULE" }
talk = { phase_s = 3, period_s = 10 }
)";

TEST_F(ExplorerRun, OneOpinionHeardTwiceIsAnAlarmUnderNaiveAlone) {
  for (const std::string rule : {"naive", "maximum", "channel", "none"}) {
    const Values values = run(with(hearsay_of_one, "RULE", rule), 1);
    const double twice = 0.49 / 0.58;
    const auto p = [&](AgentId id) { return values.last(id, "cell_probability", "0,0"); };
    EXPECT_NEAR(p(central_agent), 0.7, 1e-6) << "of another seed the sensor may be wrong";
    EXPECT_NEAR(p(0), rule == "naive" ? twice : 0.7, 1e-6) << rule;  // hears its own from 1
    EXPECT_NEAR(p(1), rule == "none" ? 0.5 : 0.7, 1e-6) << rule;
    // On a triangle, what came by one side is not taken off what comes by the other.
    const double third = rule == "naive" || rule == "channel" ? twice : rule == "none" ? 0.5 : 0.7;
    EXPECT_NEAR(p(2), third, 1e-6) << rule;
    for (const AgentId id : {0, 1, 2}) {
      EXPECT_EQ(values.last(id, "cells_hearsay", "0.8"), p(id) > 0.8 ? 1.0 : 0.0) << rule << id;
      EXPECT_EQ(values.last(id, "cells_detected_share", "0.8"), p(id) > 0.8 ? 1.0 : 0.0);
    }
    EXPECT_EQ(values.scalar(2, "fusions"), rule == "none" ? 0.0 : 2.0);
    if (rule == "none") continue;
    EXPECT_EQ(values.last(2, "multiplicity_max"), third > 0.7001 ? 2.0 : 1.0) << rule;
  }
}

TEST_F(ExplorerRun, TheLedgerChangesNothing) {
  const std::string on = with(hearsay_of_one, "RULE", "naive");
  const std::string off = with(on, "[record]\n", "[record]\nledger = \"off\"\n");
  const Values with_ledger = run(on), without = run(off);
  EXPECT_TRUE(with_ledger.digested == without.digested);
  EXPECT_TRUE(with_ledger.series.contains({2, "multiplicity_max"}));
  EXPECT_FALSE(without.series.contains({2, "multiplicity_max"}));
}

/// Four who mow the lawn, each from a corner of its own, and look for 60 s.
const std::string mowers =
    R"(duration_s = 160
[world]
area = { columns = 10, rows = 10, cell_m = 5.0 }
targets = [{ position_m = [12.5, 12.5] }, { position_m = [37.5, 22.5] }, {}]
[radio]
topology = "star"
rate_bps = 100_000
queue_packets_max = 200
loss = { model = "bernoulli", probability = 0.3 }
[record]
series = ["kl_to_central_nats", "entropy_nats", "cells_hearsay")"
    R"(, "cells_detected_share", "cells_false_share", "disagreement_probability"]
series_period_s = 5
alarms = { thresholds = [0.2, 0.5, 0.8] }
[[agents]]
kind = "explorer"
count = 4
circle = { center_m = [25, 25], radius_m = 10 }
motion = { kind = "lawn-mower", altitude_m = 15, area_m = [[0, 0], [50, 50]])"
    R"(, lane_spacing_m = 10, speed_m_per_s = 5 }
sensor = { kind = "segmented-camera", p_detect = 0.8, p_false = 0.2, range_max_m = 60)"
    R"(, image_px = [24, 24], focal_px = [24, 24], center_px = [11.5, 11.5])"
    R"(, sigma_position_m = 0.5, end_s = 60 }
grid = { fusion = "channel-robust" }
talk = { period_s = 5, phase = "staggered" }
)";

TEST_F(ExplorerRun, ChannelRobustOnALossyTreeEndsAsTheCentralGrid) {
  for (const std::string grid :
       {"", ", message = \"runs\"", ", message = \"changed\", whole_every = 4",
        ", belief = \"beta\"", ", belief = \"beta\", packet_bytes_max = 64"}) {
    const Values values = run(with(mowers, "\"channel-robust\"", "\"channel-robust\"" + grid));
    for (AgentId id = 0; id < 4; ++id) {
      EXPECT_LT(values.last(id, "kl_to_central_nats"), 1e-3) << grid;
      EXPECT_GT(values.series.at({id, "kl_to_central_nats"}).at({60.0, ""}), 0.1) << grid;
      for (const char* threshold : {"0.2", "0.5", "0.8"}) {
        EXPECT_EQ(values.last(id, "cells_hearsay", threshold), 0.0) << grid;
      }
    }
    EXPECT_LT(values.last(central_agent, "disagreement_probability"), 1e-4) << grid;
    EXPECT_GT(values.scalar(0, "packets_lost"), 10.0);
  }
}

TEST_F(ExplorerRun, OnAFullGraphNaiveRaisesAlarmsOfHearsay) {
  const std::string full = with(mowers, "\"star\"", "\"full\"");
  const Values naive = run(with(full, "channel-robust", "naive"));
  double hearsay = 0.0;
  for (AgentId id = 0; id < 4; ++id) {
    for (const auto& [at, cells] : naive.series.at({id, "cells_hearsay"})) hearsay += cells;
    EXPECT_GT(naive.last(id, "kl_to_central_nats"), 1.0);
  }
  EXPECT_GT(hearsay, 0.0);
}

TEST_F(ExplorerRun, WhoFlyByThemselvesSeeTheSameUnderEveryRule) {
  const auto central = [&](const std::string& rule) {
    std::vector<double> entropies;
    const Values values = run(with(mowers, "channel-robust", rule));
    for (const auto& [at, h] : values.series.at({central_agent, "entropy_nats"})) {
      entropies.push_back(h);
    }
    return entropies;
  };
  const std::vector<double> none = central("none");
  EXPECT_EQ(none.size(), 33U);
  EXPECT_LT(none.back(), 0.5 * none.front());
  for (const std::string rule : {"naive", "channel", "maximum", "dictatorship", "linear-pool"}) {
    EXPECT_EQ(central(rule), none) << rule;
  }
}

TEST_F(ExplorerRun, AlarmsArePlausible) {
  const Values values = run(mowers);
  const auto share = [&](const std::string& name, const std::string& threshold) {
    return values.last(central_agent, name, threshold);
  };
  EXPECT_GE(share("cells_detected_share", "0.5"), 2.0 / 3.0);
  EXPECT_LE(share("cells_false_share", "0.8"), 0.08);
  // The lower the threshold, the more cells are over it.
  for (AgentId id = central_agent; id < 4; ++id) {
    for (const std::string name : {"cells_detected_share", "cells_false_share"}) {
      EXPECT_GE(values.last(id, name, "0.2"), values.last(id, name, "0.5"));
      EXPECT_GE(values.last(id, name, "0.5"), values.last(id, name, "0.8"));
    }
  }
  const double cells_a_look = values.scalar(0, "measurements") / 61.0;
  EXPECT_GT(cells_a_look, 4.0);  // 15 m over 15 m wide, that is 3 cells of 5 m; less at an edge
  EXPECT_LT(cells_a_look, 16.0);
  EXPECT_GT(values.scalar(central_agent, "cells_seen_share"), 0.95);
}

/// Those who are steered to where a look tells most.
const std::string greedy = R"(duration_s = 60
[world]
area = { columns = 8, rows = 8, cell_m = 5.0 }
targets = [{}, {}]
[radio]
topology = "full"
[record]
series = ["kl_to_central_nats", "place_x_m", "place_y_m", "alarms_false")"
                           R"(, "alarms_detected_share", "alarm_error_m"]
[[agents]]
kind = "explorer"
count = 3
position_m = [0, 0]
motion = { kind = "steered", altitude_m = 15 }
exploration = { speed_m_per_s = 5, vehicle = "holonomic" }
sensor = { kind = "segmented-camera", detector = "infrared", range_max_m = 60)"
                           R"(, image_px = [24, 24], focal_px = [24, 24], center_px = [11.5, 11.5] }
grid = { fusion = "naive" }
talk = { period_s = 5 }
)";

TEST_F(ExplorerRun, TheSameSeedGivesTheSameRun) {
  const Values first = run(greedy), again = run(greedy), other = run(greedy, 4);
  EXPECT_GT(first.digested.size(), 10'000U);
  EXPECT_TRUE(first.digested == again.digested);
  EXPECT_FALSE(first.digested == other.digested);
  EXPECT_FALSE(first.digested == run(with(greedy, "naive", "maximum")).digested);
}

TEST_F(ExplorerRun, WhoAreSteeredStayInTheAreaAndSeeMuchOfIt) {
  for (const std::string vehicle : {"holonomic", "constant-speed"}) {
    const Values values = run(with(greedy, "\"holonomic\"", "\"" + vehicle + "\""));
    // 5 m over sin(22.5°), where all turns lead out.
    const double out_m = vehicle == "holonomic" ? 0.0 : 13.1;
    for (AgentId id = 0; id < 3; ++id) {
      for (const char* name : {"place_x_m", "place_y_m"}) {
        for (const auto& [at, m] : values.series.at({id, name})) {
          EXPECT_GE(m, -out_m);
          EXPECT_LT(m, 40.0 + out_m);
        }
      }
      EXPECT_GT(values.scalar(id, "distance_flown_m"), 100.0) << vehicle;
    }
    EXPECT_GT(values.scalar(central_agent, "cells_seen_share"), 0.8) << vehicle;
  }
}

TEST_F(ExplorerRun, ATargetWithoutAPlaceIsAnywhereInTheAreaAnewInEachRun) {
  WorldSpec world;
  world.area = AreaSpec{.columns = 7, .rows = 3, .cell_m = 2.5, .origin_m = {-100.0, 40.0}};
  world.targets = {TargetSpec{}, TargetSpec{.position_m = std::vector{-99.0, 41.0}}, TargetSpec{}};
  const grid::Area area = area_of(world);
  std::set<int> cells;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const auto places = target_places_of(world, seed);
    ASSERT_EQ(places.size(), 3U);
    EXPECT_EQ(places[1].x_m, -99.0);
    EXPECT_NE(places[0].x_m, places[2].x_m);
    for (const grid::Point& place : places) {
      ASSERT_TRUE(area.at(place));
      cells.insert(*area.at(place));
    }
    // Others around it make no difference.
    WorldSpec alone = world;
    alone.targets.resize(1);
    EXPECT_EQ(target_places_of(alone, seed)[0].x_m, places[0].x_m);
  }
  EXPECT_EQ(cells.size(), 21U);  // none of 21 missed by 400: but once in 1e7
}

TEST_F(ExplorerRun, EachThresholdHasANameOfItsOwn) {
  const std::string one = with(hearsay_of_one, "RULE", "none");
  const Values values = run(
      with(one, "grids = \"on\"", "alarms = { thresholds = [1e-9, 0.5, 0.9999991, 0.9999992] }"));
  std::set<std::string> subjects;
  for (const auto& [at, value] : values.series.at({0, "cells_detected_share"})) {
    subjects.insert(at.second);
  }
  EXPECT_EQ(subjects, (std::set<std::string>{"1e-09", "0.5", "0.9999991", "0.9999992"}));
}

TEST_F(ExplorerRun, WhereThereIsNothingToBeFoundSharesAreMissing) {
  const std::string nothing = with(greedy, "targets = [{}, {}]", "");
  const Values values = run(nothing);
  EXPECT_TRUE(std::isnan(values.last(0, "alarms_detected_share", "0.8")));
  EXPECT_GE(values.last(0, "alarms_false", "0.8"), 0.0);
  EXPECT_FALSE(values.scalars.contains({0, "alarms_found_s"}));
  const std::string one = with(hearsay_of_one, "RULE", "none");
  const Values full = run(with(one, "\"cells_detected_share\"", "\"cells_false_share\""));
  EXPECT_TRUE(std::isnan(full.last(0, "cells_false_share", "0.8")));
}

// Whatever a file may say, the run comes to its end.
TEST_F(ExplorerRun, ExtremesAreBorne) {
  const std::string brief = with(greedy, "duration_s = 60", "duration_s = 6");
  const std::string lens =
      "range_max_m = 60, image_px = [24, 24], focal_px = [24, 24], center_px = [11.5, 11.5]";
  for (const std::string other :
       {"range_max_m = 15.000000000000002", "range_max_m = 1e308",
        "range_max_m = 60, image_px = [1, 1]", "range_max_m = 60, focal_px = [1e-300, 1e300]",
        "range_max_m = 60, focal_px = [1e-310, 1]", "range_max_m = 60, center_px = [1e308, -1e308]",
        "range_max_m = 60, depression_rad = 0.01", "range_max_m = 60, sigma_position_m = 1e300",
        "range_max_m = 60, sigma_attitude_rad = 1e300", "range_max_m = 60, sigma_pixel = 1e300",
        "range_max_m = 60, sigma_position_m = 0, sigma_attitude_rad = 0"}) {
    EXPECT_EQ(end_of(with(brief, lens, other)), "") << other;
  }
  const std::string camera = "kind = \"segmented-camera\", detector = \"infrared\", " + lens;
  for (const std::string angle : {"1e-320", "1e-160", "3.1415926535897931"}) {
    EXPECT_EQ(end_of(with(brief, camera,
                          "kind = \"presence\", p_detect = 0.999999, p_false = 0.000001, "
                          "range_max_m = 1e308, angle_max_rad = " +
                              angle)),
              "")
        << angle;
  }
  for (const std::string grid :
       {"fusion = \"linear-pool\", prior = 0.000001", "fusion = \"naive\", log_odds_max = 1e-300",
        "belief = \"beta\", fusion = \"naive\", prior_alpha = 0.000001, prior_beta = 1e6",
        "belief = \"beta\", fusion = \"dictatorship\", prior_alpha = 1e6, prior_beta = 1e6",
        "belief = \"beta\", fusion = \"channel\", packet_bytes_max = 64, message = \"runs\""}) {
    EXPECT_EQ(end_of(with(brief, "fusion = \"naive\"", grid)), "") << grid;
  }
}

TEST_F(ExplorerRun, ExtremeWaysAreBorne) {
  const std::string brief = with(greedy, "duration_s = 60", "duration_s = 6");
  const std::string way = "speed_m_per_s = 5, vehicle = \"holonomic\"";
  for (const std::string other :
       {"speed_m_per_s = 5e-9", "speed_m_per_s = 5, gain_weight = 1e9, cost_weight = 1e9",
        "speed_m_per_s = 5, horizon_cells = 4096", "speed_m_per_s = 5, gain_weight = 0",
        "speed_m_per_s = 50, vehicle = \"constant-speed\", turn_max_rad = 0.001",
        "speed_m_per_s = 5, vehicle = \"constant-speed\", turn_max_rad = 3.14, headings = 63"}) {
    EXPECT_EQ(end_of(with(brief, way, other)), "") << other;
  }
  EXPECT_EQ(end_of(with(brief, "position_m = [0, 0]", "position_m = [39.999999999999993, 0]")), "");
  // One cell of 100000 km that one who can hardly turn leaves by far.
  const std::string wide = with(
      with(brief, "columns = 8, rows = 8, cell_m = 5.0", "columns = 1, rows = 1, cell_m = 1e8"),
      way, "speed_m_per_s = 1e10, vehicle = \"constant-speed\", turn_max_rad = 0.001");
  EXPECT_EQ(end_of(with(with(wide, "count = 3", "count = 1"), "duration_s = 6", "duration_s = 33")),
            "");
  // Cells that doubles cannot tell apart.
  const std::string far = with(brief, "cell_m = 5.0", "cell_m = 1e-9, origin_m = [1e8, 1e8]");
  EXPECT_EQ(end_of(with(with(far, "position_m = [0, 0]", "position_m = [1e8, 1e8]"), way,
                        "speed_m_per_s = 1e-9")),
            "");
}

TEST_F(ExplorerRun, WhoFailIsBorne) {
  for (const std::string kind : {"die", "sleep", "reboot"}) {
    const std::string until = kind == "die" ? "" : "mean_down_s = 3\n";
    const std::string drops = "[[dropouts]]\nkind = \"" + kind + "\"\nmean_up_s = 7\n" + until;
    for (const std::string rule : {"channel", "channel-robust\", message = \"changed"}) {
      EXPECT_EQ(end_of(with(greedy, "naive", rule) + drops), "") << kind << rule;
    }
  }
}

}  // namespace
}  // namespace hearsay
