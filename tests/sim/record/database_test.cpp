#include "sim/record/database.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sample.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using sample::query;

TEST(Database, ViewsShowARunByTheNamesOfTheDesign) {
  const sample::Directory directory;
  const std::string file = sample::make(directory, "a.db", 1);
  EXPECT_EQ(query(file,
                  "SELECT id, study, scenario, parameters, repetition, seed, status, reason, "
                  "config_hash, wall_s, events, version FROM run"),
            "1|rumour|ring.toml|{\"agents.estimator.fusion\":\"ci-det\"}|1|101|ok|time reached|" +
                text_digest("config 1") + "|0.25|1001|0.1.0\n");
  EXPECT_EQ(query(file, "SELECT id, name, file, config FROM study"),
            "1|rumour|/somewhere/study.toml|repetitions = 3\nseed = 1\n\n");
  EXPECT_EQ(query(file, "SELECT run, name, value FROM axis"), "1|rule|\"ci-det\"\n1|loss|0.1\n");
  EXPECT_EQ(query(file, "SELECT run, id, name, kind FROM agent"),
            "1|-1|agent -1|central\n1|0|agent 0|estimator\n1|1|agent 1|estimator\n");
  EXPECT_EQ(query(file, "SELECT run, agent, name, value FROM scalar"),
            "1|0|fusions|1.0\n1|-1|state_dimension|2.0\n");
  EXPECT_EQ(query(file, "SELECT run, t_s, agent, subject, name, value FROM series LIMIT 3"),
            "1|20.0|-1|alarm|nees|0.857142857142857\n1|20.0|-1|alarm|mood 1|6.66666666666667\n"
            "1|20.0|0|alarm|nees|1.0\n");
  EXPECT_EQ(query(file,
                  "SELECT run, sent_s, arrived_s, sender, receiver, kind, bytes, fate "
                  "FROM message"),
            "1|20.0|20.01|0|1|belief|48|lost\n1|40.0|40.01|0|1|belief|48|lost\n");
  EXPECT_EQ(query(file, "SELECT run, t_s, agent, kind, detail FROM event"),
            "1|20.0|NULL|overflow|at 1\n1|40.0|NULL|overflow|at 1\n");
}

TEST(Database, EveryViewHasTheColumnsOfTheDesignInTheirOrder) {
  const sample::Directory directory;
  const std::string file = sample::make(directory, "a.db", 0);
  const auto columns = [&](const std::string& table) {
    return query(file, "SELECT group_concat(name, ' ') FROM pragma_table_info('" + table + "')");
  };
  EXPECT_EQ(columns("study"), "id name file config\n");
  EXPECT_EQ(columns("run"),
            "id study scenario parameters repetition seed status reason digest config_hash wall_s "
            "events version\n");
  EXPECT_EQ(columns("axis"), "run name value\n");
  EXPECT_EQ(columns("agent"), "run id name kind\n");
  EXPECT_EQ(columns("scalar"), "run agent name value\n");
  EXPECT_EQ(columns("series"), "run t_s agent subject name value\n");
  EXPECT_EQ(columns("message"), "run sent_s arrived_s sender receiver kind bytes fate\n");
  EXPECT_EQ(columns("event"), "run t_s agent kind detail\n");
}

TEST(Database, AQueryFindsTheSameRowsByRunAsByAnyOtherColumn) {
  const sample::Directory directory;
  const std::string file = sample::make(directory, "a.db", 12);
  EXPECT_EQ(query(file, "SELECT count(*), min(t_s), max(t_s) FROM series WHERE run = 7"),
            "12|20.0|40.0\n");
  EXPECT_EQ(query(file, "SELECT count(*) FROM series WHERE name = 'nees' AND t_s = 40"), "36\n");
  EXPECT_EQ(query(file,
                  "SELECT count(*) FROM series JOIN axis USING(run) "
                  "WHERE axis.name = 'rule' AND axis.value = '\"naive\"' AND series.agent = 0"),
            "16\n");  // runs 3, 6, 9, 12; two names at two instants
  EXPECT_EQ(query(file, "SELECT group_concat(run) FROM scalar WHERE name = 'fusions'"),
            "1,2,3,4,5,6,7,8,9,10,11,12\n");
}

TEST(Database, DoublesComeBackBitForBitAndNanAsNull) {
  const sample::Directory directory;
  const std::string file = directory / "a.db";
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> values = {0.1,      1.0 / 3,   5e-324,    1.7976931348623157e308,
                                      -1e300,   1e15 + 1., 1ll << 53, -3.0,
                                      infinity, -infinity};
  {
    Record record({});
    const NameId name = record.name("x");
    for (const double value : values) record.series(Time(), 0, name, name, value);
    record.series(Time(), 0, name, name, -0.0);
    record.series(Time(), 0, name, name, std::nan(""));
    DatabaseWriter writer(file);
    writer.add({}, record);
    writer.close();
  }
  SQLite::Database database(file);
  SQLite::Statement rows(database, "SELECT value, typeof(value) FROM series");
  for (const double value : values) {
    ASSERT_TRUE(rows.executeStep());
    EXPECT_EQ(rows.getColumn(0).getDouble(), value);
    EXPECT_EQ(rows.getColumn(1).getString(), "real");
  }
  ASSERT_TRUE(rows.executeStep());
  EXPECT_FALSE(std::signbit(rows.getColumn(0).getDouble()));
  ASSERT_TRUE(rows.executeStep());
  EXPECT_TRUE(rows.getColumn(0).isNull());
}

TEST(Database, TimesAreTheNearestDoubleToTheirNanoseconds) {
  const sample::Directory directory;
  const std::string file = directory / "a.db";
  {
    Record record({});
    const NameId name = record.name("x");
    for (const Duration since : {60_s, 120_s, 10_ms, 29_s + 300_ms}) {
      record.series(Time::at(since), 0, name, name, 1.0);
    }
    DatabaseWriter writer(file);
    writer.add({}, record);
    writer.close();
  }
  SQLite::Database database(file);
  SQLite::Statement rows(database, "SELECT t_s FROM series");
  for (const double expected : {60.0, 120.0, 0.01, 29.3}) {
    ASSERT_TRUE(rows.executeStep());
    EXPECT_EQ(rows.getColumn(0).getDouble(), expected);
  }
}

TEST(Database, ASeedAboveTwoToThe63IsStoredAsSignedWithTheSameBits) {
  const sample::Directory directory;
  const std::string file = directory / "a.db";
  const std::uint64_t seed = 0xfedcba9876543210;
  {
    DatabaseWriter writer(file);
    RunRow run;
    run.seed = seed;
    writer.add(run, Record({}));
    writer.close();
  }
  SQLite::Database database(file);
  EXPECT_EQ(static_cast<std::uint64_t>(database.execAndGet("SELECT seed FROM run").getInt64()),
            seed);
}

TEST(Database, ARunIsVisibleToOthersFromItsCommitOn) {
  const sample::Directory directory;
  const std::string file = directory / "a.db";
  DatabaseWriter writer(file);
  writer.add_study(sample::study);
  sample::add(writer, 1);
  EXPECT_EQ(query(file, "SELECT count(*) FROM run"), "0\n");
  writer.commit();
  sample::add(writer, 2);
  EXPECT_EQ(query(file, "SELECT count(*), max(id) FROM run"), "1|1\n");
  EXPECT_EQ(writer.run_ids(), (std::set<std::int64_t>{1, 2}));
}

TEST(Database, WhatWasNotCommittedIsNotThere) {
  const sample::Directory directory;
  const std::string file = directory / "a.db";
  {
    DatabaseWriter writer(file);
    writer.add_study(sample::study);
    sample::add(writer, 1);
    writer.commit();
    sample::add(writer, 2);
  }
  EXPECT_EQ(query(file, "SELECT count(*) FROM run"), "1\n");
  EXPECT_EQ(query(file, "SELECT count(DISTINCT run) FROM series"), "1\n");
}

TEST(Database, AClosedFileStandsAlone) {
  const sample::Directory directory;
  sample::make(directory, "a.db", 3);
  EXPECT_EQ(directory.files(), std::vector<std::string>{"a.db"});
}

TEST(Database, KnowsWhichRunsItHas) {
  const sample::Directory directory;
  DatabaseWriter writer(sample::make(directory, "a.db", 9));
  EXPECT_EQ(writer.run_ids(), (std::set<std::int64_t>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(writer.failed_run_ids(), (std::set<std::int64_t>{4, 8}));
  EXPECT_EQ(writer.next_run_id(), 10);
  EXPECT_EQ(writer.config_hash(3), text_digest("config 3"));
  EXPECT_EQ(writer.config_hash(10), std::nullopt);
}

TEST(Database, RunsMayNotBeAddedOutOfOrderOrTwice) {
  const sample::Directory directory;
  DatabaseWriter writer(directory / "a.db");
  writer.add_study(sample::study);
  sample::add(writer, 5);
  EXPECT_THROW(sample::add(writer, 5), BrokenInvariant);
  EXPECT_THROW(sample::add(writer, 4), BrokenInvariant);
  EXPECT_THROW(sample::add(writer, 0), BrokenInvariant);
  sample::add(writer, 6);  // a refused run spoils nothing
  EXPECT_EQ(writer.run_ids(), (std::set<std::int64_t>{5, 6}));
}

TEST(Database, ARunOfAStudyThatIsNotThereIsRefused) {
  const sample::Directory directory;
  DatabaseWriter writer(directory / "a.db");
  EXPECT_THROW(sample::add(writer, 1), BrokenInvariant);
}

TEST(Database, ARemovedRunTakesAllItsRowsAndNoOthers) {
  const sample::Directory directory;
  const std::string file = sample::make(directory, "a.db", 3);
  DatabaseWriter writer(file);
  writer.remove_run(2);
  writer.remove_run(77);  // is not there
  writer.close();
  for (const char* table : {"series", "scalar", "message", "event", "axis", "agent"}) {
    EXPECT_EQ(query(file, std::string("SELECT group_concat(DISTINCT run) FROM ") + table), "1,3\n")
        << table;
  }
}

TEST(Database, ARemovedRunAddedAgainLeavesTheSameContent) {
  const sample::Directory directory;
  const std::string untouched = sample::make(directory, "a.db", 6);
  const std::string retried = sample::make(directory, "b.db", 6);
  {
    DatabaseWriter writer(retried);
    for (const std::int64_t id : {6, 2, 4}) writer.remove_run(id);
    writer.close();
  }
  {
    DatabaseWriter writer(retried);  // killed and started again in between
    EXPECT_EQ(writer.next_run_id(), 7);
    EXPECT_THROW(sample::add(writer, 5), BrokenInvariant);
    for (const std::int64_t id : {2, 4, 6}) sample::add(writer, id);
    EXPECT_THROW(sample::add(writer, 4), BrokenInvariant);
    writer.close();
  }
  EXPECT_EQ(first_difference(untouched, retried, {}), std::nullopt);
  EXPECT_EQ(sample::everything(untouched), sample::everything(retried));
}

TEST(Database, ListsOfAgentsAndAxesAreStoredOnce) {
  const sample::Directory directory;
  const std::string file = sample::make(directory, "a.db", 9);
  EXPECT_EQ(query(file, "SELECT count(*) FROM agent_set"), "3\n");
  EXPECT_EQ(query(file, "SELECT count(*) FROM axis_set"), "4\n");  // two lists of two
  EXPECT_EQ(query(file, "SELECT count(*) FROM agent"), "27\n");
}

TEST(Database, AStudyMayBeAddedAgainOnlyUnchanged) {
  const sample::Directory directory;
  const std::string file = sample::make(directory, "a.db", 1);
  DatabaseWriter writer(file);
  writer.add_study(sample::study);
  StudyRow other = sample::study;
  other.config += "repetitions = 4\n";
  try {
    writer.add_study(other);
    FAIL() << "taken";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              file +
                  ": has results of another version of the study 'rumour'; write to another "
                  "file, or remove this one");
  }
  sample::add(writer, 2);  // still usable
}

TEST(Database, AClosedWriterTakesNothingMore) {
  const sample::Directory directory;
  DatabaseWriter writer(directory / "a.db");
  writer.close();
  EXPECT_THROW(writer.add({}, Record({})), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
