// Scenario files that read a small data set: two robots, two landmarks, in a directory of its own.
#pragma once

#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "scenarios/run.hpp"
#include "sim/kernel/error.hpp"
#include "tests/scenarios/run_values.hpp"
#include "tests/scenarios/with.hpp"
#include "tests/sim/world/small_dataset.hpp"

namespace hearsay {

class LogBed : public mrclam::SmallDataset {
 protected:
  /// What a run left, by agent, name, and time in seconds.
  struct Values {
    std::map<std::pair<AgentId, std::string>, double> scalars;
    std::map<std::pair<AgentId, std::string>, std::map<double, double>> series;  // of its subject
    std::string digested;
    Time end;

    double scalar(AgentId agent, const std::string& name) const {
      return scalars.at({agent, name});
    }
  };

  std::shared_ptr<const PreparedScenario> prepared(const std::string& scenario) {
    write("s.toml", scenario);
    return prepare(load_scenario(path("s.toml"), {}, known_names(catalog_)), catalog_, logs_);
  }
  /// The InputError of this scenario without the directory, or "no error".
  std::string error(const std::string& scenario) {
    try {
      prepared(scenario);
    } catch (const InputError& error) {
      return without_directory(error.what());
    }
    return "no error";
  }
  /// Series are kept of the subject of this name, or of all if it is empty.
  Values run(const std::string& scenario, const std::string& subject = "") {
    DigestedBytes digest;
    hearsay::Run run(prepared(scenario), catalog_, {.seed = 3, .digest = &digest});
    const RunEnd end = run.run();
    EXPECT_TRUE(end.ok()) << end.message;
    Values values;
    values.end = end.at;
    const Record& record = run.record();
    for (const ScalarRow& row : record.scalars()) {
      values.scalars[{row.agent, record.text(row.name)}] = row.value;
    }
    for (const SeriesRow& row : record.series()) {
      if (!subject.empty() && record.text(row.subject) != subject) continue;
      values.series[{row.agent, record.text(row.name)}][row.time.seconds()] = row.value;
    }
    values.digested = digest.all;
    return values;
  }

  /// A line of a file of measurements.
  static std::string line_of(double time_s, int barcode, double range_m, double bearing_rad) {
    char text[128];
    std::snprintf(text, sizeof(text), "%.3f %d %.17g %.17g\n", time_s, barcode, range_m,
                  bearing_rad);
    return text;
  }

  Catalog catalog_;
  LogCache logs_;
};

}  // namespace hearsay
