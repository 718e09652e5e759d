#include "tools/analysis/labels.hpp"

#include <fmt/format.h>

#include <charconv>
#include <type_traits>

namespace hearsay::analysis {

std::string label_text(const Value& value) {
  return std::visit(
      [](const auto& v) {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, std::string>) {
          return v;
        } else if constexpr (std::is_same_v<T, bool>) {
          return std::string(v ? "true" : "false");
        } else {
          return fmt::format("{}", static_cast<double>(v));
        }
      },
      value);
}

std::string stored_label_text(std::string_view stored) {
  if (stored.size() >= 2 && stored.front() == '"' && stored.back() == '"') {
    std::string text;
    for (std::size_t i = 1; i + 1 < stored.size(); ++i) {
      if (stored[i] == '\\' && i + 2 < stored.size()) ++i;
      text += stored[i];
    }
    return text;
  }
  double number = 0.0;
  const char* end = stored.data() + stored.size();
  const auto [stop, error] = std::from_chars(stored.data(), end, number);
  if (error == std::errc() && stop == end) return fmt::format("{}", number);
  return std::string(stored);
}

std::string to_string(const Labels& labels) {
  std::string text;
  for (const auto& [axis, label] : labels) {
    text += fmt::format("{}{}={}", text.empty() ? "" : " ", axis, label);
  }
  return text;
}

}  // namespace hearsay::analysis
