// Files that are no database of ours, and places where none can be.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sample.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using testing::EndsWith;
using testing::StartsWith;

void write_text(const std::string& file, const std::string& text) { std::ofstream(file) << text; }

std::string read_text(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// Message of opening `file` for writing; empty if that works.
std::string writing(const std::string& file) {
  try {
    DatabaseWriter writer(file);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

std::string reading(const std::string& file) {
  try {
    check_database(file);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(UnusableFile, ThatIsNotSqliteIsRefusedAndLeftAsItIs) {
  const sample::Directory directory;
  for (const std::size_t size : {1, 2, 600, 5000}) {
    const std::string text(size, 'x');
    const std::string file = directory / "notes.txt";
    write_text(file, text);
    const std::string message = file + ": is not a hearsay database (not an SQLite file)";
    EXPECT_EQ(writing(file), message);
    EXPECT_EQ(reading(file), message);
    EXPECT_TRUE(read_text(file) == text);
    EXPECT_EQ(directory.files().size(), 1u);
  }
}

TEST(UnusableFile, OfAnotherProgramIsRefusedAndLeftAsItIs) {
  const sample::Directory directory;
  const std::string file = directory / "other.db";
  {
    SQLite::Database other(file, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    other.exec("CREATE TABLE run(id)");
  }
  const std::string before = read_text(file);
  const std::string message =
      file + ": is not a hearsay database (an SQLite file of another program)";
  EXPECT_EQ(writing(file), message);
  EXPECT_EQ(reading(file), message);
  EXPECT_TRUE(read_text(file) == before);
}

TEST(UnusableFile, OfAnotherVersionIsRefusedByBothVersions) {
  const sample::Directory directory;
  const std::string file = sample::make(directory, "a.db", 1);
  sample::change(file, "PRAGMA user_version = 7");
  const std::string message = file + ": has schema version 7; this program reads 2";
  EXPECT_EQ(writing(file), message);
  EXPECT_EQ(reading(file), message);
  EXPECT_THROW(first_difference(file, file, {}), InputError);
  EXPECT_THROW(export_csv(file, directory / "csv"), InputError);
}

TEST(UnusableFile, ThatIsDamagedIsAnError) {
  const sample::Directory directory;
  const std::string file = sample::make(directory, "a.db", 1);
  std::fstream(file, std::ios::in | std::ios::out).seekp(100) << std::string(3000, '\xff');
  EXPECT_THAT(writing(file), StartsWith(file + ": cannot be written: "));
}

TEST(UnusableFile, ThatIsEmptyCountsAsNewForWritingOnly) {
  const sample::Directory directory;
  const std::string file = directory / "a.db";
  write_text(file, "");
  EXPECT_EQ(reading(file), file + ": is not a hearsay database (it is empty)");
  EXPECT_EQ(writing(file), "");
  EXPECT_EQ(reading(file), "");
}

TEST(UnusableFile, ThatIsMissingCannotBeReadAndIsNotMade) {
  const sample::Directory directory;
  EXPECT_EQ(reading(directory / "a.db"), directory / "a.db: does not exist");
  EXPECT_TRUE(directory.files().empty());
}

TEST(UnusableFile, InADirectoryThatIsNotThereCannotBeWritten) {
  const sample::Directory directory;
  EXPECT_EQ(writing(directory / "none/a.db"), directory / "none/a.db: cannot be written: " +
                                                  ("there is no directory " + directory / "none"));
  EXPECT_TRUE(directory.files().empty());
}

TEST(UnusableFile, BelowAFileCannotBeWritten) {
  const sample::Directory directory;
  write_text(directory / "file", "text");
  EXPECT_THAT(writing(directory / "file/a.db"),
              EndsWith(": cannot be written: there is no directory " + directory / "file"));
}

TEST(UnusableFile, ThatIsADirectoryCannotBeWritten) {
  const sample::Directory directory;
  std::filesystem::create_directory(directory / "a.db");
  EXPECT_EQ(writing(directory / "a.db"), directory / "a.db: cannot be written: it is a directory");
}

TEST(UnusableFile, WhatSqliteTakesForSpecialIsAPlainName) {
  const sample::Directory directory;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(directory / "");
  EXPECT_EQ(writing(":memory:"), "");
  std::filesystem::current_path(before);
  EXPECT_EQ(directory.files(), std::vector<std::string>{":memory:"});
}

TEST(UnusableFile, WithAWriterIsRefusedToASecondInTheSameProcess) {
  const sample::Directory directory;
  const std::string file = directory / "a.db";
  DatabaseWriter first(file);
  EXPECT_EQ(writing(file), file + ": is being written by another process");
  EXPECT_EQ(reading(file), "");
  first.add_study(sample::study);
  sample::add(first, 1);
  first.close();
  EXPECT_EQ(writing(file), "");
}

}  // namespace
}  // namespace hearsay
