// What stands between an agent and the world it looks at: its sensors, or a log of what they once
// measured. They know the truth; the agent gets measurements alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "agents/context.hpp"
#include "agents/measurement.hpp"
#include "agents/sensors/sensor.hpp"
#include "agents/witness.hpp"

namespace hearsay {

class Lookout {
 public:
  struct Options {
    int dimension = 2;                  ///< of a subject's state
    std::optional<MotionModel> motion;  ///< of the subjects; nothing: they stand still
    /// One a subject: each looks at every `period` from `start` to `end`.
    std::vector<Sensor> sensors;
    bool moves = false;                 ///< sensors go with the agent
    std::optional<double> range_max_m;  ///< what is farther away is not seen; > 0
    /// With a motion: where the subjects are. They outlive this.
    std::span<const Subject> targets;
    Duration period = Duration::nanoseconds(1'000'000'000);
    Time start;
    Time end = Time::never();
    /// Measurements to replay, by time; they outlive this.
    std::span<const Observation> observations;
  };
  /// Of the agent of `context`. All outlive this.
  Lookout(Context& context, Witness& witness, MeasurementReceiver& receiver, Options options);

  /// Once, before the agent starts.
  void start();
  /// Once, after the agent has finished: leaves what cameras saw in the record.
  void finish();

 private:
  Process look();
  Process replay();
  /// The `count`-th look; nothing if the subject is too far away, or the look missed it.
  std::optional<gaussian::Belief> look_at(int subject, std::uint64_t count);
  /// From where the agent is, to where the subject is.
  void aim(Sensor& sensor, int subject);
  void measured(int subject, const gaussian::Belief& information);

  Context& context_;
  Witness& witness_;
  MeasurementReceiver& receiver_;
  Options options_;
  Process looking_, replaying_;
};

}  // namespace hearsay
