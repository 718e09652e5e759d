#include "agents/robots/floor_body.hpp"

#include <utility>

namespace hearsay {

FloorBody::FloorBody(Context& context, RobotWorld& world, Options options)
    : context_(context), world_(world), options_(std::move(options)) {}

void FloorBody::scan(std::span<double> distances_m) {
  world_.floor().scan(options_.robot, *options_.fan, options_.range_m, distances_m);
}

plan::RobotFloor::Step FloorBody::drive(const drive::Command& wanted, double dt_s) {
  return world_.floor().drive(options_.robot, wanted, dt_s);
}

bool FloorBody::happens(trails::EventId event) { return world_.happens(options_.robot, event); }

bool FloorBody::put_back(std::uint64_t count) {
  return world_.carry(options_.robot, options_.start, context_.stream_at("put back", count));
}

std::optional<plan::Path> FloorBody::way(trails::EventId event) {
  return world_.way(options_.robot, event);
}

}  // namespace hearsay
