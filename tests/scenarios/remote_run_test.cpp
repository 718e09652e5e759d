// Agents that live elsewhere, in lockstep with their world, do what they do within one process: the
// same digest.
#include <gtest/gtest.h>

#include "tests/scenarios/elsewhere_bed.hpp"

namespace hearsay {
namespace {

std::shared_ptr<const PreparedScenario> prepared_of(const std::string& file,
                                                    const std::vector<Override>& set = {}) {
  static const Catalog catalog;
  LogCache logs;
  return prepare(load_scenario(file, set, known_names(catalog)), catalog, logs);
}

void expect_same(const std::string& file, const std::vector<Override>& set = {}) {
  SCOPED_TRACE(file);
  expect_same(prepared_of(std::string(HEARSAY_SOURCE_DIR) + "/" + file, set));
}

using Set = std::vector<Override>;

TEST(RemoteRun, HasTheDigestOfTheRunInOneProcess) {
  for (const char* rule : {"\"naive\"", "\"channel-robust\"", "\"ci-det\"", "\"split-ci\"",
                           "\"hybrid-consensus\"", "\"ci-batch\"", "\"none\""}) {
    SCOPED_TRACE(rule);
    expect_same("scenarios/rumour/rumour.toml",
                Set{{"duration_s", "40.0"}, {"agents.estimator.fusion", rule}});
  }
}

TEST(RemoteRun, HasItForStatesThatMoveAndForTrajectoriesWithTheirLedgers) {
  expect_same("scenarios/merino/ch3-track.toml", Set{{"duration_s", "30.0"}});
  expect_same("scenarios/merino/ch3-window.toml", Set{{"duration_s", "60.0"}});
  expect_same("scenarios/merino/ch3-track.toml",
              Set{{"duration_s", "30.0"},
                  {"agents.estimator.kind", "\"moving-gaussian\""},
                  {"agents.estimator.fusion", "\"ci-det\""}});
}

TEST(RemoteRun, HasItWhereAgentsMoveAndTalkByStoreAndForward) {
  expect_same("scenarios/rumour/mule.toml", Set{{"duration_s", "120.0"}});
  expect_same("scenarios/rumour/mule.toml",
              Set{{"duration_s", "120.0"}, {"agents.talk.service", "\"store-and-forward\""}});
}

TEST(RemoteRun, HasItWhereAgentsFailAndComeBack) {
  for (const char* kind : {"sleep", "reboot"}) {
    const std::string dropouts =
        "[{ kind = \"" + std::string(kind) + "\", mean_up_s = 10.0, mean_down_s = 5.0 }]";
    expect_same("scenarios/rumour/rumour.toml",
                Set{{"duration_s", "40.0"}, {"dropouts", dropouts}});
  }
}

TEST(RemoteRun, HasItForSourcesThatWantToKnowWhenTheirQueueIsEmpty) {
  expect_same("scenarios/radio/shared.toml", Set{{"duration_s", "2.0"}});
  expect_same("scenarios/radio/delay.toml", Set{{"duration_s", "2.0"}});
}

TEST(RemoteRun, HasItForRobotsThatLayAndFollowTrails) {
  const Set all_series{{"duration_s", "120.0"},
                       {"record.series", R"(["trips_so_far", "trips_an_hour", "crumbs_alive",
                         "crumb_error_m", "crumbs_wrong_share", "hearsay_hops_mean", "robot_x_m",
                         "trip_length_m"])"},
                       {"record.crumbs", "\"on\""}};
  expect_same("scenarios/lost/corridor.toml", all_series);
  expect_same("scenarios/lost/convergence.toml", Set{{"duration_s", "60.0"}});
  expect_same("scenarios/lost/crowding.toml", Set{{"duration_s", "40.0"}, {"agents.count", "6"}});
  for (const char* navigation : {"explore", "map"}) {
    Set other = all_series;
    other.push_back({"agents.trails.navigation", '"' + std::string(navigation) + '"'});
    expect_same("scenarios/lost/corridor.toml", other);
  }
}

TEST(RemoteRun, HasItForRobotsThatFailAndComeBack) {
  for (const char* kind : {"sleep", "reboot"}) {
    const std::string dropouts =
        "[{ kind = \"" + std::string(kind) + "\", mean_up_s = 40.0, mean_down_s = 20.0 }]";
    expect_same("scenarios/lost/corridor.toml",
                Set{{"duration_s", "100.0"}, {"dropouts", dropouts}});
  }
}

TEST(RemoteRun, HasItForTrackers) {
  expect_same("scenarios/tracking/crossing.toml", Set{{"duration_s", "60.0"}});
  expect_same("scenarios/tracking/crossing.toml",
              Set{{"duration_s", "60.0"}, {"agents.tracker.trail_s", "5.0"}});
}

TEST(RemoteRun, HasItForExplorersWithAndWithoutLedgers) {
  for (const char* ledger : {"\"on\"", "\"off\""}) {
    SCOPED_TRACE(ledger);
    const Set set{{"duration_s", "50.0"}, {"record.ledger", ledger}};
    for (const char* file : {"explore", "beta", "search", "mow"}) {
      expect_same("scenarios/merino/ch4-" + std::string(file) + ".toml", set);
    }
  }
}

}  // namespace
}  // namespace hearsay
