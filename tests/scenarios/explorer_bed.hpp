// Scenarios of explorers, their errors and what their runs leave.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "scenarios/run.hpp"
#include "tests/scenarios/run_values.hpp"
#include "tests/scenarios/temp_files.hpp"
#include "tests/scenarios/with.hpp"

namespace hearsay {

class ExplorerBed : public InTempDirectory {
 protected:
  struct Values : RunValues {
    /// The last value of a subject, "" for the whole.
    double last(AgentId agent, const std::string& name, const std::string& subject = "") const {
      double value = -1.0;
      for (const auto& [at, v] : series.at({agent, name})) {
        if (at.second == subject) value = v;
      }
      return value;
    }
  };

  std::shared_ptr<const PreparedScenario> prepared(const std::string& text) {
    write("s.toml", text);
    return prepare(load_scenario("s.toml", {}, known_names(catalog_)), catalog_, logs_);
  }
  std::string error(const std::string& text) {
    return error_of([&] { prepared(text); });
  }
  /// As the run ended, "" if well.
  std::string end_of(const std::string& text) {
    hearsay::Run run(prepared(text), catalog_, {.seed = 3});
    return run.run().message;
  }
  Values run(const std::string& text, std::uint64_t seed = 3) {
    DigestedBytes digest;
    hearsay::Run run(prepared(text), catalog_, {.seed = seed, .digest = &digest});
    const RunEnd end = run.run();
    EXPECT_TRUE(end.ok()) << end.message;
    Values values;
    values.take(run.record());
    values.digested = digest.all;
    return values;
  }

  Catalog catalog_;
  LogCache logs_;
};

}  // namespace hearsay
