// What a scenario says of the channel and of failures, as typed data: losses, propagation, jammers,
// dropouts. Values that belong to another model than the one named keep their defaults.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace hearsay {

/// An agent, in a file by number or by name; the checks turn names into numbers.
struct AgentRef {
  int number = -1;  ///< −1 while it is known by its name
  bool operator==(const AgentRef&) const = default;
};

/// Loss on one directed link.
struct LinkLossSpec {
  std::optional<AgentRef> from;       ///< needed
  std::optional<AgentRef> to;         ///< needed
  std::optional<double> probability;  ///< needed, [0, 1]
};

struct LossSpec {
  std::string model = "none";         ///< "none" | "bernoulli" | "gilbert-elliott"
  double probability = 0.0;           ///< [0, 1]; gilbert-elliott: the stationary one
  std::vector<LinkLossSpec> links;    ///< bernoulli
  std::optional<double> mean_burst;   ///< gilbert-elliott, with probability; 1 … 1e6
  std::optional<double> good_to_bad;  ///< gilbert-elliott instead: p, [0, 1]
  std::optional<double> bad_to_good;  ///< … and r, (0, 1]
  double loss_good = 0.0;             ///< gilbert-elliott, [0, 1]
  double loss_bad = 1.0;              ///< gilbert-elliott, [0, 1]
};

/// For topology = "by-position". Defaults of log-distance as in net/propagation.hpp.
struct PropagationSpec {
  std::string model = "disk";          ///< "disk" | "grey-zone" | "log-distance"
  std::optional<double> range_m;       ///< disk: needed; log-distance: nobody hears beyond; > 0
  double inner_m = 0.0;                ///< grey-zone, ≥ 0
  double outer_m = 0.0;                ///< grey-zone: needed, > 0
  double exponent = 3.0;               ///< log-distance, 1 … 10
  double reference_loss_db = 46.6777;  ///< log-distance, −200 … 200
  double reference_m = 1.0;            ///< log-distance, > 0
  double shadowing_sigma_db = 0.0;     ///< log-distance, 0 … 30
  double transmit_dbm = 0.0;           ///< log-distance, −200 … 200
  double noise_dbm = -105.0;           ///< log-distance, −200 … 200
};

struct JammerSpec {
  std::vector<double> position_m;   ///< needed: 2 coordinates
  std::optional<double> radius_m;   ///< > 0
  std::optional<double> power_dbm;  ///< instead of radius_m, with log-distance; −200 … 200
  double from_s = 0.0;              ///< ≥ 0
  std::optional<double> until_s;    ///< > from_s; default: the end of the run
  std::optional<double> period_s;   ///< > 0, with duty; default: always on
  std::optional<double> duty;       ///< (0, 1]
};

struct DropoutSpec {
  std::vector<AgentRef> agents;       ///< empty: all
  std::string kind = "sleep";         ///< "die" | "sleep" | "reboot"
  std::optional<bool> memory;         ///< reboot; default: it forgets
  std::optional<double> from_s;       ///< ≥ 0
  std::optional<double> until_s;      ///< > from_s; sleep and reboot with from_s need it
  std::optional<double> mean_up_s;    ///< instead of from_s: at random; > 0
  std::optional<double> mean_down_s;  ///< > 0; sleep and reboot with mean_up_s need it
  std::optional<int> outages_max;     ///< with mean_down_s, ≥ 1; default: without end
};

}  // namespace hearsay
