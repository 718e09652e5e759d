// The body of a robot on a floor of this process.
#pragma once

#include <memory>

#include "agents/context.hpp"
#include "agents/robots/robot_body.hpp"
#include "agents/robots/robot_world.hpp"

namespace hearsay {

class FloorBody final : public RobotBody {
 public:
  struct Options {
    int robot = 0;                         ///< its number on the floor
    RobotWorld::Start start;               ///< where it is put back
    std::shared_ptr<const plan::Fan> fan;  ///< of its scanner
    double range_m = 5.0;                  ///< > 0
  };
  /// Both outlive this.
  FloorBody(Context& context, RobotWorld& world, Options options);

  const drive::Pose& pose() const override { return world_.pose(options_.robot); }
  void scan(std::span<double> distances_m) override;
  plan::RobotFloor::Step drive(const drive::Command& wanted, double dt_s) override;
  bool happens(trails::EventId event) override;
  bool put_back(std::uint64_t count) override;
  std::optional<plan::Path> way(trails::EventId event) override;

 private:
  Context& context_;
  RobotWorld& world_;
  Options options_;
};

}  // namespace hearsay
