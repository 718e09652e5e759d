// Reads [[claims]] of a study.
#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/names.hpp"
#include "scenarios/study_parts.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using Kind = Expectation::Kind;

constexpr std::array<std::pair<const char*, Kind>, 8> kinds = {{
    {"at_most", Kind::at_most},
    {"at_least", Kind::at_least},
    {"within", Kind::within},
    {"less_than", Kind::less_than},
    {"greater_than", Kind::greater_than},
    {"grows", Kind::grows},
    {"falls_as", Kind::falls_as},
    {"agrees_with", Kind::agrees_with},
}};

std::string kind_names() {
  std::vector<std::string> names;
  for (const auto& [name, kind] : kinds) names.emplace_back(name);
  return join(names);
}

// Reads one claim's `expect`.
class ExpectationReader {
 public:
  ExpectationReader(const TomlNode& table, const KeyPath& path, const ClaimContext& context)
      : table_(table), path_(path), context_(context) {}

  Expectation read_all() {
    check_keys();
    const TomlNode& metric = required(table_, path_, "metric");
    e_.metric = read_metric(metric, path_["metric"]);
    if (const TomlNode* node = table_.find("where")) {
      e_.where = read_where(*node, path_["where"], context_.study);
      const bool any = std::any_of(context_.cells.begin(), context_.cells.end(),
                                   [&](const Cell& cell) { return matches(cell, e_.where); });
      if (!any) reject(*node, path_["where"], "all of these cells are skipped");
    }
    if (const TomlNode* node = table_.find("agents")) {
      e_.agents = read_agents(*node, path_["agents"], {"each", "mean", "central", "max"});
    }
    if (const TomlNode* node = table_.find("subjects")) {
      read(*node, path_["subjects"], anything(), e_.subjects);
      if (e_.subjects.empty()) reject(*node, path_["subjects"], "must have at least one name");
    }
    if (const TomlNode* node = table_.find("at")) e_.at = read_at(*node);
    if (const TomlNode* node = table_.find("over")) e_.over = read_metric(*node, path_["over"]);
    read_choice("statistic", {"auto", "mean", "rms", "median", "max", "min", "any"}, e_.statistic);
    read_choice("scale", {"linear", "log10"}, e_.scale);
    read_kind();
    return std::move(e_);
  }

 private:
  void check_keys() const {
    std::vector<std::string> known = {"metric", "where", "agents",    "subjects",
                                      "at",     "over",  "statistic", "scale"};
    for (const auto& [name, kind] : kinds) known.emplace_back(name);
    expect_table(table_, path_);
    expect_known_keys(table_, path_, known);
  }

  std::string read_metric(const TomlNode& node, const KeyPath& path) const {
    std::string metric;
    read(node, path, anything(), metric);
    const auto& known = context_.names.metrics;
    if (!known.empty() && std::find(known.begin(), known.end(), metric) == known.end()) {
      reject(node, path, "unknown metric" + allowed_names(metric, known));
    }
    return metric;
  }

  // A word of `words`, or an agent by name or number.
  std::string read_agents(const TomlNode& node, const KeyPath& path,
                          std::vector<std::string> words) const {
    const auto& agents = context_.agent_names;
    if (node.type == TomlNode::Type::integer) {
      const bool known = node.integer >= 0 && std::cmp_less(node.integer, agents.size());
      if (!known) reject(node, path, "there is no such agent");
      return agents[static_cast<std::size_t>(node.integer)];
    }
    std::string name;
    read(node, path, anything(), name);
    words.insert(words.end(), agents.begin(), agents.end());
    if (std::find(words.begin(), words.end(), name) == words.end()) {
      reject(node, path, "unknown" + allowed_names(name, words));
    }
    return name;
  }

  std::string read_at(const TomlNode& node) const {
    const KeyPath path = path_["at"];
    if (node.type == TomlNode::Type::string) {
      std::string word;
      read(node, path, one_of({"end", "all"}), word);
      return word;
    }
    if (node.type != TomlNode::Type::number && node.type != TomlNode::Type::integer) {
      reject_type(node, path, "\"end\", \"all\" or seconds");
    }
    double seconds = 0.0;
    read(node, path, time_span(true), seconds);
    return to_toml(seconds);
  }

  void read_choice(const char* key, std::vector<std::string> choices, std::string& member) const {
    const TomlNode* node = table_.find(key);
    if (node) read(*node, path_[key], one_of(std::move(choices)), member);
  }

  void read_kind() {
    const TomlNode* found = nullptr;
    for (const auto& [name, kind] : kinds) {
      const TomlNode* node = table_.find(name);
      if (!node) continue;
      if (found) {
        reject_key(node->origin, path_.text(),
                   "has both " + found->key + " and " + name + "; a claim expects one thing");
      }
      found = node;
      e_.kind = kind;
    }
    if (!found) {
      reject_key(table_.origin, path_.text(), "expects nothing; give one of " + kind_names());
    }
    read_bound(*found, path_[found->key]);
  }

  void read_bound(const TomlNode& node, const KeyPath& path) {
    switch (e_.kind) {
      case Kind::at_most:
        if (!read_band(node, path, "a number or \"chi2-band\"")) {
          read(node, path, anything(), e_.high);
        }
        return;
      case Kind::at_least:
        if (!read_band(node, path, "a number or \"chi2-band\"")) {
          read(node, path, anything(), e_.low);
        }
        return;
      case Kind::within:
        if (!read_band(node, path, "[low, high] or \"chi2-band\"")) read_range(node, path);
        return;
      case Kind::falls_as:
        read_range(node, path);
        return;
      case Kind::less_than:
      case Kind::greater_than:
        read_than(node, path);
        return;
      case Kind::grows:
        if (node.type != TomlNode::Type::boolean || !node.boolean) {
          reject(node, path, "must be true");
        }
        return;
      case Kind::agrees_with:
        e_.than_metric = read_metric(node, path);
        return;
    }
  }

  bool read_band(const TomlNode& node, const KeyPath& path, const char* expected) {
    if (node.type != TomlNode::Type::string) return false;
    if (node.text != "chi2-band") reject(node, path, std::string("expected ") + expected);
    e_.chi2_band = true;
    return true;
  }

  void read_range(const TomlNode& node, const KeyPath& path) {
    expect_array(node, path, "[low, high]");
    if (node.children.size() != 2) reject(node, path, "must be [low, high]");
    read(node.children[0], path[0], anything(), e_.low);
    read(node.children[1], path[1], anything(), e_.high);
    if (e_.low > e_.high) reject(node, path, "low must not be above high");
  }

  void read_than(const TomlNode& node, const KeyPath& path) {
    if (node.type != TomlNode::Type::table) {
      reject_type(node, path, "a table that names the other cell, agent or metric");
    }
    for (const TomlNode& entry : node.children) {
      const KeyPath entry_path = path[entry.key];
      if (entry.key == "agent") {
        e_.than_agent = read_agents(entry, entry_path, {"central"});
      } else if (entry.key == "metric") {
        e_.than_metric = read_metric(entry, entry_path);
      } else {
        auto labels = read_labels(entry, entry_path, context_.study);
        if (labels.size() != 1) reject(entry, entry_path, "must be one value");
        e_.than[entry.key] = std::move(labels);
      }
    }
    if (node.children.empty()) {
      reject(node, path, "names nothing; give axis = value, agent or metric");
    }
  }

  const TomlNode& table_;
  const KeyPath& path_;
  const ClaimContext& context_;
  Expectation e_;
};

}  // namespace

std::vector<Claim> read_claims(const TomlNode& node, const KeyPath& path,
                               const ClaimContext& context) {
  static const std::vector<std::string> known = {"text", "source", "expect"};
  expect_array(node, path, "an array of tables");
  std::vector<Claim> claims;
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    const TomlNode& table = node.children[i];
    const KeyPath here = path[i];
    expect_table(table, here);
    expect_known_keys(table, here, known);
    Claim claim;
    claim.line = table.origin.line;
    read(required(table, here, "text"), here["text"], anything(), claim.text);
    if (const TomlNode* source = table.find("source")) {
      read(*source, here["source"], anything(), claim.source);
    }
    const TomlNode& expect = required(table, here, "expect");
    claim.expect = ExpectationReader(expect, here["expect"], context).read_all();
    claims.push_back(std::move(claim));
  }
  return claims;
}

}  // namespace hearsay
