// What tests of graphs share.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "net/topology.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {

using Pair = std::pair<AgentId, AgentId>;

/// Each edge once, the smaller number first. Expects links both ways and nobody joined to itself.
inline std::set<Pair> edges_of(const Topology& topology) {
  std::set<Pair> edges;
  for (AgentId a = 0; a < topology.agents(); ++a) {
    for (const AgentId b : topology.neighbours(a)) {
      EXPECT_NE(a, b);
      EXPECT_GE(topology.link(b, a), 0);
      if (a < b) edges.insert({a, b});
    }
  }
  EXPECT_EQ(2 * edges.size(), topology.links());
  return edges;
}

/// What the InputError thrown by `call` says.
template <typename Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no such error";
}

/// Half the width of the 4σ interval of a share among `trials`.
inline double tolerance(double share, int trials) {
  return 4.0 * std::sqrt(share * (1.0 - share) / trials);
}

/// A mean with its standard error.
class Average {
 public:
  void add(double x) {
    ++count_;
    sum_ += x;
    squares_ += x * x;
  }
  double mean() const { return sum_ / count_; }
  double error() const { return std::sqrt((squares_ / count_ - mean() * mean()) / (count_ - 1)); }

 private:
  int count_ = 0;
  double sum_ = 0.0, squares_ = 0.0;
};

}  // namespace hearsay
