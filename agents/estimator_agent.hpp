// The estimator agent: looks, updates, talks now and then, fuses what it hears.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "agents/agent.hpp"
#include "agents/estimators/static_gaussian.hpp"
#include "agents/sensors/position.hpp"
#include "agents/talk/periodic.hpp"
#include "agents/witness.hpp"

namespace hearsay {

/// A measurement known beforehand, such as one read from a log.
struct Observation {
  Time time;
  int subject;
  gaussian::Belief information;
};

class EstimatorAgent final : public Agent {
 public:
  struct Options {
    gaussian::Rule rule = gaussian::Rule::none;
    int subjects = 1;
    int dimension = 2;
    /// One a subject: each looks at every `sensor_period` from `sensor_start` to `sensor_end`.
    std::vector<PositionSensor> sensors;
    bool moves = false;  ///< sensors go with the agent
    Duration sensor_period = Duration::nanoseconds(1'000'000'000);
    Time sensor_start;
    Time sensor_end = Time::never();
    /// Measurements to replay, by time; they outlive the agent.
    std::span<const Observation> observations;
    std::optional<PeriodicTalk> talk;  ///< nothing: never talks
  };
  EstimatorAgent(Context& context, Witness& witness, Options options);

  void start() override;
  void on_packet(const Packet& packet) override;
  void on_up(bool forgets) override;

  const StaticGaussianEstimator& estimator() const { return estimator_; }

 private:
  Process look();
  gaussian::Belief look_at(const PositionSensor& sensor, Stream& draws);
  Process replay();
  Process talk();
  void say(std::uint64_t tick);
  void say_to(AgentId receiver, std::uint64_t tick);

  Witness& witness_;
  Options options_;
  StaticGaussianEstimator estimator_;
  NameId message_kind_;
  std::vector<AgentId> listeners_;  // of the talk that is being held
};

}  // namespace hearsay
