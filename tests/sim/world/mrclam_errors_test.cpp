#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/world/mrclam.hpp"
#include "tests/sim/world/small_dataset.hpp"

namespace hearsay::mrclam {
namespace {

class MrclamErrors : public SmallDataset {
 protected:
  /// What loading complains of; file names without the directory.
  std::string message(int robots = 2) const {
    try {
      load(directory_, robots, 10_s);
    } catch (const InputError& error) {
      return without_directory(error.what());
    }
    return "no error";
  }
  /// The same, once `name` holds `content`.
  std::string message_for(const std::string& name, const std::string& content) const {
    write(name, content);
    return message();
  }
};

TEST_F(MrclamErrors, TheUntouchedDataSetLoads) { EXPECT_EQ(message(), "no error"); }

TEST_F(MrclamErrors, AMissingDirectoryIsNamed) {
  try {
    load(directory_ + "/nowhere", 2, 10_s);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), directory_ +
                                "/nowhere: no such directory; an MRCLAM data set was expected "
                                "there");
  }
}

TEST_F(MrclamErrors, AFileInPlaceOfTheDirectoryIsNamed) {
  EXPECT_THROW(load(path("Barcodes.dat"), 2, 10_s), InputError);
}

TEST_F(MrclamErrors, EachMissingFileIsNamed) {
  for (const char* name : {"Barcodes.dat", "Landmark_Groundtruth.dat", "Robot2_Groundtruth.dat",
                           "Robot2_Measurement.dat"}) {
    const std::string aside = path("aside");
    std::filesystem::rename(path(name), aside);
    EXPECT_EQ(message(), std::string(name) + ": no such file");
    std::filesystem::create_directory(path(name));
    EXPECT_EQ(message(), std::string(name) + ": not a file");
    remove(name);
    std::filesystem::rename(aside, path(name));
  }
}

TEST_F(MrclamErrors, MoreOrFewerRobotsThanADataSetCanHaveAreRefused) {
  EXPECT_EQ(message(6), directory_ + ": 6 robots asked for; the data set has 1 … 5");
  EXPECT_EQ(message(0), directory_ + ": 0 robots asked for; the data set has 1 … 5");
}

TEST_F(MrclamErrors, OfOdometryThatIsAskedForTheSameIsNamed) {
  write("Robot2_Odometry.dat", "12 0 0\n");
  const auto message_of = [&](const char* content) {
    write("Robot1_Odometry.dat", content);
    try {
      load(directory_, 2, 10_s, Odometry::read);
    } catch (const InputError& error) {
      return without_directory(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(message_of("12 0.1 0\n"), "no error");
  EXPECT_EQ(message_of("# t v w\n"), "Robot1_Odometry.dat: no velocities");
  EXPECT_EQ(message_of("12 0.1\n"),
            "Robot1_Odometry.dat:1: 2 fields; a line holds 3: time, forward velocity, angular "
            "velocity");
  EXPECT_EQ(message_of("12 0.1 fast\n"), "Robot1_Odometry.dat:1: \"fast\" is no number");
  EXPECT_EQ(message_of("12 0.1 0\n11 0.1 0\n").substr(0, 22), "Robot1_Odometry.dat:2:");
  EXPECT_EQ(message_of("12 0.1 0"),
            "Robot1_Odometry.dat:1: the file is cut off: its last line has no line end");
  remove("Robot1_Odometry.dat");
  EXPECT_THROW(load(directory_, 2, 10_s, Odometry::read), InputError);
}

TEST_F(MrclamErrors, ALineWithTooFewOrTooManyFieldsIsNamed) {
  EXPECT_EQ(message_for("Robot1_Measurement.dat", "# head\n12.5 63 2.25 -0.5\n12.6 63 2.25\n"),
            "Robot1_Measurement.dat:3: 3 fields; a line holds 4: time, barcode, range, bearing");
  EXPECT_EQ(message_for("Robot1_Measurement.dat", "12.5 63 2.25 -0.5 1\n"),
            "Robot1_Measurement.dat:1: 5 fields; a line holds 4: time, barcode, range, bearing");
  write("Robot1_Measurement.dat", "12.5 63 2.25 -0.5\n");
  EXPECT_EQ(message_for("Robot1_Groundtruth.dat", "1\n"),
            "Robot1_Groundtruth.dat:1: 1 field; a line holds 4: time, x, y, heading");
  EXPECT_EQ(message_for("Barcodes.dat", "1 5\n6\n"),
            "Barcodes.dat:2: 1 field; a line holds 2: subject, barcode");
  EXPECT_EQ(message_for("Landmark_Groundtruth.dat", "6 1 2 3\n"),
            "Landmark_Groundtruth.dat:1: 4 fields; a line holds 5: subject, x, y, std-dev of x, "
            "std-dev of y");
}

TEST_F(MrclamErrors, AFileThatBreaksOffInItsLastLineIsCutOff) {
  EXPECT_EQ(message_for("Robot1_Measurement.dat", "12.5 63 2.25 -0.5\n12.6 63 2.25 -0.5"),
            "Robot1_Measurement.dat:2: the file is cut off: its last line has no line end");
}

TEST_F(MrclamErrors, TextThatIsNoNumberIsQuoted) {
  EXPECT_EQ(message_for("Robot1_Measurement.dat", "12.5 63 2,25 -0.5\n"),
            "Robot1_Measurement.dat:1: \"2,25\" is no number");
  EXPECT_EQ(message_for("Robot1_Measurement.dat", "12.5 63 2.25 +0.5\n"),
            "Robot1_Measurement.dat:1: \"+0.5\" is no number");
  EXPECT_EQ(message_for("Robot1_Measurement.dat", "12.5 63.0 2.25 0.5\n"),
            "Robot1_Measurement.dat:1: \"63.0\" is no whole number from 0");
  EXPECT_EQ(message_for("Robot1_Measurement.dat", "12.5 -63 2.25 0.5\n"),
            "Robot1_Measurement.dat:1: \"-63\" is no whole number from 0");
  EXPECT_EQ(message_for("Robot1_Measurement.dat", "12.5 99999999999 2.25 0.5\n"),
            "Robot1_Measurement.dat:1: \"99999999999\" is no whole number from 0");
  EXPECT_EQ(message_for("Robot1_Measurement.dat", "12.5 63 " + std::string(50, 'z') + "\x01 0\n"),
            "Robot1_Measurement.dat:1: \"" + std::string(40, 'z') + "…\" is no number");
  EXPECT_EQ(message_for("Robot1_Measurement.dat", "12.5 63 \x1b[2J 0\n"),
            "Robot1_Measurement.dat:1: \"?[2J\" is no number");
}

TEST_F(MrclamErrors, NumbersThatAreNotFiniteOrBeyondAMillionAreRefused) {
  for (const char* text : {"nan", "-inf", "1e999", "1e-999", "1000001", "-1e7"}) {
    EXPECT_EQ(message_for("Robot2_Groundtruth.dat", "10 0 " + std::string(text) + " 0\n"),
              "Robot2_Groundtruth.dat:1: \"" + std::string(text) + "\" is not within ±1e6");
  }
  EXPECT_EQ(message_for("Robot2_Groundtruth.dat", "10 1e6 -1e6 0\n20 0 0 0\n"), "no error");
}

TEST_F(MrclamErrors, ATimeIsDigitsWithAPointAndNothingElse) {
  for (const char* text : {"x", "-1", "+1", ".5", "1e3", "1.5e3", "1..5", "1.5 6", "0x10", "nan"}) {
    const std::string content = std::string(text) + " 63 2.25 0.5\n";
    const std::string found = message_for("Robot1_Measurement.dat", content);
    if (std::string(text) == "1.5 6") {
      EXPECT_THAT(found, testing::HasSubstr("5 fields"));
    } else {
      EXPECT_EQ(found,
                "Robot1_Measurement.dat:1: \"" + std::string(text) + "\" is no time in seconds");
    }
  }
}

TEST_F(MrclamErrors, ATimeBeyondTheRangeOfTheClockIsRefused) {
  EXPECT_EQ(message_for("Robot1_Measurement.dat", "9000000001.0 63 2.25 0.5\n"),
            "Robot1_Measurement.dat:1: \"9000000001.0\" is not within 0 … 9e9 s");
  EXPECT_EQ(message_for("Robot1_Measurement.dat", "99999999999999999999999 63 2.25 0.5\n"),
            "Robot1_Measurement.dat:1: \"99999999999999999999999\" is not within 0 … 9e9 s");
}

TEST_F(MrclamErrors, TimeGoingBackwardsIsNamedWithBothTimes) {
  EXPECT_EQ(message_for("Robot1_Measurement.dat", "12.5 63 1 0\n12.5 63 1 0\n12.499 63 1 0\n"),
            "Robot1_Measurement.dat:3: time goes backwards: 12.499 after 12.5");
  write("Robot1_Measurement.dat", "12.5 63 1 0\n");
  EXPECT_EQ(message_for("Robot2_Groundtruth.dat", "# t\n10.0 5 5 0\n9.0 5 5 0\n"),
            "Robot2_Groundtruth.dat:3: time goes backwards: 9.0 after 10.0");
}

TEST_F(MrclamErrors, WhatIsListedTwiceIsNamed) {
  EXPECT_EQ(message_for("Landmark_Groundtruth.dat", "6 1 2 0 0\n7 3 4 0 0\n6 1 2 0 0\n"),
            "Landmark_Groundtruth.dat:3: landmark 6 is listed twice");
  write("Landmark_Groundtruth.dat", "6 1 2 0 0\n7 3 4 0 0\n");
  EXPECT_EQ(message_for("Barcodes.dat", "1 5\n6 63\n7 63\n"),
            "Barcodes.dat:3: barcode 63 is listed twice");
  EXPECT_EQ(message_for("Barcodes.dat", "1 5\n6 63\n7 81\n6 64\n"),
            "Barcodes.dat:4: subject 6 is listed twice");
}

TEST_F(MrclamErrors, LandmarksAndBarcodesMustMatch) {
  EXPECT_EQ(message_for("Barcodes.dat", "6 63\n7 81\n8 90\n"),
            "Barcodes.dat:3: subject 8 has no position in Landmark_Groundtruth.dat");
  EXPECT_EQ(message_for("Barcodes.dat", "6 63\n"), "Barcodes.dat: landmark 7 has no barcode");
  EXPECT_EQ(message_for("Barcodes.dat", "0 5\n6 63\n7 81\n"),
            "Barcodes.dat:1: subject 0 has no position in Landmark_Groundtruth.dat");
  EXPECT_EQ(message_for("Landmark_Groundtruth.dat", "5 1 2 0 0\n"),
            "Landmark_Groundtruth.dat:1: subject 5 is a robot (1 … 5), not a landmark");
  EXPECT_EQ(message_for("Landmark_Groundtruth.dat", "# none\n"),
            "Landmark_Groundtruth.dat: no landmarks");
}

TEST_F(MrclamErrors, FilesWithoutContentAreNamed) {
  EXPECT_EQ(message_for("Robot2_Groundtruth.dat", ""), "Robot2_Groundtruth.dat: no poses");
  write("Robot1_Measurement.dat", "");
  EXPECT_EQ(message_for("Robot2_Measurement.dat", "# nothing\n"),
            directory_ + ": no robot has a measurement");
}

TEST_F(MrclamErrors, ANonPositiveGapIsABugOfTheCaller) {
  EXPECT_THROW(load(directory_, 2, Duration()), BrokenInvariant);
}

/// Something is wrong with any byte changed, cut or doubled, or it loads to finite numbers.
TEST_F(MrclamErrors, WhateverTheBytesAreOnlyInputErrorsComeOut) {
  const std::array<std::pair<const char*, std::string>, 4> files = {{
      {"Barcodes.dat", "# c\n 1 \t 5\n2 14\n6 63\n7 81\n"},
      {"Landmark_Groundtruth.dat", "6 1.5 -2.0 0.1 0.2\n7 \t 3 4 0.1 0.2\n"},
      {"Robot1_Groundtruth.dat", "10.25 0 1 3.1\n11.000 1 2 -3.1\n12.5 -1 3.25 2e-1\n13 0 0 0\n"},
      {"Robot1_Measurement.dat", "# t b r b\n10.5 63 2.25 -0.5\n12.4 81 1.5 0.1\n12.9 14 1 0\n"},
  }};
  const std::string bytes = std::string("0123456789.-+e#\n\r\t xnainf\xff") + '\0';
  std::uint64_t state = 1;
  const auto draw = [&state](std::size_t n) {  // any cheap sequence will do here
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<std::size_t>(state >> 33) % n;
  };
  for (const auto& [name, good] : files) write(name, good);
  int loaded = 0, refused = 0;
  for (int round = 0; round < 3000; ++round) {
    const auto& [name, good] = files[draw(files.size())];
    std::string content = good;
    for (std::size_t changes = 1 + draw(3); changes > 0 && !content.empty(); --changes) {
      const std::size_t at = draw(content.size());
      switch (draw(4)) {
        case 0:
          content[at] = bytes[draw(bytes.size())];
          break;
        case 1:
          content.erase(at, 1 + draw(8));
          break;
        case 2:
          content.insert(at, 1, bytes[draw(bytes.size())]);
          break;
        default:
          content.insert(at, content.substr(draw(content.size()), 1 + draw(12)));
          break;
      }
    }
    write(name, content);
    try {
      const Dataset set = load(directory_, 1, 700_ms);
      ++loaded;
      const Robot& robot = set.robots.at(0);
      EXPECT_EQ(robot.skips.lines, robot.sightings.size() + robot.skips.truth_gap +
                                       robot.skips.unknown_barcode + robot.skips.robot_sighting +
                                       robot.skips.bad_range);
      for (const Sighting& s : robot.sightings) {
        EXPECT_TRUE(std::isfinite(s.pose.x_m + s.pose.y_m + s.pose.heading_rad)) << content;
        EXPECT_GE(s.time, Time());
        EXPECT_LE(s.time, Time::at(set.span));
        EXPECT_LT(static_cast<std::size_t>(s.landmark), set.landmarks.size());
      }
    } catch (const InputError&) {
      ++refused;
    }
    write(name, good);
  }
  EXPECT_GT(loaded, 300);
  EXPECT_GT(refused, 300);
}

}  // namespace
}  // namespace hearsay::mrclam
