// A small study whose runs are made up by the test, in a database of its own.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scenarios/study.hpp"
#include "sim/kernel/random.hpp"
#include "sim/kernel/record.hpp"
#include "sim/record/database.hpp"
#include "tools/analysis/claims.hpp"
#include "tools/analysis/labels.hpp"

namespace hearsay::analysis {

inline constexpr double null = std::numeric_limits<double>::quiet_NaN();

/// What a test writes into one run.
class Rows {
 public:
  explicit Rows(Record& record) : record_(record) {}
  void series(double t_s, AgentId agent, const std::string& name, double value,
              const std::string& subject = "target") {
    record_.series(Time::nanoseconds(std::llround(t_s * 1e9)), agent, record_.name(subject),
                   record_.name(name), value);
  }
  void scalar(AgentId agent, const std::string& name, double value) {
    record_.scalar(agent, record_.name(name), value);
  }

 private:
  Record& record_;
};

enum class Outcome { finished, failed, absent };

/// Which run is asked for: axis → label, and the repetition from 1.
struct Asked {
  std::map<std::string, std::string> labels;
  int repetition;
};
using Fill = std::function<Outcome(const Asked&, Rows&)>;

class Bed {
 public:
  explicit Bed(int repetitions, int agents = 2)
      : agents_(agents),
        file_(testing::TempDir() + "hearsay-analysis-" + std::to_string(getpid()) + "-" +
              testing::UnitTest::GetInstance()->current_test_info()->name() + ".db") {
    remove_file();
    study.file = "made-up.study.toml";
    study.name = "made up";
    study.repetitions = repetitions;
  }
  ~Bed() { remove_file(); }
  Bed(const Bed&) = delete;
  Bed& operator=(const Bed&) = delete;

  Bed& axis(const std::string& name, const std::vector<Value>& labels) {
    Axis axis;
    axis.name = name;
    for (const Value& label : labels) axis.points.push_back({label, {}});
    study.axes.push_back(axis);
    return *this;
  }

  /// Adds all runs of the study. `state_dimension` is 2 in each, and the agents are called a0, a1,
  /// …
  void fill(const Fill& rows_of_run) {
    DatabaseWriter writer(file_);
    writer.add_study({study.name, study.file, "made up by a test"});
    std::int64_t id = 0;
    for (const Cell& cell : cells(study)) {
      for (int repetition = 1; repetition <= study.repetitions; ++repetition) {
        RunRow row;
        row.id = ++id;
        row.study = study.name;
        row.scenario = "made-up.toml";
        row.repetition = repetition;
        Asked asked{{}, repetition};
        for (const auto& [axis_name, label] : cell.labels) {
          asked.labels[axis_name] = label_text(label);
          row.axes.emplace_back(axis_name, hearsay::to_string(label));
        }
        Record record({});
        for (AgentId agent = 0; agent < agents_; ++agent) {
          record.agent(agent, "a" + std::to_string(agent), "estimator");
        }
        record.agent(central_agent, "central", "central");
        Rows rows(record);
        rows.scalar(central_agent, "state_dimension", 2.0);
        const Outcome outcome = rows_of_run(asked, rows);
        if (outcome == Outcome::absent) continue;
        row.ok = outcome == Outcome::finished;
        record.finish();
        writer.add(row, record);
      }
    }
    writer.commit();
    writer.close();
  }

  ClaimResult judge(const Expectation& expect) {
    study.claims = {{"a made-up claim", "a test", expect, 7}};
    return analysis::judge(file_, study).at(0);
  }
  Verdict verdict(const Expectation& expect) { return judge(expect).verdict; }

  const std::string& file() const { return file_; }
  Study study;

 private:
  void remove_file() const {
    for (const char* tail : {"", "-wal", "-shm"}) std::filesystem::remove(file_ + tail);
  }

  int agents_;
  std::string file_;
};

/// Expectations in one line.
inline Expectation expects(const std::string& metric, Expectation::Kind kind) {
  Expectation expect;
  expect.metric = metric;
  expect.kind = kind;
  return expect;
}
inline Expectation at_most(const std::string& metric, double high) {
  Expectation expect = expects(metric, Expectation::Kind::at_most);
  expect.high = high;
  return expect;
}
inline Expectation at_least(const std::string& metric, double low) {
  Expectation expect = expects(metric, Expectation::Kind::at_least);
  expect.low = low;
  return expect;
}
inline Expectation within(const std::string& metric, double low, double high,
                          Expectation::Kind kind = Expectation::Kind::within) {
  Expectation expect = expects(metric, kind);
  expect.low = low;
  expect.high = high;
  return expect;
}
inline Expectation banded(const std::string& metric, Expectation::Kind kind) {
  Expectation expect = expects(metric, kind);
  expect.chi2_band = true;
  return expect;
}

/// Draws of a run's own, the same under every label.
inline Stream draws(int repetition, AgentId agent) {
  return Stream(static_cast<std::uint64_t>(repetition), Purpose("made up"), Entity::agent(agent));
}

}  // namespace hearsay::analysis
