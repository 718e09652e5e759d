#include "agents/grids/area_look.hpp"

namespace hearsay {

AreaLook::AreaLook(Context& context, GridWitness& witness, const GridSensor::Options& sensor,
                   const grid::Area& area)
    : context_(context), witness_(witness), sensor_(sensor, area) {}

Looks AreaLook::look(double heading_rad, std::uint64_t count) {
  const auto looks = sensor_.look(context_.position(), heading_rad, witness_.truth(),
                                  context_.simulation().seed(), context_.id(), count);
  return {looks, witness_.looked(context_.id(), looks)};
}

}  // namespace hearsay
