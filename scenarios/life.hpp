// Agents that fail and come back in the course of a run.
#pragma once

#include <memory>
#include <vector>

#include "agents/agent.hpp"
#include "net/faults.hpp"

namespace hearsay {

/// Switches agents and their radios off and on, and records an event each time ("down", "up", or
/// "up without memory").
class Life {
 public:
  /// All outlive this; `agents` and what carries their words (null: the radio) by number.
  Life(Simulation& simulation, Radio& radio, std::vector<std::unique_ptr<Agent>>& agents,
       std::vector<std::unique_ptr<Gossip>>& gossips, Dropouts dropouts);
  ~Life();
  Life(const Life&) = delete;
  Life& operator=(const Life&) = delete;

  /// Once, before the run.
  void start();

 private:
  struct Row {
    Outage outage;  // the next one, or the one that is
    EventId event;
  };
  void await(std::size_t row);
  void go_down(std::size_t row);
  void come_up(std::size_t row);

  Simulation& simulation_;
  Radio& radio_;
  std::vector<std::unique_ptr<Agent>>& agents_;
  std::vector<std::unique_ptr<Gossip>>& gossips_;
  Dropouts dropouts_;
  std::vector<Row> rows_;  // of those who may fail
};

}  // namespace hearsay
