#include "scenarios/study.hpp"

#include <algorithm>
#include <cstddef>

#include "scenarios/document.hpp"
#include "scenarios/writer.hpp"

namespace hearsay {
namespace {

struct ToToml {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const { return to_toml(value); }
  std::string operator()(const std::string& value) const {
    return to_toml(std::string_view(value));
  }
};

// The place of `value` among numbers; nothing if it is not one.
std::optional<double> number_of(const Value& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
  if (const auto* number = std::get_if<double>(&value)) return *number;
  return std::nullopt;
}

const Value* label_on(const Cell& cell, const std::string& axis) {
  for (const auto& [name, label] : cell.labels) {
    if (name == axis) return &label;
  }
  return nullptr;
}

}  // namespace

std::string to_string(const Value& value) { return std::visit(ToToml(), value); }

bool same_value(const Value& a, const Value& b) {
  if (a.index() == b.index()) return a == b;
  const auto x = number_of(a);
  const auto y = number_of(b);
  return x && y && *x == *y;
}

bool matches(const Cell& cell, const Where& where) {
  return std::all_of(where.begin(), where.end(), [&](const auto& entry) {
    const Value* label = label_on(cell, entry.first);
    const auto& wanted = entry.second;
    return label && std::any_of(wanted.begin(), wanted.end(),
                                [&](const Value& value) { return same_value(*label, value); });
  });
}

std::vector<Cell> cells(const Study& study) {
  std::vector<Cell> result;
  std::vector<std::size_t> at(study.axes.size(), 0);
  const bool empty = std::any_of(study.axes.begin(), study.axes.end(),
                                 [](const Axis& axis) { return axis.points.empty(); });
  for (bool more = !empty; more;) {
    Cell cell{{}, study.set};
    for (std::size_t i = 0; i < at.size(); ++i) {
      const AxisPoint& point = study.axes[i].points[at[i]];
      cell.labels.emplace_back(study.axes[i].name, point.label);
      cell.set.insert(cell.set.end(), point.set.begin(), point.set.end());
    }
    const bool skipped = std::any_of(study.skips.begin(), study.skips.end(),
                                     [&](const Skip& skip) { return matches(cell, skip.when); });
    if (!skipped) result.push_back(std::move(cell));
    // The last axis turns fastest, as on an odometer.
    more = false;
    for (std::size_t i = at.size(); i-- > 0;) {
      if (++at[i] < study.axes[i].points.size()) {
        more = true;
        break;
      }
      at[i] = 0;
    }
  }
  return result;
}

}  // namespace hearsay
