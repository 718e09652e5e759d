#include "scenarios/reading.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scenarios/names.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

// A limit in a message: 1000000 rather than 1e+06 or 1000000.0.
std::string limit_text(double limit) {
  if (std::fabs(limit) < 1e15 && limit == std::floor(limit)) {
    return std::to_string(static_cast<std::int64_t>(limit));
  }
  return to_toml(limit);
}

const char* type_name(TomlNode::Type type) {
  switch (type) {
    case TomlNode::Type::boolean:
      return "a boolean";
    case TomlNode::Type::integer:
      return "an integer";
    case TomlNode::Type::number:
      return "a number";
    case TomlNode::Type::string:
      return "a string";
    case TomlNode::Type::date:
      return "a date or time";
    case TomlNode::Type::array:
      return "an array";
    case TomlNode::Type::table:
      return "a table";
  }
  return "?";
}

// Why `value` is out of range; empty if it is not.
std::string range_error(double value, const Allowed& allowed) {
  std::string error;
  if (value < allowed.low || (allowed.above_low && value == allowed.low)) {
    if (allowed.above_low) {
      error = "must be greater than " + limit_text(allowed.low);
    } else if (std::isfinite(allowed.high) && allowed.finest == 0.0) {
      error = "must be between " + limit_text(allowed.low) + " and " + limit_text(allowed.high);
    } else {
      error = "must be at least " + limit_text(allowed.low);
    }
  } else if (value > allowed.high) {
    const bool closed = std::isfinite(allowed.low) && !allowed.above_low && allowed.finest == 0.0;
    error = closed ? "must be between " + limit_text(allowed.low) + " and " : "must be at most ";
    error += limit_text(allowed.high);
  } else if (value != 0.0 && std::fabs(value) < allowed.finest) {
    error = (allowed.above_low ? "must be at least " : "must be 0 or at least ") +
            limit_text(allowed.finest);
  }
  if (!error.empty() && *allowed.note != '\0') error += std::string("; ") + allowed.note;
  return error;
}

std::int64_t read_integer(const TomlNode& node, const KeyPath& path, const Allowed& allowed) {
  if (node.type != TomlNode::Type::integer) reject_type(node, path, "an integer");
  const auto error = range_error(static_cast<double>(node.integer), allowed);
  if (!error.empty()) reject(node, path, error);
  return node.integer;
}

}  // namespace

std::string KeyPath::text() const {
  std::string before = parent ? parent->text() : "";
  if (!parent) return before;
  if (key.empty()) return before + "[" + std::to_string(index) + "]";
  if (!before.empty()) before += '.';
  return before + std::string(key);
}

void reject(const TomlNode& node, const KeyPath& path, const std::string& why) {
  throw InputError(node.origin.text() + ": " + path.text() + " = " + shortened(to_toml(node)) +
                   ": " + why);
}

void reject_key(const TextOrigin& origin, const std::string& path, const std::string& why) {
  throw InputError(origin.text() + ": " + path + ": " + why);
}

void reject_type(const TomlNode& node, const KeyPath& path, const char* expected) {
  reject(node, path, std::string("expected ") + expected + ", found " + type_name(node.type));
}

std::string Allowed::text() const {
  if (!choices.empty()) {
    std::string text;
    for (const std::string& choice : choices) text += (text.empty() ? "" : " | ") + choice;
    return text;
  }
  if (!std::isfinite(low)) return "";
  const bool closed = std::isfinite(high) && finest == 0.0;
  if (above_low) return "> " + limit_text(low) + (closed ? " … " + limit_text(high) : "");
  if (!std::isfinite(high) || finest > 0.0) return "≥ " + limit_text(low);
  return limit_text(low) + " … " + limit_text(high);
}

Allowed anything() { return {}; }

Allowed greater_than_zero() {
  Allowed allowed = at_least(0.0);
  allowed.above_low = true;
  return allowed;
}

Allowed above_zero_to(double high) {
  Allowed allowed = between(0.0, high);
  allowed.above_low = true;
  return allowed;
}

Allowed at_least(double low) {
  Allowed allowed;
  allowed.low = low;
  return allowed;
}

Allowed between(double low, double high) {
  Allowed allowed = at_least(low);
  allowed.high = high;
  return allowed;
}

Allowed time_span(bool zero_allowed) {
  Allowed allowed = between(0.0, 1e9);
  allowed.above_low = !zero_allowed;
  allowed.finest = 1e-9;
  return allowed;
}

Allowed one_of(std::vector<std::string> choices) {
  Allowed allowed;
  allowed.any_string = false;
  allowed.choices = std::move(choices);
  return allowed;
}

Allowed one_of_if_known(const std::vector<std::string>& known) {
  return known.empty() ? anything() : one_of(known);
}

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed, double& value) {
  if (node.type == TomlNode::Type::integer) {
    value = static_cast<double>(node.integer);
  } else if (node.type == TomlNode::Type::number) {
    value = node.number;
  } else {
    reject_type(node, path, "a number");
  }
  if (!std::isfinite(value)) reject(node, path, "must be a finite number");
  const auto error = range_error(value, allowed);
  if (!error.empty()) reject(node, path, error);
}

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed, int& value) {
  const std::int64_t wide = read_integer(node, path, allowed);
  if (!std::in_range<int>(wide)) {
    const bool below = wide < 0;
    reject(node, path,
           below ? "must be at least " + std::to_string(std::numeric_limits<int>::min())
                 : "must be at most " + std::to_string(std::numeric_limits<int>::max()));
  }
  value = static_cast<int>(wide);
}

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed, std::uint64_t& value) {
  const std::int64_t wide = read_integer(node, path, allowed);
  if (wide < 0) reject(node, path, "must be at least 0");
  value = static_cast<std::uint64_t>(wide);
}

void read(const TomlNode& node, const KeyPath& path, const Allowed&, bool& value) {
  if (node.type != TomlNode::Type::boolean) reject_type(node, path, "true or false");
  value = node.boolean;
}

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed, AgentRef& value) {
  value = {};
  if (node.type == TomlNode::Type::string) return;
  if (node.type != TomlNode::Type::integer) {
    reject_type(node, path, "the number or name of an agent");
  }
  read(node, path, allowed, value.number);
}

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::vector<AgentRef>& value) {
  expect_array(node, path, "an array of agents");
  value.assign(node.children.size(), {});
  for (std::size_t i = 0; i < value.size(); ++i) {
    read(node.children[i], path[i], allowed, value[i]);
  }
}

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed, std::string& value) {
  if (node.type != TomlNode::Type::string) reject_type(node, path, "a string");
  const auto& choices = allowed.choices;
  if (!allowed.any_string &&
      std::find(choices.begin(), choices.end(), node.text) == choices.end()) {
    reject(node, path, "unknown" + allowed_names(node.text, choices));
  }
  // Names go into databases and messages as they are.
  const bool control = std::any_of(node.text.begin(), node.text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
  });
  if (control) reject(node, path, "must not contain control characters");
  value = node.text;
}

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::vector<double>& value) {
  expect_array(node, path, "an array of numbers");
  value.assign(node.children.size(), 0.0);
  for (std::size_t i = 0; i < value.size(); ++i) {
    read(node.children[i], path[i], allowed, value[i]);
  }
  if (value.size() != 2) reject(node, path, "must have 2 coordinates");
}

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed, NumberList& value) {
  expect_array(node, path, "an array of numbers");
  value.values.assign(node.children.size(), 0.0);
  for (std::size_t i = 0; i < value.values.size(); ++i) {
    read(node.children[i], path[i], allowed, value.values[i]);
  }
  if (value.values.empty()) reject(node, path, "must have at least one number");
}

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::vector<std::string>& value) {
  expect_array(node, path, "an array of strings");
  value.assign(node.children.size(), "");
  for (std::size_t i = 0; i < value.size(); ++i) {
    read(node.children[i], path[i], allowed, value[i]);
    const auto here = value.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find(value.begin(), here, value[i]) != here) {
      reject(node.children[i], path[i], "stands there twice");
    }
  }
}

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::vector<std::array<int, 2>>& value) {
  expect_array(node, path, "an array of pairs of agents");
  value.assign(node.children.size(), {-1, -1});
  for (std::size_t i = 0; i < value.size(); ++i) {
    const TomlNode& pair = node.children[i];
    const KeyPath pair_path = path[i];
    expect_array(pair, pair_path, "a pair of agents, as [0, 1]");
    if (pair.children.size() != 2) reject(pair, pair_path, "must name two agents");
    for (std::size_t k = 0; k < 2; ++k) {
      const TomlNode& end = pair.children[k];
      if (end.type == TomlNode::Type::string) continue;
      read(end, pair_path[k], allowed, value[i][k]);
    }
  }
}

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::vector<std::array<double, 2>>& value) {
  expect_array(node, path, "an array of points, as [[0, 0], [100, 50]]");
  value.assign(node.children.size(), {});
  for (std::size_t i = 0; i < value.size(); ++i) {
    const TomlNode& point = node.children[i];
    const KeyPath point_path = path[i];
    expect_array(point, point_path, "a point, as [100, 50]");
    if (point.children.size() != 2) reject(point, point_path, "must have 2 coordinates");
    for (std::size_t k = 0; k < 2; ++k) {
      read(point.children[k], point_path[k], allowed, value[i][k]);
    }
  }
}

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::vector<std::vector<int>>& value) {
  expect_array(node, path, "an array of groups of agents");
  value.clear();
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    const TomlNode& group = node.children[i];
    const KeyPath group_path = path[i];
    expect_array(group, group_path, "a group of agents, as [0, 1]");
    value.emplace_back(group.children.size(), -1);
    for (std::size_t k = 0; k < group.children.size(); ++k) {
      const TomlNode& member = group.children[k];
      if (member.type == TomlNode::Type::string) continue;
      read(member, group_path[k], allowed, value[i][k]);
    }
  }
}

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::map<std::string, double>& value) {
  expect_table(node, path);
  value.clear();
  for (const TomlNode& child : node.children) {
    read(child, path[child.key], allowed, value[child.key]);
  }
}

void expect_table(const TomlNode& node, const KeyPath& path) {
  if (node.type != TomlNode::Type::table) reject_type(node, path, "a table");
}

void expect_array(const TomlNode& node, const KeyPath& path, const char* expected) {
  if (node.type != TomlNode::Type::array) reject_type(node, path, expected);
}

void expect_known_keys(const TomlNode& table, const KeyPath& path,
                       std::span<const std::string> known) {
  for (const TomlNode& child : table.children) {
    if (std::find(known.begin(), known.end(), child.key) != known.end()) continue;
    const std::string place = path.text();
    throw InputError(child.origin.text() + ": unknown key '" + child.key + "' " +
                     (place.empty() ? "at the top level" : "in [" + place + "]") +
                     near_or_allowed(child.key, known));
  }
}

const TomlNode& required(const TomlNode& table, const KeyPath& path, std::string_view key,
                         const char* why) {
  const TomlNode* node = table.find(key);
  if (node) return *node;
  const std::string reason = std::string("missing") + (*why ? "; " : "") + why;
  reject_key(table.origin, path[key].text(), reason);
}

}  // namespace hearsay
