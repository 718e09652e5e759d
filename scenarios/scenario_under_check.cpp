#include "scenarios/scenario_under_check.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>

#include "scenarios/names.hpp"

namespace hearsay {
namespace {

const TomlNode& located(const TomlNode& root, const KeyPath& path) {
  if (!path.parent) return root;
  const TomlNode& around = located(root, *path.parent);
  if (path.key.empty()) {
    const bool inside = path.index < around.children.size();
    return inside ? around.children[path.index] : around;
  }
  const TomlNode* entry = around.find(path.key);
  return entry ? *entry : around;
}

std::vector<std::size_t> sorted_by_name(const std::vector<std::string>& names) {
  std::vector<std::size_t> order(names.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const int compared = names[a].compare(names[b]);
    return compared != 0 ? compared < 0 : a < b;
  });
  return order;
}

}  // namespace

const TomlNode& ScenarioUnderCheck::locate(const KeyPath& path) const {
  return located(root_, path);
}

void ScenarioUnderCheck::name_agents() {
  names_ = agent_names(scenario);
  by_name_ = sorted_by_name(names_);
}

std::optional<std::size_t> ScenarioUnderCheck::agent_called(const std::string& name) const {
  const auto at = std::lower_bound(
      by_name_.begin(), by_name_.end(), name,
      [&](std::size_t agent, const std::string& wanted) { return names_[agent] < wanted; });
  if (at == by_name_.end() || names_[*at] != name) return std::nullopt;
  return *at;
}

std::string ScenarioUnderCheck::no_agent_called(std::string_view name) const {
  const auto near = nearest_name(name, names_);
  return "there is no such agent" + (near ? "; did you mean '" + *near + "'?" : "");
}

std::string ScenarioUnderCheck::no_agent_with(const std::string& number) const {
  const auto last = names_.size() - 1;
  const std::string known =
      last == 0 ? "0 is the only one" : "they are 0 … " + std::to_string(last);
  return "there is no agent " + number + "; " + known;
}

int ScenarioUnderCheck::resolve_agent(const TomlNode& end, const KeyPath& path, int given) const {
  if (end.type == TomlNode::Type::string) {
    if (const auto agent = agent_called(end.text)) return static_cast<int>(*agent);
    reject(end, path, no_agent_called(end.text));
  }
  if (given >= 0 && static_cast<std::size_t>(given) < names_.size()) return given;
  reject(locate(path), path, no_agent_with(std::to_string(given)));
}

int ScenarioUnderCheck::resolve_agent(const CsvFile& csv, std::size_t row,
                                      std::size_t column) const {
  const std::string text(csv.text(row, column));
  if (const auto agent = agent_called(text)) return static_cast<int>(*agent);
  const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
  if (!digits) csv.reject(row, column, no_agent_called(text));
  std::size_t number = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  if (parsed.ec == std::errc() && number < names_.size()) return static_cast<int>(number);
  csv.reject(row, column, no_agent_with(shortened(text)));
}

std::optional<std::size_t> first_duplicate(const std::vector<std::string>& names) {
  const std::vector<std::size_t> order = sorted_by_name(names);
  std::optional<std::size_t> first;
  for (std::size_t i = 1; i < order.size(); ++i) {
    const bool same = names[order[i - 1]] == names[order[i]];
    if (same && (!first || order[i] < *first)) first = order[i];
  }
  return first;
}

}  // namespace hearsay
