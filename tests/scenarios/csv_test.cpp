#include "scenarios/csv.hpp"

#include <gtest/gtest.h>

#include <clocale>
#include <filesystem>
#include <utility>

#include "temp_files.hpp"

namespace hearsay {
namespace {

class Csv : public InTempDirectory {
 protected:
  static CsvFile read(const std::string& content) {
    write("t.csv", content);
    return {"t.csv", {.required = {"t_s", "a"}, .optional = {"note"}}};
  }
  static std::string error(const std::string& content) {
    return error_of([&] { read(content); });
  }
  static std::string error_of_number(const std::string& field) {
    return error_of([&] { read("t_s,a\n" + field + ",x\n").number(0, 0); });
  }
};

TEST_F(Csv, ColumnsAreFoundByNameInAnyOrder) {
  const CsvFile file = read("a,other,note,t_s\nx,9,hm,0.5\ny,,,-2e3\n");
  ASSERT_EQ(file.rows(), 2u);
  EXPECT_EQ(file.number(0, 0), 0.5);
  EXPECT_EQ(file.text(0, 1), "x");
  EXPECT_TRUE(file.has(2));
  EXPECT_EQ(file.text(0, 2), "hm");
  EXPECT_EQ(file.number(1, 0), -2000.0);
  EXPECT_EQ(file.text(1, 2), "");
}

TEST_F(Csv, AnOptionalColumnMayBeMissing) {
  const CsvFile file = read("t_s,a\n1,x\n");
  EXPECT_TRUE(file.has(0));
  EXPECT_FALSE(file.has(2));
  EXPECT_THROW(file.text(0, 2), BrokenInvariant);
}

TEST_F(Csv, CommentsEmptyLinesByteOrderMarkAndCrlfAreLetPass) {
  const CsvFile file =
      read("\xEF\xBB\xBF# made by hand\r\n\r\nt_s,a\r\n  # the first\r\n1,x\r\n \r\n2,y\r\n");
  ASSERT_EQ(file.rows(), 2u);
  EXPECT_EQ(file.text(0, 1), "x");
  EXPECT_EQ(file.line(0), 5);
  EXPECT_EQ(file.line(1), 7);
}

TEST_F(Csv, TheLastLineNeedsNoEnd) {
  EXPECT_EQ(read("t_s,a\n1,x").text(0, 1), "x");
  EXPECT_EQ(read("t_s,a\n1,").text(0, 1), "");
  EXPECT_EQ(read("t_s,a").rows(), 0u);
}

TEST_F(Csv, BlanksAroundFieldsAreNoPartOfThem) {
  const CsvFile file = read(" t_s ,\ta\n 1 , two words \n");
  EXPECT_EQ(file.number(0, 0), 1.0);
  EXPECT_EQ(file.text(0, 1), "two words");
}

TEST_F(Csv, QuotesEncloseWhatHasCommas) {
  const CsvFile file = read("\"t_s\",\"a\",note\n\"1\", \"x, y\" ,\"\"\n2,\" z \",\"#\"\n");
  EXPECT_EQ(file.number(0, 0), 1.0);
  EXPECT_EQ(file.text(0, 1), "x, y");
  EXPECT_EQ(file.text(0, 2), "");
  EXPECT_EQ(file.text(1, 1), " z ");
  EXPECT_EQ(file.text(1, 2), "#");
}

TEST_F(Csv, QuotesElsewhereAreRefused) {
  const std::string why =
      "t.csv:2: quotes must enclose a whole field, and none can stand within one";
  for (const char* row : {"1,\"x", "1,x\"", "1,\"x\"y", "1,y\"x\"", "1,\"x\"\"y\"", "1,\"\"\"\"",
                          "\"1,x", "1,\"x\"\"", "1,x\"\"", "1,\"\"x"}) {
    EXPECT_EQ(error("t_s,a\n" + std::string(row) + "\n"), why) << row;
  }
}

TEST_F(Csv, NoEscapesAreKnown) { EXPECT_EQ(read("t_s,a\n1,a\\nb\\\n").text(0, 1), "a\\nb\\"); }

TEST_F(Csv, AnEmptyFileIsRefused) {
  const std::string why = "t.csv: is empty; expected a header line: t_s, a";
  EXPECT_EQ(error(""), why);
  EXPECT_EQ(error("\xEF\xBB\xBF"), why);
  EXPECT_EQ(error("\n# nothing\n\n"), why);
}

TEST_F(Csv, AMissingOrDoubledColumnIsNamed) {
  EXPECT_EQ(error("# c\ntime,a\n1,x\n"),
            "t.csv:2: there is no column 't_s'; the header has: time, a");
  EXPECT_EQ(error("t_s,a,a\n"), "t.csv:1: there are two columns 'a'");
  EXPECT_EQ(error("t_s,a,note,note\n"), "t.csv:1: there are two columns 'note'");
  EXPECT_EQ(read("t_s,a,x,x\n").rows(), 0u);
}

TEST_F(Csv, ARaggedRowIsRefused) {
  EXPECT_EQ(error("t_s,a\n1,x\n2\n"), "t.csv:3: number of fields is 1; the header has 2");
  EXPECT_EQ(error("t_s,a\n1,x,\n"), "t.csv:2: number of fields is 3; the header has 2");
}

TEST_F(Csv, ANumberIsAWholeFieldAndFinite) {
  EXPECT_EQ(error_of_number("soon"), "t.csv:2: t_s = \"soon\": must be a number");
  EXPECT_EQ(error_of_number(""), "t.csv:2: t_s = \"\": must be a number");
  EXPECT_EQ(error_of_number("1 s"), "t.csv:2: t_s = \"1 s\": must be a number");
  EXPECT_EQ(error_of_number("\"1,5\""), "t.csv:2: t_s = \"1,5\": must be a number");
  EXPECT_EQ(error_of_number("0x10"), "t.csv:2: t_s = \"0x10\": must be a number");
  EXPECT_EQ(error_of_number("inf"), "t.csv:2: t_s = inf: must be a finite number");
  EXPECT_EQ(error_of_number("nan"), "t.csv:2: t_s = nan: must be a finite number");
  EXPECT_EQ(error_of_number("1e999"),
            "t.csv:2: t_s = \"1e999\": is too large or too small for a number");
}

TEST_F(Csv, NumbersDoNotDependOnTheLocale) {
  // Where no such locale is installed the test says less, but nothing false.
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  EXPECT_EQ(read("t_s,a\n1.5,x\n").number(0, 0), 1.5);
  std::setlocale(LC_ALL, "C");
}

TEST_F(Csv, ARejectedFieldIsShownShortAndWithItsLine) {
  const CsvFile file = read("t_s,a,note\n7,x," + std::string(100, 'n') + "\n");
  EXPECT_EQ(error_of([&] { file.reject(0, 0, "too late"); }), "t.csv:2: t_s = 7: too late");
  EXPECT_EQ(error_of([&] { file.reject(0, 2, "too long"); }),
            "t.csv:2: note = \"" + std::string(79, 'n') + "…: too long");
}

TEST_F(Csv, WhatIsNoTextIsRefused) {
  EXPECT_EQ(error("t_s,a\n1,x\ry\n"), "t.csv:2: must not contain control characters");
  EXPECT_EQ(error(std::string("t_s,a\n1,\0\n", 10)),
            "t.csv:2: must not contain control characters");
}

TEST_F(Csv, AFileThatCannotBeReadIsNamed) {
  EXPECT_EQ(error_of([] { CsvFile("gone.csv", {.required = {"t_s"}}); }),
            "gone.csv: there is no such file");
  std::filesystem::create_directory("folder");
  EXPECT_EQ(error_of([] { CsvFile("folder", {.required = {"t_s"}}); }),
            "folder: is a directory, not a file");
  write("large.csv", "t_s\n");
  std::filesystem::resize_file("large.csv", CsvFile::bytes_max + 1);  // sparse: costs no disk
  EXPECT_EQ(error_of([] { CsvFile("large.csv", {.required = {"t_s"}}); }),
            "large.csv: is too large; at most 64 MiB are read");
}

TEST_F(Csv, AFileMayBeMoved) {
  CsvFile first = read("t_s,a\n1,x\n");
  const CsvFile second = std::move(first);
  EXPECT_EQ(second.text(0, 1), "x");
}

}  // namespace
}  // namespace hearsay
