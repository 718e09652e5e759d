// What goes wrong beside the channel: agents that are away for a while, and jammers.
//
// An agent is away from an outage's begin (inclusive) to its end (exclusive). Outages that overlap
// or touch are one: it lasts to the latest end, and the agent forgets if any of them forgets. Hence
// death outlasts everything, and a reboot without memory is not undone by a sleep about it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "net/propagation.hpp"
#include "sim/kernel/ids.hpp"
#include "sim/kernel/leg.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// A time in which an agent neither sends, hears, measures nor thinks.
struct Outage {
  AgentId agent = no_agent;
  Time from;
  Time until = Time::never();  ///< never: it is dead
  bool forgets = false;        ///< it comes back knowing nothing

  bool operator==(const Outage&) const = default;
};

/// The outages joined as said above: by agent, then by time, none empty, none touching another.
std::vector<Outage> merged(std::vector<Outage> outages);

/// An agent that fails at random: up for an exponential time, then down for another, and so on; up
/// at the start of the run. Outage k of the agent is the draw named (seed, "dropout", agent, k).
struct OutageRate {
  AgentId agent = no_agent;
  double mean_up_s = 0.0;                  ///< > 0, finite
  std::optional<double> mean_down_s = {};  ///< > 0, finite; none: the first outage is its death
  bool forgets = false;
  std::uint64_t outages_max = std::uint64_t{1} << 47;  ///< at most 2^47
};

/// What is wrong with the values; empty if nothing is.
std::string wrong_with(const Outage& outage);
std::string wrong_with(const OutageRate& rate);

/// All outages of a run, made one after another as they are asked for.
class Dropouts {
 public:
  struct Options {
    std::uint64_t seed = 1;
    Time end = Time::never();  ///< outages that would begin then or later are left out
    std::vector<Outage> schedule = {};
    /// An agent may stand there several times: then it has as many independent causes to fail.
    std::vector<OutageRate> rates = {};
  };

  /// Nobody ever fails.
  Dropouts() = default;
  /// @throws InputError with what is wrong_with an outage or a rate.
  explicit Dropouts(Options options);

  /// Who may fail, in order of number.
  std::span<const AgentId> agents() const { return agents_; }
  /// The agent's first outage, then its second, …, in order of time; nothing when there is no more.
  std::optional<Outage> next(AgentId agent);

 private:
  // Where outages come from, one at a time.
  struct Source {
    OutageRate rate;
    Entity entity{0};
    std::uint64_t made = 0;
    Time up_since;
  };
  void advance(Source& source, std::optional<Outage>& head) const;
  std::optional<Outage> take_first(std::size_t row, Time latest);
  void no_more(std::size_t row);

  std::uint64_t seed_ = 0;
  Time end_ = Time::never();
  std::vector<AgentId> agents_;
  // Rows of agents_: where each one's part of the following begins.
  std::vector<std::size_t> first_planned_;
  std::vector<std::size_t> first_source_;
  std::vector<std::size_t> planned_at_;  // next of the agent
  std::vector<Outage> planned_;          // merged
  std::vector<Source> sources_;
  std::vector<std::optional<Outage>> heads_;  // of each source: its next one
};

/// A sender of noise at a fixed place.
struct Jammer {
  Point position_m{};
  /// > 0: whoever is that near hears nothing. Not with a power.
  std::optional<double> radius_m = {};
  /// Instead: noise of this power, −200 … 200, at the jammer; it falls with the path loss of
  /// log-distance, without shadowing.
  std::optional<double> power_dbm = {};
  Time from;
  Time until = Time::never();  ///< > from, exclusive
  Duration period = {};        ///< > 0: on for duty · period, off for the rest; 0: always on
  double duty = 1.0;           ///< with a period, in (0, 1]
};

std::string wrong_with(const Jammer& jammer);

/// Whether the jammer is on at any instant of from … until (exclusive; at `from` at least).
bool is_on(const Jammer& jammer, Time from, Time until);

class Jammers {
 public:
  Jammers() = default;
  /// @throws InputError with what is wrong_with one of them.
  explicit Jammers(std::vector<Jammer> jammers);

  bool none() const { return jammers_.empty(); }
  /// Whether a receiver there is within the radius of a jammer that is on at any instant of the
  /// reception: then it is lost, whatever its power.
  bool jams(const Point& receiver_m, Time from, Time until) const;
  /// The power at the receiver of all jammers with a power that are on at any instant of the
  /// reception, for Propagation::quality(). @throws BrokenInvariant if there are any and
  /// `propagation` knows no powers.
  double interference_mw(const Point& receiver_m, Time from, Time until,
                         const Propagation& propagation) const;

 private:
  std::vector<Jammer> jammers_;
};

}  // namespace hearsay
