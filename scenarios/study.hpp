// A study as typed data: a scenario, axes, repetitions, constraints, claims, figures.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "scenarios/scenario.hpp"

namespace hearsay {

/// A value as TOML has it.
using Value = std::variant<bool, std::int64_t, double, std::string>;
/// As TOML would write it: 0.1, "ring", true.
std::string to_string(const Value& value);
/// Equal, or numbers of equal value (1 and 1.0).
bool same_value(const Value& a, const Value& b);

/// key = value, to be laid over a scenario file. The value is TOML text ("0.1", "\"ring\"", "[1,
/// 2]").
struct Override {
  std::string key;
  std::string toml;
  std::string origin;  ///< what a message begins with: "--set a=1", "study.toml:12"
};

/// One place on an axis: what it is called in the database and what it sets.
struct AxisPoint {
  Value label;
  std::vector<Override> set;
};
/// In the file either  rule = { key = "agents.estimator.fusion", values = ["naive", …] }
/// or, to set several keys at once,
///   sensors = { points = [{ label = "equal", set = { "agents.sensor.sigma_along_m" = 5.0, … } },
///   …] }
struct Axis {
  std::string name;
  std::vector<AxisPoint> points;
  int line = 0;
};

/// Cells that match all of `when` are left out:  [[skip]] when = { rule = "none", loss = [0.1, 0.3]
/// } Values are labels of the axis, of the same type.
using Where = std::map<std::string, std::vector<Value>>;
struct Skip {
  Where when;
  int line = 0;
};

/// How repetitions of one metric are to come out. See docs in tools/analysis/claims.hpp.
struct Expectation {
  std::string metric;
  Where where;  ///< cells spoken of; an axis not named: all of it
  std::string agents =
      "each";  ///< "each" | "mean" (over agents, a run) | "central" | "max" | a name
  /// Of a series: these alone, each for itself, such as thresholds of alarms; empty: all
  std::vector<std::string> subjects;
  std::string at = "end";           ///< "end" | "all" (every instant) | seconds as text
  std::optional<std::string> over;  ///< divide by this metric (ratio of aggregates)
  std::string statistic =
      "auto";  ///< over repetitions: "auto" | "mean" | "rms" | "median" | "max" | "min" | "any"
  std::string scale = "linear";  ///< "linear" | "log10" (of each repetition's value)

  enum class Kind {
    at_most,
    at_least,
    within,
    less_than,
    greater_than,
    grows,
    falls_as,
    agrees_with
  };
  Kind kind = Kind::at_most;
  bool chi2_band = false;        ///< the bound is the χ² band (at_most: its upper end …)
  double low = 0.0, high = 0.0;  ///< within; at_most uses high, at_least low, falls_as both
  Where than;                    ///< less_than, greater_than: the other cell's axis values
  std::optional<std::string> than_agent;   ///< … or the other agent ("central")
  std::optional<std::string> than_metric;  ///< … or the other metric; agrees_with: the metric
};

struct Claim {
  std::string text;
  std::string source;
  Expectation expect;
  int line = 0;
};

/// A script of tools/figures and the file it writes (into the results directory).
struct Figure {
  std::string script;  ///< "rumour.py"
  std::string output;  ///< "rumour-line.png"
  std::vector<std::string> arguments;
};

struct Study {
  std::string file;
  std::string name;  ///< default: the file's name without .study.toml / .toml
  std::string title;
  std::string scenario_file;  ///< resolved path
  int repetitions = 1;        ///< 1 … 1e6; repetition r = 1 … R has seed + r − 1
  std::uint64_t seed = 1;     ///< default: the scenario's
  /// Laid over the scenario in every cell: [set], then what load_study() was given.
  std::vector<Override> set;
  std::vector<Axis> axes;  ///< in file order
  std::vector<Skip> skips;
  std::vector<Claim> claims;
  std::vector<Figure> figures;
};

/// One cell: a point on every axis.
struct Cell {
  std::vector<std::pair<std::string, Value>> labels;  ///< axis name → label, in axis order
  std::vector<Override> set;  ///< all that is laid over the scenario: the study's, then each axis's
};
/// True if the cell has one of the values on each axis named in `where`.
bool matches(const Cell& cell, const Where& where);
/// All cells in axis order (the last axis turns fastest), without the skipped ones.
std::vector<Cell> cells(const Study& study);

}  // namespace hearsay
