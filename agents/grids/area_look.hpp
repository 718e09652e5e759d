// What an explorer's sensor gives it, and the sensor as it stands in the world: it knows the truth,
// and who else hears of each look; the agent gets looks alone.
#pragma once

#include <cstdint>
#include <span>

#include "agents/context.hpp"
#include "agents/grids/grid_witness.hpp"
#include "agents/sensors/grid_sensor.hpp"

namespace hearsay {

struct Looks {
  std::span<const grid::CellLook> looks;
  std::span<const std::uint32_t> indices;  ///< in the run's book; none if ledgers are off
};

class LookSource {
 public:
  virtual ~LookSource() = default;
  /// The `count`-th look, now, towards a heading. Valid until the next one.
  virtual Looks look(double heading_rad, std::uint64_t count) = 0;
};

/// Of the agent of a context, from where it is.
class AreaLook final : public LookSource {
 public:
  /// `context` and `witness` outlive this.
  AreaLook(Context& context, GridWitness& witness, const GridSensor::Options& sensor,
           const grid::Area& area);

  Looks look(double heading_rad, std::uint64_t count) override;

 private:
  Context& context_;
  GridWitness& witness_;
  GridSensor sensor_;
};

}  // namespace hearsay
