#include "sim/world/mrclam.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::mrclam {
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

/// Goes through the lines of a table of N columns.
template <std::size_t N>
class Table {
 public:
  /// `columns` names what a line holds, for messages.
  Table(std::string file, std::string columns)
      : file_(std::move(file)), columns_(std::move(columns)), content_(read_whole(file_)) {}

  /// Steps to the next line that is neither blank nor a comment; false at the end of the file.
  bool next() {
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

  /// The column as a number. @throws InputError if it is none, not finite or beyond ±1e6.
  double number(std::size_t column) const {
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

  /// The column as a whole number from 0. @throws InputError if it is none.
  int whole(std::size_t column) const {
    const std::string_view text = fields_[column];
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || value < 0) {
      fail(quoted(text) + " is no whole number from 0");
    }
    return value;
  }

  /// The first column as a time in nanoseconds. Read digit by digit: at 1.2e9 s a double resolves
  /// no better than 0.24 µs. @throws InputError if it is none or less than in the line before.
  std::int64_t time() {
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

  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(file_, line_, message);
  }
  const std::string& file() const { return file_; }

 private:
  /// Fills fields_; false for a blank line or a comment.
  bool split(std::string_view text) {
    std::size_t count = 0;
    for (std::size_t i = 0;;) {
      while (i < text.size() && is_blank(text[i])) ++i;
      if (i == text.size()) break;
      if (count == 0 && text[i] == '#') return false;
      const std::size_t start = i;
      while (i < text.size() && !is_blank(text[i])) ++i;
      if (count < N) fields_[count] = text.substr(start, i - start);
      ++count;
    }
    if (count == 0) return false;
    if (count != N) {
      fail(std::to_string(count) + (count == 1 ? " field" : " fields") + "; a line holds " +
           std::to_string(N) + ": " + columns_);
    }
    return true;
  }

  std::string file_;
  std::string columns_;
  std::string content_;
  std::size_t position_ = 0;
  int line_ = 0;
  std::array<std::string_view, N> fields_;
  std::int64_t previous_ns_ = 0;
  std::string_view previous_time_;
};

std::vector<Landmark> load_landmarks(const std::string& directory) {
  Table<5> table(directory + "/Landmark_Groundtruth.dat",
                 "subject, x, y, std-dev of x, std-dev of y");
  std::map<int, Landmark> landmarks;
  while (table.next()) {
    const int subject = table.whole(0);
    const Landmark landmark{subject, table.number(1), table.number(2)};
    table.number(3);
    table.number(4);
    if (subject <= robots_max) {
      table.fail("subject " + std::to_string(subject) + " is a robot (1 … 5), not a landmark");
    }
    if (!landmarks.emplace(subject, landmark).second) {
      table.fail("landmark " + std::to_string(subject) + " is listed twice");
    }
  }
  if (landmarks.empty()) throw InputError(table.file(), 0, "no landmarks");
  std::vector<Landmark> sorted;
  for (const auto& [subject, landmark] : landmarks) sorted.push_back(landmark);
  return sorted;
}

/// What a barcode stands for: an index into the landmarks, or a robot.
constexpr int a_robot = -1;

std::map<int, int> load_barcodes(const std::string& directory,
                                 const std::vector<Landmark>& landmarks) {
  Table<2> table(directory + "/Barcodes.dat", "subject, barcode");
  std::map<int, int> meanings;
  std::set<int> subjects;
  while (table.next()) {
    const int subject = table.whole(0);
    const int barcode = table.whole(1);
    if (!subjects.insert(subject).second) {
      table.fail("subject " + std::to_string(subject) + " is listed twice");
    }
    int meaning = a_robot;
    if (subject < 1 || subject > robots_max) {
      const auto found = std::find_if(landmarks.begin(), landmarks.end(),
                                      [&](const Landmark& l) { return l.subject == subject; });
      if (found == landmarks.end()) {
        table.fail("subject " + std::to_string(subject) +
                   " has no position in Landmark_Groundtruth.dat");
      }
      meaning = static_cast<int>(found - landmarks.begin());
    }
    if (!meanings.emplace(barcode, meaning).second) {
      table.fail("barcode " + std::to_string(barcode) + " is listed twice");
    }
  }
  for (const Landmark& landmark : landmarks) {
    if (!subjects.contains(landmark.subject)) {
      throw InputError(table.file(), 0,
                       "landmark " + std::to_string(landmark.subject) + " has no barcode");
    }
  }
  return meanings;
}

/// A robot's true path. Times as in the file, in nanoseconds.
class Truth {
 public:
  explicit Truth(const std::string& file) {
    Table<4> table(file, "time, x, y, heading");
    while (table.next()) {
      const Sample sample{table.time(), table.number(1), table.number(2), table.number(3)};
      if (!samples_.empty() && samples_.back().ns == sample.ns) samples_.pop_back();
      samples_.push_back(sample);
    }
    if (samples_.empty()) throw InputError(file, 0, "no poses");
    unwrap();
  }

  /// The pose at `ns`, which must not decrease from call to call; nothing in a gap wider than
  /// `gap_max_ns`, before the first sample or after the last. Its time is left at zero.
  std::optional<PoseSample> at(std::int64_t ns, std::int64_t gap_max_ns) {
    while (next_ < samples_.size() && samples_[next_].ns <= ns) ++next_;
    if (next_ == 0) return std::nullopt;
    const Sample& before = samples_[next_ - 1];
    if (before.ns == ns) return PoseSample{Time(), before.x_m, before.y_m, before.heading_rad};
    if (next_ == samples_.size()) return std::nullopt;
    const Sample& after = samples_[next_];
    if (after.ns - before.ns > gap_max_ns) return std::nullopt;
    const double share =
        static_cast<double>(ns - before.ns) / static_cast<double>(after.ns - before.ns);
    return PoseSample{
        Time(),
        before.x_m + share * (after.x_m - before.x_m),
        before.y_m + share * (after.y_m - before.y_m),
        before.heading_rad + share * (after.heading_rad - before.heading_rad),
    };
  }

 private:
  struct Sample {
    std::int64_t ns;
    double x_m, y_m, heading_rad;
  };

  /// Adds whole turns to the headings so that none differs from the one before by more than π.
  /// Turns are counted, not differences summed: 60,000 samples leave no rounding behind.
  void unwrap() {
    double turns = 0.0;
    double previous = samples_.front().heading_rad;
    for (Sample& sample : samples_) {
      const double raw = sample.heading_rad;
      const double step = raw - previous;
      turns += std::floor((math::wrap_angle(step) - step) / (2.0 * math::pi) + 0.5);
      sample.heading_rad = raw + turns * 2.0 * math::pi;
      previous = raw;
    }
  }

  std::vector<Sample> samples_;
  std::size_t next_ = 0;  // first sample later than the last time asked for
};

struct Reading {
  std::int64_t ns;
  int barcode;
  double range_m, bearing_rad;
};

std::vector<Reading> load_readings(const std::string& file) {
  Table<4> table(file, "time, barcode, range, bearing");
  std::vector<Reading> readings;
  while (table.next()) {
    readings.push_back({table.time(), table.whole(1), table.number(2), table.number(3)});
  }
  return readings;
}

Robot make_robot(int subject, const std::vector<Reading>& readings, Truth truth,
                 const std::map<int, int>& meanings, std::int64_t start_ns,
                 std::int64_t gap_max_ns) {
  Robot robot{.subject = subject, .sightings = {}, .skips = {}, .unknown_barcodes = {}};
  std::set<int> unknown;
  for (const Reading& reading : readings) {
    ++robot.skips.lines;
    const auto meaning = meanings.find(reading.barcode);
    if (meaning == meanings.end()) {
      ++robot.skips.unknown_barcode;
      unknown.insert(reading.barcode);
      continue;
    }
    if (meaning->second == a_robot) {
      ++robot.skips.robot_sighting;
      continue;
    }
    if (!(reading.range_m > 0.0)) {
      ++robot.skips.bad_range;
      continue;
    }
    std::optional<PoseSample> pose = truth.at(reading.ns, gap_max_ns);
    if (!pose) {
      ++robot.skips.truth_gap;
      continue;
    }
    pose->time = Time::nanoseconds(reading.ns - start_ns);
    robot.sightings.push_back(
        {pose->time, meaning->second, reading.range_m, reading.bearing_rad, *pose});
  }
  robot.unknown_barcodes.assign(unknown.begin(), unknown.end());
  return robot;
}

}  // namespace

Dataset load(const std::string& directory, int robots, Duration truth_gap_max) {
  require(truth_gap_max > Duration(), "mrclam::load: truth_gap_max must be positive");
  std::error_code error;
  if (!std::filesystem::is_directory(directory, error)) {
    throw InputError(directory, 0, "no such directory; an MRCLAM data set was expected there");
  }
  if (robots < 1 || robots > robots_max) {
    throw InputError(directory, 0,
                     std::to_string(robots) + " robots asked for; the data set has 1 … 5");
  }
  Dataset dataset;
  dataset.landmarks = load_landmarks(directory);
  const std::map<int, int> meanings = load_barcodes(directory, dataset.landmarks);

  std::vector<std::vector<Reading>> readings;
  std::int64_t first_ns = std::numeric_limits<std::int64_t>::max();
  std::int64_t last_ns = std::numeric_limits<std::int64_t>::min();
  const auto file_of = [&](int subject, const char* what) {
    return directory + "/Robot" + std::to_string(subject) + "_" + what + ".dat";
  };
  for (int subject = 1; subject <= robots; ++subject) {
    readings.push_back(load_readings(file_of(subject, "Measurement")));
    if (readings.back().empty()) continue;
    first_ns = std::min(first_ns, readings.back().front().ns);
    last_ns = std::max(last_ns, readings.back().back().ns);
  }
  if (first_ns > last_ns) throw InputError(directory, 0, "no robot has a measurement");
  dataset.span = Duration::nanoseconds(last_ns - first_ns);
  for (int subject = 1; subject <= robots; ++subject) {
    dataset.robots.push_back(make_robot(subject, readings[static_cast<std::size_t>(subject - 1)],
                                        Truth(file_of(subject, "Groundtruth")), meanings, first_ns,
                                        truth_gap_max.nanoseconds()));
  }
  return dataset;
}

}  // namespace hearsay::mrclam
