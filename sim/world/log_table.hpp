// Tables of numbers in text files, as recorded data sets have them: columns between blanks,
// comments behind #, every line with a line end. What is wrong is told with file and line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hearsay {

/// Goes through the lines of a table.
class LogTable {
 public:
  /// `columns`, above 0, a line; `names` says what they hold, for messages.
  /// @throws InputError if the file cannot be read.
  LogTable(std::string file, std::size_t columns, std::string names);

  /// Steps to the next line that is neither blank nor a comment; false at the end of the file.
  /// @throws InputError for another number of fields, or a last line without a line end.
  bool next();

  /// The column as a number. @throws InputError if it is none, not finite or beyond ±1e6.
  double number(std::size_t column) const;
  /// The column as a whole number from 0. @throws InputError if it is none.
  int whole(std::size_t column) const;
  /// The first column as a time in nanoseconds, exact. Once a line.
  /// @throws InputError if it is none, beyond 0 … 9e9 s, or less than in the line before.
  std::int64_t time();

  [[noreturn]] void fail(const std::string& message) const;
  const std::string& file() const { return file_; }

 private:
  /// Fills fields_; false for a blank line or a comment.
  bool split(std::string_view text);

  std::string file_;
  std::string names_;
  std::string content_;
  std::size_t position_ = 0;
  int line_ = 0;
  std::vector<std::string_view> fields_;
  std::int64_t previous_ns_ = 0;
  std::string_view previous_time_;
};

}  // namespace hearsay
