// A simulation with radios that move, hear by place and write down what becomes of packets.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "net/movement.hpp"
#include "net/radio.hpp"
#include "sim/world/motion.hpp"
#include "tests/net/bed.hpp"
#include "tests/sim/world/paths.hpp"

namespace hearsay {

class Motions final : public PathSource {
 public:
  using Make = std::function<std::unique_ptr<Motion>(AgentId)>;
  Motions(int agents, const Make& make) {
    for (AgentId a = 0; a < agents; ++a) motions_.push_back(make(a));
  }
  Leg next(AgentId agent, Time) override {
    return motions_[static_cast<std::size_t>(agent)]->next();
  }

 private:
  std::vector<std::unique_ptr<Motion>> motions_;
};

class Fleet {
 public:
  Fleet(int agents, const Motions::Make& make, const RadioOptions& options, Time end,
        std::uint64_t seed = 1)
      : simulation(
            {.seed = seed, .end = end, .record = {.keep_messages = true, .digest = &digest}}),
        motions_(agents, make),
        places_(agents, options.propagation.reach_m(), 0.2 * options.propagation.reach_m()),
        movement_(simulation, places_, motions_),
        radio(simulation,
              Reach{.topology = Topology::edges(agents, {}), .places = &places_, .by_place = true},
              options) {
    for (AgentId a = 0; a < agents; ++a) paths_.emplace_back(make(a));
  }
  /// At an instant, in the phase in which agents talk.
  void send(Duration at, AgentId from, std::size_t bytes, AgentId to = no_agent) {
    simulation.schedule(Time::at(at), Phase::act, [this, from, bytes, to] {
      const std::string text(bytes, 'x');
      radio.send(from, {.bytes = bytes_of(text), .receiver = to});
    });
  }
  void run() {
    const RunEnd ended = simulation.run();
    EXPECT_TRUE(ended.ok()) << ended.message;
    radio.finish();
    simulation.record().finish();
  }
  /// Where `agent` is, from a path of its own. Times must not go back.
  Point at(AgentId agent, Time time) { return paths_[static_cast<std::size_t>(agent)].at(time); }
  std::span<const MessageRow> rows() const { return simulation.record().messages(); }
  const std::string& fate_of(const MessageRow& row) const {
    return simulation.record().text(row.fate);
  }

  FnvDigest digest;
  Simulation simulation;

 private:
  Motions motions_;
  Places places_;
  Movement movement_;
  std::vector<motion::Path> paths_;

 public:
  Radio radio;
};

}  // namespace hearsay
