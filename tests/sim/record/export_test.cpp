#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sample.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

std::string read_text(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

TEST(Export, WritesEveryTableWithHeaderAndCountsItsRows) {
  const sample::Directory directory;
  const std::string file = sample::make(directory, "a.db", 3);
  const auto counts = export_csv(file, directory / "deep/csv");
  using Count = std::pair<std::string, std::int64_t>;
  EXPECT_THAT(counts,
              testing::ElementsAre(Count("study", 1), Count("run", 3), Count("axis", 6),
                                   Count("agent", 9), Count("scalar", 6), Count("series", 36),
                                   Count("message", 6), Count("link", 6), Count("event", 6)));
  for (const auto& [table, rows] : counts) {
    const std::string text = read_text(directory / ("deep/csv/" + table + ".csv"));
    EXPECT_GE(std::count(text.begin(), text.end(), '\r'), rows + 1) << table;
  }
  EXPECT_THAT(read_text(directory / "deep/csv/series.csv"),
              testing::StartsWith("run,t_s,agent,subject,name,value\r\n"
                                  "1,20,-1,alarm,nees,0.8571428571428572\r\n"));
  EXPECT_EQ(read_text(directory / "deep/csv/link.csv").substr(0, 67),
            "run,sender,receiver,fate,packets\r\n1,0,1,delivered,1\r\n1,1,0,lost,2\r\n");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory / "deep/csv"), {}), 9);
}

TEST(Export, QuotesWhatNeedsItAndTellsNullFromEmpty) {
  const sample::Directory directory;
  const std::string file = directory / "a.db";
  {
    DatabaseWriter writer(file);
    Record record({});
    const NameId name = record.name("a,b");
    record.event(Time::at(10_ms), no_agent, "said \"hello\"", "line 1\nline 2");
    record.event(Time::at(10_ms), 3, "plain", "");
    record.series(Time(), 0, name, name, std::nan(""));
    record.series(Time(), 0, name, name, -std::numeric_limits<double>::infinity());
    record.series(Time(), 0, name, name, 0.1);
    writer.add({}, record);
    writer.close();
  }
  export_csv(file, directory / "");
  EXPECT_EQ(read_text(directory / "event.csv"),
            "run,t_s,agent,kind,detail\r\n"
            "1,0.01,,\"said \"\"hello\"\"\",\"line 1\nline 2\"\r\n"
            "1,0.01,3,plain,\"\"\r\n");
  EXPECT_EQ(read_text(directory / "series.csv"),
            "run,t_s,agent,subject,name,value\r\n"
            "1,0,0,\"a,b\",\"a,b\",\r\n"
            "1,0,0,\"a,b\",\"a,b\",-inf\r\n"
            "1,0,0,\"a,b\",\"a,b\",0.1\r\n");
}

TEST(Export, IntoAPlaceWhereNothingCanBeWrittenIsAnError) {
  const sample::Directory directory;
  const std::string file = sample::make(directory, "a.db", 1);
  try {
    export_csv(file, directory / "a.db/csv");
    FAIL() << "written";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              directory / "a.db/csv: cannot be written: Not a directory");
  }
}

TEST(Export, ThatFailsOnTheWayLeavesNothingNew) {
  const sample::Directory directory;
  const std::string file = sample::make(directory, "a.db", 1);
  std::filesystem::create_directories(directory / "csv/.event.csv.part/x");  // the last table's
  EXPECT_THROW(export_csv(file, directory / "csv"), InputError);
  EXPECT_FALSE(std::filesystem::exists(directory / "csv/series.csv"));
  EXPECT_FALSE(std::filesystem::exists(directory / "csv/.series.csv.part"));
}

TEST(Export, OfAMissingFileMakesNoDirectory) {
  const sample::Directory directory;
  EXPECT_THROW(export_csv(directory / "a.db", directory / "csv"), InputError);
  EXPECT_TRUE(directory.files().empty());
}

}  // namespace
}  // namespace hearsay
