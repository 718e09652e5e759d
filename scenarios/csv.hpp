// Tables in CSV files: a header line with the names of the columns, then a row a line.
//
//   const CsvFile trace("trace.csv", {.required = {"t_s", "a", "b"}, .optional = {"note"}});
//   for (std::size_t row = 0; row < trace.rows(); ++row) trace.number(row, 0);
//
// Fields stand between commas; blanks around them are no part of them. A field that contains a
// comma is written in double quotes, which must enclose the whole field; a quote cannot be part of
// a field. Empty lines, lines that begin with #, a UTF-8 byte order mark and CRLF line ends are let
// pass. Columns may come in any order; those that nobody asks for are not looked at. Numbers are
// written with a point, whatever the locale is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hearsay {

class CsvFile {
 public:
  static constexpr std::size_t bytes_max = std::size_t{64} << 20;

  /// Columns are asked for by their place in `required`, then `optional`.
  struct Columns {
    std::vector<std::string> required;
    std::vector<std::string> optional;
  };

  /// @throws InputError "trace.csv:3: …" if the file cannot be read, is larger than bytes_max, has
  /// no header, lacks a required column or has one twice, or if a row has more or fewer fields than
  /// the header, control characters, or quotes elsewhere than around a field.
  CsvFile(const std::string& file, Columns columns);

  std::size_t rows() const { return lines_.size(); }
  /// Line of the file, from 1, on which the row (0 … rows() − 1) stands.
  int line(std::size_t row) const { return lines_[row]; }
  /// True if the file has the column; always for a required one.
  bool has(std::size_t column) const { return field_of_column_[column] != absent; }

  /// The field as written, without the quotes. The column must be there (has()).
  std::string_view text(std::size_t row, std::size_t column) const;
  /// @throws InputError "trace.csv:3: t_s = "soon": must be a number"; also if it is not finite.
  double number(std::size_t row, std::size_t column) const;
  /// @throws InputError "trace.csv:3: t_s = 7: <why>".
  [[noreturn]] void reject(std::size_t row, std::size_t column, const std::string& why) const;

 private:
  static constexpr std::size_t absent = static_cast<std::size_t>(-1);
  struct Field {  // within content_; views would not survive a move
    std::uint32_t begin;
    std::uint32_t length;
  };

  void read_lines();
  std::vector<Field> split(std::string_view line_text, int line_number) const;
  void find_columns(const std::vector<Field>& header, int line_number);
  std::string_view view(Field field) const {
    return std::string_view(content_).substr(field.begin, field.length);
  }

  std::string file_;
  Columns columns_;
  std::string content_;
  std::vector<std::size_t> field_of_column_;  // number of the field in a line, or absent
  std::vector<int> lines_;                    // a row
  std::vector<Field> fields_;                 // row by row: a field a column that is there
  std::vector<std::size_t> slot_;             // of a column within its row of fields_
  std::size_t slots_ = 0;
};

}  // namespace hearsay
