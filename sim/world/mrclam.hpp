// UTIAS multi-robot cooperative localization and mapping data sets (Leung et al., IJRR 30(8),
// 2011).
//
// A directory with Barcodes.dat (subject barcode), Landmark_Groundtruth.dat (subject x y σx σy) and
// for each robot Robot<i>_Groundtruth.dat (t x y heading) and Robot<i>_Measurement.dat (t barcode
// range bearing), and, where it is asked for, Robot<i>_Odometry.dat (t forward turn). Robots are
// subjects 1 … 5, landmarks 6 and up. Lines that start with # are comments; the last line, too,
// ends with a line end, or the file counts as cut off.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/kernel/time.hpp"

namespace hearsay::mrclam {

/// Every data set has this many robots: subjects 1 … 5.
inline constexpr int robots_max = 5;

struct Landmark {
  int subject;
  double x_m, y_m;  ///< surveyed position
};
/// A pose at an instant; headings unwrapped (no jumps of 2π), counterclockwise from the x axis.
struct PoseSample {
  Time time;
  double x_m, y_m, heading_rad;
};
struct Sighting {
  Time time;
  int landmark;    ///< index into landmarks
  double range_m;  ///< > 0
  double bearing_rad;
  PoseSample pose;  ///< of the robot, interpolated linearly from the truth
};
/// Of another robot.
struct CompanionSighting {
  Time time;
  int robot;       ///< index into robots
  double range_m;  ///< > 0
  double bearing_rad;
  PoseSample pose;  ///< of the one that looks, as above
};
/// Velocities until the next sample; before the start only the last sample is kept, at time 0.
struct OdometrySample {
  Time time;
  double forward_m_per_s;
  double turn_rad_per_s;  ///< counterclockwise
};
/// What was left out and why, each line under the first reason that holds, in this order:
/// unknown_barcode, robot_sighting, bad_range, truth_gap. Sum of the four + sightings + companions
/// = lines.
struct Skips {
  std::uint64_t truth_gap = 0;        ///< no truth within the permitted gap
  std::uint64_t unknown_barcode = 0;  ///< in no line of Barcodes.dat
  std::uint64_t robot_sighting = 0;   ///< a robot that was not asked for, or itself
  std::uint64_t bad_range = 0;        ///< range not positive
  std::uint64_t lines = 0;            ///< measurement lines read
};
struct Robot {
  int subject;
  std::vector<PoseSample> truth = {};              ///< by time, which may be before the start
  std::vector<Sighting> sightings = {};            ///< by time; equal times in file order
  std::vector<CompanionSighting> companions = {};  ///< the same
  std::vector<OdometrySample> odometry = {};       ///< by time; empty unless asked for
  Skips skips = {};
  std::vector<int> unknown_barcodes = {};  ///< distinct, ascending
};
struct Dataset {
  std::vector<Landmark> landmarks;  ///< by subject, ascending
  std::vector<Robot> robots;        ///< subjects 1 … `robots`
  Duration span;                    ///< first to last measurement line of any of these robots,
                                    ///< skipped or not; times count from the first
};

/// Where a robot was, between samples on the straight line, however far these are apart; nothing
/// before the first or after the last.
std::optional<PoseSample> pose_at(const std::vector<PoseSample>& truth, Time time);

/// Whether odometry is read: 60,000 lines a robot.
enum class Odometry { skip, read };

/// Loads the robots 1 … `robots` of the data set in `directory`.
///
/// A measurement is used if the truth has a sample at its very time, or one before and one after it
/// at most `truth_gap_max` (> 0) apart; the pose is interpolated between these. Of truth samples at
/// one time the last one holds. Times are exact to the nanosecond.
/// @throws InputError with file and line: directory or file missing, `robots` outside 1 … 5, a line
/// with too few or too many fields or text that is no number, a number that is not finite or beyond
/// ±1e6 (times: beyond 0 … 9e9 s), time going backwards, a barcode or subject listed twice, a
/// subject without landmark position, a landmark without barcode, a truth file without poses, one
/// of odometry without velocities, no measurement at all, a last line that is cut off.
Dataset load(const std::string& directory, int robots, Duration truth_gap_max,
             Odometry odometry = Odometry::skip);

}  // namespace hearsay::mrclam
