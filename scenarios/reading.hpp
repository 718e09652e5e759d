// Typed reading of TOML nodes, with the messages that go with it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/channel_spec.hpp"
#include "scenarios/document.hpp"
#include "scenarios/explorer_spec.hpp"

namespace hearsay {

/// The place of a value in the tree, for messages: agents[0].talk.period_s. Lives on the stack.
struct KeyPath {
  const KeyPath* parent = nullptr;
  std::string_view key;  ///< of an entry; empty for an element
  std::size_t index = 0;
  std::string text() const;

  KeyPath operator[](std::string_view name) const { return {this, name, 0}; }
  KeyPath operator[](std::size_t element) const { return {this, {}, element}; }
};

/// @throws InputError "ring.toml:12: radio.rate_bps = -1: must be …".
[[noreturn]] void reject(const TomlNode& node, const KeyPath& path, const std::string& why);
/// @throws InputError "ring.toml:12: radio.edges: …", without the value.
[[noreturn]] void reject_key(const TextOrigin& origin, const std::string& path,
                             const std::string& why);
/// @throws InputError "…: expected a number, found a string".
[[noreturn]] void reject_type(const TomlNode& node, const KeyPath& path, const char* expected);

/// Which values a key takes. Numbers: a range. Strings: choices, none if any will do.
struct Allowed {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above_low = false;  ///< low itself is not allowed
  double finest = 0.0;     ///< a value other than 0 is at least this
  bool any_string = true;
  std::vector<std::string> choices;
  const char* note = "";  ///< why, appended to a message about the range

  /// "> 0", "≥ 0", "0 … 1", "> 0 … 1", "a | b"; empty if anything is allowed.
  std::string text() const;
};
Allowed anything();
Allowed greater_than_zero();
Allowed above_zero_to(double high);
Allowed at_least(double low);
Allowed between(double low, double high);
/// A span of time in seconds: at most 1e9 s, and at least a nanosecond if not zero.
Allowed time_span(bool zero_allowed);
Allowed one_of(std::vector<std::string> choices);
/// One of `known`, or anything if nothing is known.
Allowed one_of_if_known(const std::vector<std::string>& known);

void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed, double& value);
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed, int& value);
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed, std::uint64_t& value);
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed, bool& value);
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed, std::string& value);
/// A number or a name; a name becomes −1, to be found later.
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed, AgentRef& value);
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::vector<AgentRef>& value);
/// Two coordinates.
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::vector<double>& value);
/// Numbers, at least one.
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed, NumberList& value);
/// Names, none twice.
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::vector<std::string>& value);
/// Pairs of agents, each a number or a name; a name becomes −1, to be found later.
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::vector<std::array<int, 2>>& value);
/// Points, each two coordinates.
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::vector<std::array<double, 2>>& value);
/// Groups of agents, each a number or a name; a name becomes −1, to be found later.
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::vector<std::vector<int>>& value);
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::map<std::string, double>& value);
template <class T>
void read(const TomlNode& node, const KeyPath& path, const Allowed& allowed,
          std::optional<T>& value) {
  read(node, path, allowed, value.emplace());
}

/// @throws InputError unless `node` is a table.
void expect_table(const TomlNode& node, const KeyPath& path);
void expect_array(const TomlNode& node, const KeyPath& path, const char* expected);
/// @throws InputError for an entry that is not among `known`, with the nearest known one.
void expect_known_keys(const TomlNode& table, const KeyPath& path,
                       std::span<const std::string> known);
/// The entry `key`. @throws InputError if it is not there: "…: radio.rate_bps: missing".
const TomlNode& required(const TomlNode& table, const KeyPath& path, std::string_view key,
                         const char* why = "");

}  // namespace hearsay
