// Data sets read once and shared by all runs that use them.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "sim/world/mrclam.hpp"

namespace hearsay {

/// Safe to use from several threads.
class LogCache {
 public:
  /// As mrclam::load().
  std::shared_ptr<const mrclam::Dataset> get(const std::string& directory, int robots,
                                             Duration truth_gap_max, mrclam::Odometry odometry);

 private:
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<const mrclam::Dataset>> datasets_;
};

}  // namespace hearsay
