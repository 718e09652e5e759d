// What a run left, as test beds look at it.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "sim/kernel/record.hpp"

namespace hearsay {

/// All that a record feeds to its digest.
struct DigestedBytes : DigestSink {
  void update(std::span<const std::byte> bytes) override {
    for (const std::byte byte : bytes) all += static_cast<char>(byte);
  }
  std::string all;
};

/// By agent and name; series by time in seconds and subject.
struct RunValues {
  std::map<std::pair<AgentId, std::string>, double> scalars;
  std::map<std::pair<AgentId, std::string>, std::map<std::pair<double, std::string>, double>>
      series;
  std::string digested;

  double scalar(AgentId agent, const std::string& name) const { return scalars.at({agent, name}); }
  void take(const Record& record) {
    for (const ScalarRow& row : record.scalars()) {
      scalars[{row.agent, record.text(row.name)}] = row.value;
    }
    for (const SeriesRow& row : record.series()) {
      series[{row.agent, record.text(row.name)}][{row.time.seconds(), record.text(row.subject)}] =
          row.value;
    }
  }
};

}  // namespace hearsay
