// radio.contacts: traces in CSV files.
#include "scenarios/contacts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenarios/links.hpp"
#include "temp_files.hpp"

namespace hearsay {
namespace {

using testing::ElementsAre;

const std::string scenario_file =
    "duration_s = 9\nradio = { topology = \"contacts\", contacts = \"trace.csv\" }\n"
    "[[agents]]\nname = \"base\"\n[[agents]]\nname = \"uav\"\ncount = 2\n";

Time at(std::int64_t ms) { return Time::at(Duration::nanoseconds(ms * 1'000'000)); }

class Contacts : public InTempDirectory {
 protected:
  static Scenario load(const std::string& rows) {
    write("s.toml", scenario_file);
    write("trace.csv", "t_s,a,b,state\n" + rows);
    return load_scenario("s.toml", {}, {});
  }
  static std::string error(const std::string& rows) {
    return error_of([&] { load(rows); });
  }
};

TEST_F(Contacts, AgentsStandThereByNameOrNumberInEitherOrder) {
  const Scenario s = load("0,base,uav1,up\n0.5,2,base,down\n0.5,uav1,1,up\n");
  EXPECT_THAT(*s.radio.contact_trace,
              ElementsAre(LinkChange{at(0), 0, 2, true}, LinkChange{at(500), 0, 2, false},
                          LinkChange{at(500), 1, 2, true}));
}

TEST_F(Contacts, BecomeAPlan) {
  const Scenario s = load("0,0,2,up\n0.5,0,2,down\n0.5,1,2,up\n");
  const LinkPlan plan = make_link_plan(s, agent_positions(s), 1);
  EXPECT_EQ(plan.topology.agents(), 3);
  EXPECT_EQ(plan.topology.links(), 4u);
  EXPECT_THAT(plan.changes,
              ElementsAre(LinkChange{at(0), 1, 2, false}, LinkChange{at(500), 0, 2, false},
                          LinkChange{at(500), 1, 2, true}));
}

TEST_F(Contacts, ATraceWithoutRowsIsSilence) {
  const Scenario s = load("");
  EXPECT_EQ(make_link_plan(s, agent_positions(s), 1).topology.links(), 0u);
}

TEST_F(Contacts, AnUnknownAgentIsNamed) {
  EXPECT_EQ(error("0,base,uav2,up\n"),
            "trace.csv:2: b = \"uav2\": there is no such agent; did you mean 'uav0'?");
  EXPECT_EQ(error("0,3,base,up\n"), "trace.csv:2: a = 3: there is no agent 3; they are 0 … 2");
  EXPECT_EQ(error("0,-1,base,up\n"), "trace.csv:2: a = -1: there is no such agent");
  EXPECT_EQ(error("0,1.0,base,up\n"), "trace.csv:2: a = 1.0: there is no such agent");
  EXPECT_EQ(error("0,,base,up\n"), "trace.csv:2: a = \"\": there is no such agent");
  EXPECT_EQ(error("0,99999999999999999999,base,up\n"),
            "trace.csv:2: a = 99999999999999999999: there is no agent 99999999999999999999; they "
            "are 0 … 2");
}

TEST_F(Contacts, NobodyMeetsItself) {
  EXPECT_EQ(error("0,base,0,up\n"), "trace.csv:2: b = 0: is the same agent as a");
}

TEST_F(Contacts, TimesAreSorted) {
  EXPECT_EQ(error("3,0,1,up\n# note\n2.5,0,1,down\n"),
            "trace.csv:4: t_s = 2.5: must not be before the time on line 2; rows are sorted by "
            "time");
  EXPECT_EQ(error("-0.5,0,1,up\n"), "trace.csv:2: t_s = -0.5: must be at least 0");
  EXPECT_EQ(error("2e9,0,1,up\n"), "trace.csv:2: t_s = 2e9: must be at most 1000000000");
  EXPECT_EQ(error("now,0,1,up\n"), "trace.csv:2: t_s = \"now\": must be a number");
}

TEST_F(Contacts, AStateIsUpOrDown) {
  EXPECT_EQ(error("0,0,1,on\n"), "trace.csv:2: state = \"on\": must be up or down");
  EXPECT_EQ(error("0,0,1,UP\n"), "trace.csv:2: state = \"UP\": must be up or down");
}

TEST_F(Contacts, APairGoesUpAndDownInTurn) {
  EXPECT_EQ(error("0,0,1,up\n1,0,2,up\n2,1,0,up\n"),
            "trace.csv:4: state = \"up\": the pair is up already since line 2");
  EXPECT_EQ(error("0,0,1,up\n1,0,1,down\n2,0,1,down\n"),
            "trace.csv:4: state = \"down\": the pair is down already since line 3");
  EXPECT_EQ(error("0,0,1,down\n"),
            "trace.csv:2: state = \"down\": the pair is down already; a pair begins with up");
}

TEST_F(Contacts, AFileWithoutTheColumnsIsNamed) {
  write("s.toml", scenario_file);
  EXPECT_EQ(error_of([] { load_scenario("s.toml", {}, {}); }), "trace.csv: there is no such file");
  write("trace.csv", "time,a,b,state\n");
  EXPECT_EQ(error_of([] { load_scenario("s.toml", {}, {}); }),
            "trace.csv:1: there is no column 't_s'; the header has: time, a, b, state");
}

TEST_F(Contacts, AreMeantFromTheScenarioFileButWithSetAsGiven) {
  std::filesystem::create_directories("deep/er");
  write("deep/er/s.toml", scenario_file);
  write("deep/er/trace.csv", "t_s,a,b,state\n");
  EXPECT_EQ(load_scenario("deep/er/s.toml", {}, {}).radio.contacts, "deep/er/trace.csv");
  write("other.csv", "t_s,a,b,state\n0,0,1,up\n");
  const Scenario other = load_scenario("deep/er/s.toml", sets({"radio.contacts=other.csv"}), {});
  EXPECT_EQ(other.radio.contacts, "other.csv");
  EXPECT_EQ(other.radio.contact_trace->size(), 1u);
}

TEST_F(Contacts, AreMeantFromTheStudyFileThatNamesThem) {
  std::filesystem::create_directories("deep");
  write("s.toml", scenario_file);
  write("trace.csv", "t_s,a,b,state\n");
  write("deep/one.csv", "t_s,a,b,state\n0,0,1,up\n");
  write("deep/s.study.toml",
        "scenario = \"../s.toml\"\n[axes]\ntrace = { key = \"radio.contacts\", values = "
        "[\"one.csv\", \"../trace.csv\"] }\n");
  const Study study = load_study("deep/s.study.toml", {});
  const auto all = cells(study);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(load_scenario(study.scenario_file, all[0].set, {}).radio.contacts, "deep/one.csv");
  EXPECT_EQ(load_scenario(study.scenario_file, all[1].set, {}).radio.contacts, "trace.csv");
}

}  // namespace
}  // namespace hearsay
