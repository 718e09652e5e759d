// A small data set of the MRCLAM format in a temporary directory: two robots, two landmarks.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace hearsay::mrclam {

class SmallDataset : public testing::Test {
 protected:
  SmallDataset() {
    std::string pattern = testing::TempDir() + "/hearsay_mrclam_XXXXXX";
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary directory");
    directory_ = pattern;
    write("Barcodes.dat",
          "# Subject #    Barcode #\n  1 \t   5\n  2 \t  14\n  6 \t  63\n  7 \t  81\n");
    write("Landmark_Groundtruth.dat",
          "# Subject, x, y, std-devs\n  6 \t 1.5 \t -2.0 \t 0.0001 \t 0.0002\n"
          "  7 \t 3.0 \t 4.0 \t 0.0001 \t 0.0002\n");
    write("Robot1_Groundtruth.dat", "# Time x y orientation\n10.0 0 0 0\n20.0 10 20 1\n");
    write("Robot1_Measurement.dat", "# Time barcode range bearing\n12.5 63 2.25 -0.5\n");
    write("Robot2_Groundtruth.dat", "10.0 5 5 0\n20.0 5 5 0\n");
    write("Robot2_Measurement.dat", "13.0 81 1.0 0.25\n");
  }
  ~SmallDataset() override {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }

  void write(const std::string& name, const std::string& content) const {
    std::filesystem::remove(path(name));  // some file systems wait for the disk on a truncation
    std::ofstream(path(name), std::ios::binary) << content;
  }
  void remove(const std::string& name) const { std::filesystem::remove(path(name)); }
  /// A message with the names of files alone.
  std::string without_directory(std::string text) const {
    const std::string prefix = directory_ + "/";
    for (auto at = text.find(prefix); at != std::string::npos; at = text.find(prefix)) {
      text.erase(at, prefix.size());
    }
    return text;
  }
  std::string path(const std::string& name) const { return directory_ + "/" + name; }

  std::string directory_;
};

}  // namespace hearsay::mrclam
