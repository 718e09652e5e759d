#include "sim/world/mrclam.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"
#include "sim/world/log_table.hpp"

namespace hearsay::mrclam {
namespace {

std::vector<Landmark> load_landmarks(const std::string& directory) {
  LogTable table(directory + "/Landmark_Groundtruth.dat", 5,
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

/// What a barcode stands for: an index into the landmarks; of a robot minus its subject.
using Meaning = int;

std::map<int, Meaning> load_barcodes(const std::string& directory,
                                     const std::vector<Landmark>& landmarks) {
  LogTable table(directory + "/Barcodes.dat", 2, "subject, barcode");
  std::map<int, Meaning> meanings;
  std::set<int> subjects;
  while (table.next()) {
    const int subject = table.whole(0);
    const int barcode = table.whole(1);
    if (!subjects.insert(subject).second) {
      table.fail("subject " + std::to_string(subject) + " is listed twice");
    }
    Meaning meaning = -subject;
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

PoseSample between(const PoseSample& before, const PoseSample& after, Time time) {
  const auto part = static_cast<double>((time - before.time).nanoseconds());
  const auto whole = static_cast<double>((after.time - before.time).nanoseconds());
  const double share = part / whole;
  return {time, before.x_m + share * (after.x_m - before.x_m),
          before.y_m + share * (after.y_m - before.y_m),
          before.heading_rad + share * (after.heading_rad - before.heading_rad)};
}

/// The first sample later than `time`.
std::size_t first_after(const std::vector<PoseSample>& truth, Time time) {
  const auto after = std::upper_bound(
      truth.begin(), truth.end(), time,
      [](Time instant, const PoseSample& sample) { return instant < sample.time; });
  return static_cast<std::size_t>(after - truth.begin());
}

/// Adds whole turns to the headings so that none differs from the one before by more than π.
/// Turns are counted, not differences summed: 60,000 samples leave no rounding behind.
void unwrap(std::vector<PoseSample>& truth) {
  double turns = 0.0;
  double previous = truth.front().heading_rad;
  for (PoseSample& sample : truth) {
    const double raw = sample.heading_rad;
    const double step = raw - previous;
    turns += std::floor((math::wrap_angle(step) - step) / (2.0 * math::pi) + 0.5);
    sample.heading_rad = raw + turns * 2.0 * math::pi;
    previous = raw;
  }
}

std::vector<PoseSample> load_truth(const std::string& file, std::int64_t start_ns) {
  LogTable table(file, 4, "time, x, y, heading");
  std::vector<PoseSample> truth;
  while (table.next()) {
    const PoseSample sample{Time::nanoseconds(table.time() - start_ns), table.number(1),
                            table.number(2), table.number(3)};
    if (!truth.empty() && truth.back().time == sample.time) truth.pop_back();
    truth.push_back(sample);
  }
  if (truth.empty()) throw InputError(file, 0, "no poses");
  unwrap(truth);
  return truth;
}

std::vector<OdometrySample> load_odometry(const std::string& file, std::int64_t start_ns) {
  LogTable table(file, 3, "time, forward velocity, angular velocity");
  std::vector<OdometrySample> odometry;
  while (table.next()) {
    const Time time = Time::nanoseconds(std::max<std::int64_t>(table.time() - start_ns, 0));
    if (!odometry.empty() && odometry.back().time == time) odometry.pop_back();
    odometry.push_back({time, table.number(1), table.number(2)});
  }
  if (odometry.empty()) throw InputError(file, 0, "no velocities");
  return odometry;
}

/// The pose at `time`; nothing in a gap wider than `gap_max`.
std::optional<PoseSample> pose_near(const std::vector<PoseSample>& truth, Time time,
                                    Duration gap_max) {
  const std::size_t next = first_after(truth, time);
  const bool exact = next > 0 && truth[next - 1].time == time;
  const bool inside = next > 0 && next < truth.size();
  if (!exact && (!inside || truth[next].time - truth[next - 1].time > gap_max)) return std::nullopt;
  return pose_at(truth, time);
}

struct Reading {
  std::int64_t ns;
  int barcode;
  double range_m, bearing_rad;
};

std::vector<Reading> load_readings(const std::string& file) {
  LogTable table(file, 4, "time, barcode, range, bearing");
  std::vector<Reading> readings;
  while (table.next()) {
    readings.push_back({table.time(), table.whole(1), table.number(2), table.number(3)});
  }
  return readings;
}

/// What all robots' measurements have in common.
struct Common {
  const std::map<int, Meaning>& meanings;
  int robots;
  Time start;  // on the clock of the files
  Duration gap_max;
};

Robot make_robot(int subject, const std::vector<Reading>& readings, std::vector<PoseSample> truth,
                 const Common& common) {
  Robot robot{.subject = subject, .truth = std::move(truth)};
  std::set<int> unknown;
  for (const Reading& reading : readings) {
    ++robot.skips.lines;
    const auto meaning = common.meanings.find(reading.barcode);
    if (meaning == common.meanings.end()) {
      ++robot.skips.unknown_barcode;
      unknown.insert(reading.barcode);
      continue;
    }
    const int companion = -meaning->second;  // its subject
    if (companion > common.robots || companion == subject) {
      ++robot.skips.robot_sighting;
      continue;
    }
    if (!(reading.range_m > 0.0)) {
      ++robot.skips.bad_range;
      continue;
    }
    const Time time = Time::nanoseconds(reading.ns - common.start.nanoseconds());
    const std::optional<PoseSample> pose = pose_near(robot.truth, time, common.gap_max);
    if (!pose) {
      ++robot.skips.truth_gap;
    } else if (companion > 0) {
      robot.companions.push_back(
          {time, companion - 1, reading.range_m, reading.bearing_rad, *pose});
    } else {
      robot.sightings.push_back(
          {time, meaning->second, reading.range_m, reading.bearing_rad, *pose});
    }
  }
  robot.unknown_barcodes.assign(unknown.begin(), unknown.end());
  return robot;
}

}  // namespace

std::optional<PoseSample> pose_at(const std::vector<PoseSample>& truth, Time time) {
  const std::size_t next = first_after(truth, time);
  if (next == 0) return std::nullopt;
  if (truth[next - 1].time == time) return truth[next - 1];
  if (next == truth.size()) return std::nullopt;
  return between(truth[next - 1], truth[next], time);
}

Dataset load(const std::string& directory, int robots, Duration truth_gap_max, Odometry odometry) {
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
  const std::map<int, Meaning> meanings = load_barcodes(directory, dataset.landmarks);

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
  const Common common{meanings, robots, Time::nanoseconds(first_ns), truth_gap_max};
  for (int subject = 1; subject <= robots; ++subject) {
    dataset.robots.push_back(make_robot(subject, readings[static_cast<std::size_t>(subject - 1)],
                                        load_truth(file_of(subject, "Groundtruth"), first_ns),
                                        common));
    if (odometry == Odometry::skip) continue;
    dataset.robots.back().odometry = load_odometry(file_of(subject, "Odometry"), first_ns);
  }
  return dataset;
}

}  // namespace hearsay::mrclam
