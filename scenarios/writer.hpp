// Members of a scenario as TOML text.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/channel_spec.hpp"
#include "scenarios/document.hpp"
#include "scenarios/explorer_spec.hpp"

namespace hearsay {

inline std::string toml_text(double value) { return to_toml(value); }
inline std::string toml_text(int value) { return std::to_string(value); }
inline std::string toml_text(bool value) { return value ? "true" : "false"; }
inline std::string toml_text(const AgentRef& value) { return std::to_string(value.number); }
inline std::string toml_text(std::uint64_t value) { return std::to_string(value); }
inline std::string toml_text(const std::string& value) { return to_toml(std::string_view(value)); }

template <class T>
std::string toml_text(const std::vector<T>& values);
template <class T, std::size_t n>
std::string toml_text(const std::array<T, n>& values) {
  return toml_text(std::vector<T>(values.begin(), values.end()));
}
template <class T>
std::string toml_text(const std::vector<T>& values) {
  std::string text;
  for (const T& value : values) {
    if (!text.empty()) text += ", ";
    text += toml_text(value);
  }
  return "[" + text + "]";
}
inline std::string toml_text(const NumberList& list) { return toml_text(list.values); }
inline std::string toml_text(const std::map<std::string, double>& values) {
  std::string text;
  for (const auto& [key, value] : values) {
    if (!text.empty()) text += ", ";
    text += toml_text(key) + " = " + toml_text(value);
  }
  return text.empty() ? "{}" : "{ " + text + " }";
}
/// Empty if there is none.
template <class T>
std::string toml_text(const std::optional<T>& value) {
  return value ? toml_text(*value) : std::string();
}

}  // namespace hearsay
