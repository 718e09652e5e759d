#include "scenarios/names.hpp"

#include <algorithm>

namespace hearsay {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t differs = a[i - 1] == b[j - 1] ? 0 : 1;
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + differs});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    before.swap(above);
    above.swap(row);
  }
  return above[b.size()];
}

std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> known) {
  // A word of hundreds of letters is no slip of the pen; it would only cost time.
  if (name.size() > 200) return std::nullopt;
  const std::string* best = nullptr;
  std::size_t best_distance = std::max<std::size_t>(1, name.size() / 3) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = &candidate;
    }
  }
  return best ? std::optional(*best) : std::nullopt;
}

std::string join(std::span<const std::string> names) {
  std::string text;
  for (const std::string& name : names) {
    if (!text.empty()) text += ", ";
    text += name;
  }
  return text;
}

std::string allowed_names(std::string_view name, std::span<const std::string> known) {
  const auto near = nearest_name(name, known);
  std::string text;
  if (!near || known.size() <= 16) text += "; allowed: " + join(known);
  if (near) text += "; did you mean '" + *near + "'?";
  return text;
}

std::string near_or_allowed(std::string_view name, std::span<const std::string> known) {
  const auto near = nearest_name(name, known);
  return near ? "; did you mean '" + *near + "'?" : "; allowed: " + join(known);
}

}  // namespace hearsay
