#include "sim/world/log_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr std::int64_t ns_per_s = 1'000'000'000;
constexpr std::uint64_t seconds_max = 9'000'000'000;  // in nanoseconds it still fits 63 bits
constexpr double number_max = 1e6;  // far beyond any room; sums and differences stay finite

/// Digits behind the point of a time in seconds, as nanoseconds; the tenth rounds, others are let
/// go.
std::int64_t decimals_ns(const char* digit, const char* end) {
  std::int64_t ns = 0;
  std::int64_t unit = ns_per_s / 10;
  for (; digit != end && unit > 0; ++digit, unit /= 10) ns += (*digit - '0') * unit;
  return ns + (digit != end && *digit >= '5' ? 1 : 0);
}

constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// Text of a file as it may stand in a message: short, and without control characters.
std::string quoted(std::string_view text) {
  constexpr std::size_t length_max = 40;
  std::string out = "\"";
  for (const char c : text.substr(0, length_max)) out += (c >= ' ' && c <= '~') ? c : '?';
  return out + (text.size() > length_max ? "…\"" : "\"");
}

std::string read_whole(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError(file, 0, "no such file");
  if (!std::filesystem::is_regular_file(file, error)) throw InputError(file, 0, "not a file");
  const auto size = std::filesystem::file_size(file, error);
  if (error) throw InputError(file, 0, "cannot be read: " + error.message());
  std::string content(size, '\0');
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(content.data(), static_cast<std::streamsize>(size))) {
    throw InputError(file, 0, "cannot be read");
  }
  return content;
}

}  // namespace

LogTable::LogTable(std::string file, std::size_t columns, std::string names)
    : file_(std::move(file)),
      names_(std::move(names)),
      content_(read_whole(file_)),
      fields_(columns) {}

bool LogTable::next() {
  while (position_ < content_.size()) {
    const std::size_t end = content_.find('\n', position_);
    ++line_;
    if (end == std::string::npos) {
      fail("the file is cut off: its last line has no line end");
    }
    const std::string_view text(content_.data() + position_, end - position_);
    position_ = end + 1;
    if (split(text)) return true;
  }
  return false;
}

double LogTable::number(std::size_t column) const {
  const std::string_view text = fields_[column];
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::invalid_argument || end != text.data() + text.size()) {
    fail(quoted(text) + " is no number");
  }
  if (error != std::errc{} || !std::isfinite(value) || std::fabs(value) > number_max) {
    fail(quoted(text) + " is not within ±1e6");
  }
  return value;
}

int LogTable::whole(std::size_t column) const {
  const std::string_view text = fields_[column];
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 0) {
    fail(quoted(text) + " is no whole number from 0");
  }
  return value;
}

// Read digit by digit: at 1.2e9 s a double resolves no better than 0.24 µs.
std::int64_t LogTable::time() {
  const std::string_view text = fields_[0];
  const char* const end = text.data() + text.size();
  std::uint64_t seconds = 0;
  const auto [point, error] = std::from_chars(text.data(), end, seconds);
  if (error == std::errc::invalid_argument || (point != end && *point != '.') ||
      std::any_of(std::min(point + 1, end), end, [](char c) { return c < '0' || c > '9'; })) {
    fail(quoted(text) + " is no time in seconds");
  }
  if (error != std::errc{} || seconds > seconds_max) {
    fail(quoted(text) + " is not within 0 … 9e9 s");
  }
  const std::int64_t ns =
      static_cast<std::int64_t>(seconds) * ns_per_s + decimals_ns(std::min(point + 1, end), end);
  if (ns < previous_ns_) {
    fail("time goes backwards: " + std::string(text) + " after " + std::string(previous_time_));
  }
  previous_ns_ = ns;
  previous_time_ = text;
  return ns;
}

void LogTable::fail(const std::string& message) const { throw InputError(file_, line_, message); }

bool LogTable::split(std::string_view text) {
  std::size_t count = 0;
  for (std::size_t i = 0;;) {
    while (i < text.size() && is_blank(text[i])) ++i;
    if (i == text.size()) break;
    if (count == 0 && text[i] == '#') return false;
    const std::size_t start = i;
    while (i < text.size() && !is_blank(text[i])) ++i;
    if (count < fields_.size()) fields_[count] = text.substr(start, i - start);
    ++count;
  }
  if (count == 0) return false;
  if (count != fields_.size()) {
    fail(std::to_string(count) + (count == 1 ? " field" : " fields") + "; a line holds " +
         std::to_string(fields_.size()) + ": " + names_);
  }
  return true;
}

}  // namespace hearsay
