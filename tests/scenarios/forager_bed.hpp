// Scenarios of foragers and what their runs leave.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/run.hpp"
#include "tests/scenarios/run_values.hpp"
#include "tests/scenarios/temp_files.hpp"
#include "tests/scenarios/with.hpp"

namespace hearsay {

class ForagerBed : public InTempDirectory {
 protected:
  struct Event {
    double time_s;
    AgentId agent;
    std::string kind, detail;
  };
  struct Values : RunValues {
    std::vector<Event> events;

    /// Over time.
    std::map<double, double> over_time(AgentId agent, const std::string& name) const {
      std::map<double, double> values;
      for (const auto& [at, value] : series.at({agent, name})) {
        if (at.second.empty()) values[at.first] = value;
      }
      return values;
    }
    /// Trip by trip.
    std::vector<double> by_trip(AgentId agent, const std::string& name) const {
      std::map<int, double> values;
      const auto found = series.find({agent, name});
      if (found == series.end()) return {};
      for (const auto& [at, value] : found->second) values[std::stoi(at.second)] = value;
      std::vector<double> in_order;
      for (const auto& [trip, value] : values) in_order.push_back(value);
      return in_order;
    }
    /// When an event of that kind happened to an agent.
    std::vector<double> times(AgentId agent, const std::string& kind) const {
      std::vector<double> values;
      for (const Event& event : events) {
        if (event.agent == agent && event.kind == kind) values.push_back(event.time_s);
      }
      return values;
    }
  };

  Values run(const std::string& text, std::uint64_t seed = 3) {
    std::string names;
    for (const std::string& name : series_) names += (names.empty() ? "\"" : ", \"") + name + '"';
    write("s.toml", with(text, "[record]\n", "[record]\nseries = [" + names + "]\n"));
    const auto prepared =
        prepare(load_scenario("s.toml", {}, known_names(catalog_)), catalog_, logs_);
    DigestedBytes digest;
    hearsay::Run run(prepared, catalog_, {.seed = seed, .digest = &digest});
    const RunEnd end = run.run();
    EXPECT_TRUE(end.ok()) << end.message;
    Values values;
    const Record& record = run.record();
    values.take(record);
    for (const EventRow& row : record.events()) {
      values.events.push_back({row.time.seconds(), row.agent, record.text(row.kind), row.detail});
    }
    values.digested = digest.all;
    return values;
  }

  std::vector<std::string> series_;  ///< names of what is kept over time
  Catalog catalog_;
  LogCache logs_;
};

/// A corridor of so many cells of half a metre, 3 m wide, with A and B in its middle, so many cells
/// from its ends.
inline std::string straight_corridor(std::size_t cells, std::size_t from_end) {
  const std::string wall(cells + 2, '#');
  const std::string open = "#" + std::string(cells, ' ') + "#\n";
  std::string middle = open;
  middle[1 + from_end] = 'A';
  middle[cells - from_end] = 'B';
  return wall + "\n" + open + open + open + middle + open + open + wall + "\n";
}

}  // namespace hearsay
