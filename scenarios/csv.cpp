#include "scenarios/csv.hpp"

#include <algorithm>
#include <array>
#include <boost/tokenizer.hpp>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "scenarios/document.hpp"
#include "scenarios/names.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr std::string_view blanks = " \t";

std::string read_bounded(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError(file, 0, "there is no such file");
  if (std::filesystem::is_directory(file, error)) {
    throw InputError(file, 0, "is a directory, not a file");
  }
  std::ifstream in(file, std::ios::binary);
  std::string content;
  std::array<char, 65536> block;
  while (in) {
    in.read(block.data(), block.size());
    content.append(block.data(), static_cast<std::size_t>(in.gcount()));
    if (content.size() > CsvFile::bytes_max) {
      throw InputError(
          file, 0,
          "is too large; at most " + std::to_string(CsvFile::bytes_max >> 20) + " MiB are read");
    }
  }
  if (!in.eof()) throw InputError(file, 0, "cannot be read");
  return content;
}

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return text.substr(0, 0);
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte < 0x20 && c != '\t') || byte == 0x7f;
}

// What stands in `segment` of a line between commas, without blanks and quotes; nothing if quotes
// are not where they may be.
std::optional<std::string_view> field_in(std::string_view segment) {
  const std::string_view field = trimmed(segment);
  const auto quotes = std::count(field.begin(), field.end(), '"');
  if (quotes == 0) return field;
  if (quotes != 2 || field.front() != '"' || field.back() != '"') return std::nullopt;
  return field.substr(1, field.size() - 2);
}

std::string list(const std::vector<std::string>& names) {
  return names.empty() ? "" : shortened(join(names));
}

}  // namespace

CsvFile::CsvFile(const std::string& file, Columns columns)
    : file_(file), columns_(std::move(columns)), content_(read_bounded(file)) {
  read_lines();
}

void CsvFile::read_lines() {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  std::size_t begin = std::string_view(content_).starts_with(mark) ? mark.size() : 0;
  std::size_t fields = 0;  // of the header
  int number = 0;
  for (std::size_t end = begin; begin < content_.size(); begin = end + 1) {
    end = std::min(content_.find('\n', begin), content_.size());
    ++number;
    std::string_view text(content_.data() + begin, end - begin);
    if (text.ends_with('\r')) text.remove_suffix(1);
    const std::string_view inside = trimmed(text);
    if (inside.empty() || inside.front() == '#') continue;
    const std::vector<Field> row = split(text, number);
    if (fields == 0) {
      fields = row.size();
      find_columns(row, number);
      continue;
    }
    if (row.size() != fields) {
      throw InputError(file_, number,
                       "number of fields is " + std::to_string(row.size()) + "; the header has " +
                           std::to_string(fields));
    }
    lines_.push_back(number);
    for (const std::size_t field : field_of_column_) {
      if (field != absent) fields_.push_back(row[field]);
    }
  }
  if (fields == 0) {
    throw InputError(file_, 0, "is empty; expected a header line: " + list(columns_.required));
  }
}

std::vector<CsvFile::Field> CsvFile::split(std::string_view text, int line_number) const {
  if (std::any_of(text.begin(), text.end(), is_control)) {
    throw InputError(file_, line_number, "must not contain control characters");
  }
  using Separator = boost::escaped_list_separator<char>;
  const boost::tokenizer<Separator, const char*> tokens(text.data(), text.data() + text.size(),
                                                        Separator("", ",", "\""));
  std::vector<Field> fields;
  std::size_t at = 0;
  for (const std::string& token : tokens) {
    // The library drops quotes wherever they stand; what they enclosed is looked up in the line.
    std::string_view segment = text.substr(std::min(at, text.size()), token.size());
    const auto complete = [&] {
      const std::size_t end = at + segment.size();
      return end == text.size() || (end < text.size() && text[end] == ',');
    };
    const bool plain = complete() && segment.find('"') == std::string_view::npos;
    if (!plain) segment = text.substr(std::min(at, text.size()), token.size() + 2);
    const auto field = complete() ? field_in(segment) : std::nullopt;
    if (!field) {
      throw InputError(file_, line_number,
                       "quotes must enclose a whole field, and none can stand within one");
    }
    fields.push_back({static_cast<std::uint32_t>(field->data() - content_.data()),
                      static_cast<std::uint32_t>(field->size())});
    at += segment.size() + 1;
  }
  return fields;
}

void CsvFile::find_columns(const std::vector<Field>& header, int line_number) {
  std::vector<std::string> names;
  for (const Field& field : header) names.emplace_back(view(field));
  const auto place = [&](const std::string& column) {
    const auto first = std::find(names.begin(), names.end(), column);
    if (first == names.end()) return absent;
    if (std::find(first + 1, names.end(), column) != names.end()) {
      throw InputError(file_, line_number, "there are two columns '" + column + "'");
    }
    return static_cast<std::size_t>(first - names.begin());
  };
  for (const std::string& column : columns_.required) {
    field_of_column_.push_back(place(column));
    if (field_of_column_.back() != absent) continue;
    throw InputError(file_, line_number,
                     "there is no column '" + column + "'; the header has: " + list(names));
  }
  for (const std::string& column : columns_.optional) field_of_column_.push_back(place(column));
  for (const std::size_t field : field_of_column_) {
    slot_.push_back(slots_);
    if (field != absent) ++slots_;
  }
}

std::string_view CsvFile::text(std::size_t row, std::size_t column) const {
  require(row < rows() && column < slot_.size() && has(column), "a CSV field that is not there");
  return view(fields_[row * slots_ + slot_[column]]);
}

double CsvFile::number(std::size_t row, std::size_t column) const {
  const std::string_view field = text(row, column);
  const char* const end = field.data() + field.size();
  double value = 0.0;
  const auto [after, error] = std::from_chars(field.data(), end, value);
  if (after != end || error == std::errc::invalid_argument) reject(row, column, "must be a number");
  if (error != std::errc()) reject(row, column, "is too large or too small for a number");
  if (!std::isfinite(value)) reject(row, column, "must be a finite number");
  return value;
}

void CsvFile::reject(std::size_t row, std::size_t column, const std::string& why) const {
  const std::string_view field = text(row, column);
  double value = 0.0;
  const char* const end = field.data() + field.size();
  const auto [after, error] = std::from_chars(field.data(), end, value);
  const bool number = after == end && error == std::errc();
  const bool required = column < columns_.required.size();
  const std::string& name =
      required ? columns_.required[column] : columns_.optional[column - columns_.required.size()];
  throw InputError(
      file_, line(row),
      name + " = " + shortened(number ? std::string(field) : to_toml(field)) + ": " + why);
}

}  // namespace hearsay
