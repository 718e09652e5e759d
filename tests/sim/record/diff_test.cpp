#include <gtest/gtest.h>

#include "sample.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

/// First difference of two equal databases of 9 runs, of which the second was changed by `sql`.
std::string after(const std::string& sql, const DiffOptions& options = {}) {
  const sample::Directory directory;
  const std::string a = sample::make(directory, "a.db", 9);
  const std::string b = sample::make(directory, "b.db", 9);
  sample::change(b, sql);
  return first_difference(a, b, options).value_or("none");
}

/// Id of the row at `place` of a run.
std::string row_id(int run, int place) {
  return std::to_string((std::int64_t{run} << 32) + place - 1);
}

TEST(Diff, OfEqualDatabasesIsNothing) { EXPECT_EQ(after("SELECT 1"), "none"); }

TEST(Diff, DoesNotCountWallTimesAndPaths) {
  EXPECT_EQ(after("UPDATE run_row SET wall_s = 9; UPDATE study SET file = 'elsewhere'"), "none");
}

TEST(Diff, NamesTheFirstValueThatDiffersAndBothInFull) {
  EXPECT_EQ(after("UPDATE series_row SET value = 1.2500000000000002 WHERE id >= " + row_id(7, 5)),
            "run 7 series t_s=20 agent=1 subject=alarm name=nees: 7.142857142857143 | "
            "1.2500000000000002");
}

TEST(Diff, SeesTheLastBit) {
  const double next = std::nextafter(6.0, 7.0);
  EXPECT_EQ(next, 6.000000000000001);
  EXPECT_EQ(after("UPDATE series_row SET value = 6.000000000000001 WHERE id = " + row_id(6, 3)),
            "run 6 series t_s=20 agent=0 subject=alarm name=nees: 6 | 6.000000000000001");
}

TEST(Diff, TellsNullFromZero) {
  EXPECT_EQ(after("UPDATE scalar_row SET value = NULL WHERE id = " + row_id(2, 1)),
            "run 2 scalar agent=0 name=fusions: 2 | NULL");
}

TEST(Diff, TakesTheEarliestInSimulatedTimeOfARun) {
  EXPECT_EQ(after("UPDATE series_row SET value = 0 WHERE id = " + row_id(3, 7) +
                  "; UPDATE message_row SET bytes = 49 WHERE id = " + row_id(3, 1) +
                  "; UPDATE scalar_row SET value = 0 WHERE id = " + row_id(3, 1) +
                  "; UPDATE run_row SET digest = 'x' WHERE id = 3"),
            "run 3 message sent_s=20 arrived_s=20.01 sender=0 receiver=1 kind=belief bytes: 48 | "
            "49");
}

TEST(Diff, TakesTheEarliestRun) {
  EXPECT_EQ(after("UPDATE series_row SET value = 0 WHERE id = " + row_id(5, 1) +
                  "; UPDATE event_row SET detail = '?' WHERE id = " + row_id(4, 2)),
            "run 4 event t_s=40 agent=1 kind=overflow: at 4 | ?");
}

TEST(Diff, ShowsBothRowsWhereTheKeysDiffer) {
  EXPECT_EQ(after("UPDATE series_row SET t_s = 21.5 WHERE id = " + row_id(5, 1)),
            "run 5 series row 1: t_s=20 agent=-1 subject=alarm name=nees value=4.857142857142857 | "
            "t_s=21.5 agent=-1 subject=alarm name=nees value=4.857142857142857");
}

TEST(Diff, SaysThatARowIsAbsent) {
  EXPECT_EQ(after("DELETE FROM event_row WHERE id >= " + row_id(5, 2)),
            "run 5 event t_s=40 agent=NULL kind=overflow: at 5 | absent");
  EXPECT_EQ(after("DELETE FROM message_row WHERE id >= " + row_id(5, 2)),
            "run 5 message sent_s=40 arrived_s=40.01 sender=0 receiver=1 kind=belief: bytes=48 "
            "fate=lost | absent");
}

TEST(Diff, SaysWhichFileAloneHasARun) {
  const sample::Directory directory;
  const std::string a = sample::make(directory, "a.db", 8);
  const std::string b = sample::make(directory, "b.db", 7);
  EXPECT_EQ(first_difference(a, b, {}), "run 8: only in " + a);
  EXPECT_EQ(first_difference(b, a, {}), "run 8: only in " + a);
}

TEST(Diff, ComparesWhatWasAskedBeforeWhatHappened) {
  EXPECT_EQ(after("UPDATE run_row SET seed = 9 WHERE id = 2; UPDATE series_row SET value = 0"),
            "run 1 series t_s=20 agent=-1 subject=alarm name=nees: 0.8571428571428572 | 0");
  EXPECT_EQ(after("UPDATE run_row SET seed = 9 WHERE id = 1; UPDATE series_row SET value = 0"),
            "run 1 seed: 101 | 9");
  EXPECT_EQ(after("UPDATE axis_set SET value = '0.2' WHERE name = 'loss' AND id = 1"),
            "run 1 axis name=loss: 0.1 | 0.2");
  EXPECT_EQ(after("UPDATE agent_set SET kind = 'robot' WHERE agent = 1"),
            "run 1 agent id=1 kind: estimator | robot");
}

TEST(Diff, FindsADigestThatAloneDiffers) {
  const std::string found = after("UPDATE run_row SET digest = 'x' WHERE id = 9");
  EXPECT_EQ(found.substr(0, 24), "run 9 digest: xxh3-128/1");
  EXPECT_EQ(found.substr(found.size() - 4), " | x");
}

TEST(Diff, FindsEachOtherColumnOfARun) {
  EXPECT_EQ(after("UPDATE run_row SET ok = 0 WHERE id = 1"), "run 1 status: ok | failed");
  EXPECT_EQ(after("UPDATE run_row SET events = 1 WHERE id = 1"), "run 1 events: 1001 | 1");
  EXPECT_EQ(after("UPDATE run_row SET repetition = 8 WHERE id = 1"), "run 1 repetition: 1 | 8");
  EXPECT_EQ(after("UPDATE run_row SET study = NULL WHERE id = 1"), "run 1 study: rumour | NULL");
  EXPECT_EQ(after("UPDATE name SET text = 'gone' WHERE text = 'time reached'"),
            "run 1 reason: time reached | gone");
  EXPECT_EQ(after("UPDATE name SET text = '0.2.0' WHERE text = '0.1.0'"),
            "run 1 version: 0.1.0 | 0.2.0");
  EXPECT_EQ(after("UPDATE name SET text = 'x.toml' WHERE text = 'ring.toml'"),
            "run 1 scenario: ring.toml | x.toml");
  EXPECT_EQ(after("UPDATE name SET text = '{}' WHERE text LIKE '{%'"),
            "run 1 parameters: {\"agents.estimator.fusion\":\"ci-det\"} | {}");
  EXPECT_EQ(after("UPDATE run_row SET config_hash = 'x' WHERE id = 1"),
            "run 1 config_hash: " + text_digest("config 1") + " | x");
}

TEST(Diff, ShowsTheLineInWhichStudiesDiffer) {
  EXPECT_EQ(after("UPDATE study SET config = 'repetitions = 3' || char(10) || 'seed = 2'"),
            "study rumour config line 2: seed = 1 | seed = 2");
  EXPECT_EQ(after("UPDATE study SET name = 'sumour'").substr(0, 21), "study rumour: only in");
}

TEST(Diff, DoesNotDependOnTheNumbersOfNames) {
  const sample::Directory directory;
  const std::string a = sample::make(directory, "a.db", 3);
  const std::string b = directory / "b.db";
  {
    DatabaseWriter writer(b);
    writer.add_study(sample::study);
    for (const std::int64_t id : {2, 3, 4}) sample::add(writer, id);
    writer.remove_run(4);
    writer.close();
  }
  sample::change(a, "DELETE FROM run_row WHERE id = 1");
  EXPECT_NE(sample::query(a, "SELECT * FROM name"), sample::query(b, "SELECT * FROM name"));
  EXPECT_EQ(first_difference(a, b, {}), std::nullopt);
}

TEST(Diff, OfTwoRunsShowsFirstWhatHappenedAndThenWhatWasAsked) {
  const sample::Directory directory;
  const std::string file = sample::make(directory, "a.db", 3);
  DiffOptions options;
  options.run_a = 1;
  options.run_b = 2;
  EXPECT_EQ(first_difference(file, file, options),
            "run 1 | 2 series t_s=20 agent=-1 subject=alarm name=nees: 0.8571428571428572 | "
            "1.8571428571428572");
  options.run_b = 1;
  EXPECT_EQ(first_difference(file, file, options), std::nullopt);
  EXPECT_EQ(after("UPDATE run_row SET seed = 9 WHERE id = 2", {2, 2}), "run 2 seed: 102 | 9");
  EXPECT_EQ(after("UPDATE run_row SET seed = 9 WHERE id = 2", {2, std::nullopt}),
            "run 2 seed: 102 | 9");
  EXPECT_EQ(after("UPDATE run_row SET seed = 9 WHERE id = 2", {3, std::nullopt}), "none");
}

TEST(Diff, OfTwoRunsDoesNotCountTheirIds) {
  const sample::Directory directory;
  const std::string file = directory / "a.db";
  {
    DatabaseWriter writer(file);
    for (const std::int64_t id : {1, 2}) {
      RunRow run = sample::row(1);
      run.id = id;
      run.study.clear();
      Record record({});
      sample::fill(record, 1);
      writer.add(run, record);
    }
    writer.close();
  }
  EXPECT_EQ(first_difference(file, file, {1, 2}), std::nullopt);
}

TEST(Diff, OfARunThatIsNotThereIsAnError) {
  const sample::Directory directory;
  const std::string file = sample::make(directory, "a.db", 3);
  try {
    first_difference(file, file, {1, 4});
    FAIL() << "found";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), file + ": has no run 4");
  }
}

}  // namespace
}  // namespace hearsay
