// What a scenario says about agents that track.
#pragma once

#include <optional>
#include <string>

namespace hearsay {

struct TrackerSpec {
  std::string fusion = "none";  ///< a name of gaussian::rules() that needs no memory
  std::optional<double> acceleration_psd_m2_per_s3;  ///< none: targets stand still; > 0
  double birth_speed_sigma_m_per_s = 10.0;           ///< > 0
  double gate = 9.0;                                 ///< of squared distances, > 0
  std::string association = "nearest";               ///< "nearest" | "optimal"
  int confirm_hits = 3;                              ///< 1 … confirm_scans
  int confirm_scans = 4;                             ///< 1 … 1000
  int misses_max = 5;                                ///< 1 … 1e6
  double sigma_max_m = 100.0;                        ///< > 0
  int tracks_max = 1000;                             ///< 1 … 1e5
  int apart_max = 3;                                 ///< 1 … 1e6
  std::optional<double> trail_s;  ///< none: tracks have no trails; > 0; targets that move
  bool operator==(const TrackerSpec&) const = default;
};

/// How tracks are judged.
struct TrackScoreSpec {
  double order = 2.0;      ///< of OSPA and GOSPA, 1 … 100
  double cutoff_m = 20.0;  ///< of both, > 0
};

}  // namespace hearsay
