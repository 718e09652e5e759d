// Estimators of grids that tell each other of them in memory: a radio that does what a test wants.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "agents/grids/grid_estimator.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {

struct GridLetter {
  AgentId from = 0, to = 0;
  std::vector<std::byte> bytes;
  RiderPtr rider;
};

inline grid::CellLook look_at(int cell, double ratio) { return {cell, ratio, 0.0, 0.0}; }
inline grid::CellLook counted_at(int cell, double m, double n) { return {cell, 0.0, m, n}; }

/// Agents on a graph.
class GridFleet {
 public:
  using Edges = std::vector<std::pair<AgentId, AgentId>>;

  GridFleet(int agents, Edges edges, const grid::Area& area, const GridEstimator::Options& options)
      : options_(options),
        edges_(std::move(edges)),
        central_(area, options.belief),
        book_(central_.shape()) {
    for (int i = 0; i < agents; ++i) agents_.emplace_back(area, options, &riders_);
  }

  GridEstimator& agent(AgentId id) { return agents_[static_cast<std::size_t>(id)]; }
  /// What one would believe who was told of every look at once.
  const GridBelief& central() const { return central_; }
  const grid::LookBook& book() const { return book_; }
  /// How far what the ledger of `id` says it believes is from what it does believe.
  double ledger_gap(AgentId id) {
    return grid::largest_gap(agent(id).ledger(), book_, agent(id).belief().evidence());
  }
  AgentId agents() const { return static_cast<AgentId>(agents_.size()); }

  void look(AgentId id, const grid::CellLook& look) {
    const std::uint32_t index = book_.add(look);
    agent(id).looked({&look, 1}, {&index, 1});
    central_.add({&look, 1});
  }

  std::vector<AgentId> neighbours(AgentId id) const {
    std::vector<AgentId> all;
    for (const auto& [a, b] : edges_) {
      if (a == id) all.push_back(b);
      if (b == id) all.push_back(a);
    }
    return all;
  }

  /// What `from` says at its `talk`-th talk, one letter a packet and hearer; it is booked as sent.
  std::vector<GridLetter> say(AgentId from, std::uint64_t talk) {
    const std::vector<AgentId> hearers = neighbours(from);
    std::vector<GridLetter> letters;
    const auto tell = [&](AgentId receiver, const std::vector<AgentId>& to) {
      const auto packets = agent(from).speech(receiver, talk);
      for (const std::vector<std::byte>& packet : packets) {
        EXPECT_LE(packet.size(), options_.packet_bytes);
        agent(from).sent(receiver, packet, hearers);
        for (const AgentId hearer : to) {
          letters.push_back({from, hearer, packet, agent(from).rider()});
        }
      }
    };
    if (!agent(from).addresses()) {
      tell(no_agent, hearers);
    } else {
      for (const AgentId hearer : hearers) tell(hearer, {hearer});
    }
    return letters;
  }

  void deliver(const GridLetter& letter) {
    agent(letter.to).heard(letter.from, letter.bytes, letter.rider.get());
  }
  void deliver(const std::vector<GridLetter>& letters) {
    for (const GridLetter& letter : letters) deliver(letter);
  }

  /// Everybody says what it believes, then everybody hears it.
  void talk_at_once(std::uint64_t talk) {
    std::vector<GridLetter> all;
    for (AgentId id = 0; id < agents(); ++id) {
      for (GridLetter& letter : say(id, talk)) all.push_back(std::move(letter));
    }
    deliver(all);
  }

  /// The largest difference of a number in the evidence of `id` from the central one.
  double off(AgentId id) {
    const std::span<const float> own = agent(id).belief().evidence(), all = central_.evidence();
    double most = 0.0;
    for (std::size_t i = 0; i < own.size(); ++i) {
      most = std::max(most, std::fabs(static_cast<double>(own[i]) - static_cast<double>(all[i])));
    }
    return most;
  }

 private:
  GridEstimator::Options options_;
  Edges edges_;
  GridBelief central_;
  grid::LookBook book_;
  RiderPool<GridRider> riders_;
  std::vector<GridEstimator> agents_;
};

}  // namespace hearsay
