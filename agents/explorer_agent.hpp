// The explorer: flies over an area with a certainty grid, looks, moves to where a look is expected
// to tell most, tells others what it believes and takes in what they tell. Merino 2007, chapter 4.
//
// One that is steered decides where it goes; another flies as its motion says, and only looks and
// talks.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "agents/agent.hpp"
#include "agents/behaviours/exploration.hpp"
#include "agents/grids/area_look.hpp"
#include "agents/grids/grid_estimator.hpp"
#include "agents/sensors/grid_sensor.hpp"
#include "agents/talk/periodic.hpp"

namespace hearsay {

class ExplorerAgent final : public Agent {
 public:
  struct Options {
    grid::Area area;
    GridEstimator::Options estimator;
    LookSource* looks = nullptr;  ///< null: it knows what others tell, no more. Not owned
    /// Where it weighs where to go: what it would see from there.
    std::optional<GridSensor::Options> sensor;
    Duration sensor_period = Duration::nanoseconds(1'000'000'000);
    Time sensor_start;
    Time sensor_end = Time::never();
    std::optional<Exploration::Options> exploration;  ///< of one that is steered
    double speed_m_per_s = 1.0;                       ///< of one that is steered, > 0
    std::optional<PeriodicTalk> talk;                 ///< nothing: never talks
  };
  /// Packets are numbered by talk and part: a message must not take more than these, nor a run have
  /// more talks.
  static constexpr std::uint64_t packets_a_talk_max = std::uint64_t{1} << 20;
  static constexpr std::uint64_t talks_max = std::uint64_t{1} << 28;

  /// `riders`: where the ledgers of its messages come from; nullptr: they are off. Both outlive it.
  ExplorerAgent(Context& context, RiderPool<GridRider>* riders, const Options& options);

  void start() override;
  void on_packet(const Packet& packet) override;
  /// One that lost its memory knows nothing, and explores anew.
  void on_up(bool forgets) override;
  /// Leaves what it counted.
  void finish() override;

  const GridEstimator& estimator() const { return estimator_; }

 private:
  Process look();
  Process explore();
  Process talk();
  void say(AgentId receiver, std::uint64_t talk);
  /// Where it flies to, by its last two places.
  void turn_to(const Point& place);
  double gain_at(const Exploration::State& state);

  Options options_;
  GridEstimator estimator_;
  std::optional<GridSensor> sensor_;
  std::optional<Exploration> exploration_;
  NameId message_kind_;
  double heading_rad_ = 0.0;
  std::optional<Point> last_place_;
  double flown_m_ = 0.0;
  std::vector<AgentId> listeners_;  // of the talk that is being held
};

}  // namespace hearsay
