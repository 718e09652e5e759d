// hearsay list: what there is to choose from.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>

#include "agents/estimators/gaussian.hpp"
#include "agents/estimators/shared_trajectories.hpp"
#include "agents/metrics.hpp"
#include "filters/gaussian/fusion.hpp"
#include "filters/grid/fusion.hpp"
#include "scenarios/describe_localizer.hpp"
#include "scenarios/describe_tracker.hpp"
#include "scenarios/radio_models.hpp"
#include "scenarios/schema.hpp"
#include "tools/hearsay/share.hpp"
#include "tools/hearsay/verbs.hpp"

namespace hearsay::program {
namespace {

using Json = nlohmann::ordered_json;

const char* text_of(gaussian::Sends sends) {
  using gaussian::Sends;
  switch (sends) {
    case Sends::nothing:
      return "nothing";
    case Sends::belief:
      return "its whole belief, one broadcast";
    case Sends::local_update:
      return "what it measured since it last sent, one broadcast";
    case Sends::belief_less_heard:
      return "to each neighbour its belief less what that one said last";
    case Sends::belief_and_fresh:
      return "its whole belief and how much of it was measured since it last sent, one broadcast";
    case Sends::belief_and_degree:
      return "its whole belief and how many neighbours it has, one broadcast";
    case Sends::hybrid:
      return "its whole belief, what it measured since it last sent, and how many neighbours it "
             "has, one broadcast";
  }
  return "";
}

/// The kinds of estimator and agent that can fuse by a rule.
std::string goes_with(const gaussian::RuleInfo& rule) {
  const auto among = [&](const auto& names) {
    return std::find(names.begin(), names.end(), rule.name) != names.end();
  };
  std::string text = "static-gaussian";
  if (rule.memory != gaussian::Memory::held &&
      message_form(rule.rule, Content::belief) == gaussian::MessageForm::plain) {
    text += ", moving-gaussian";
  }
  const auto of_trajectories = trajectory_rules();
  if (std::find(of_trajectories.begin(), of_trajectories.end(), rule.rule) !=
      of_trajectories.end()) {
    text += ", trajectory-gaussian";
  }
  if (among(tracker_fusion_names())) text += ", tracker";
  if (among(localizer_fusion_names())) text += ", localizer";
  return text;
}

const char* text_of(grid::Sends sends) {
  using grid::Sends;
  switch (sends) {
    case Sends::nothing:
      return "nothing";
    case Sends::evidence:
      return "its evidence of all cells, of those that changed, or in runs; one broadcast";
    case Sends::evidence_less_heard:
      return "to each neighbour its evidence less what that one said last";
  }
  return "";
}

Json rule_of_grids(const grid::RuleInfo& rule) {
  const char* const beliefs = !rule.beta       ? "bernoulli"
                              : rule.bernoulli ? "bernoulli, beta"
                                               : "beta";
  return {{"name", rule.name},
          {"goes with", std::string("explorer: ") + beliefs},
          {"sends", text_of(rule.sends)},
          {"assumes", rule.assumes},
          {"conservative", rule.conservative},
          {"ledger", rule.ledger},
          {"cost", rule.cost},
          {"source", rule.source}};
}

Json rules() {
  Json out = Json::array();
  for (const gaussian::RuleInfo& rule : gaussian::rules()) {
    out.push_back({{"name", rule.name},
                   {"goes with", goes_with(rule)},
                   {"sends", text_of(rule.sends)},
                   {"assumes", rule.assumes},
                   {"conservative", rule.conservative},
                   {"ledger", rule.ledger},
                   {"cost", rule.cost},
                   {"source", rule.source}});
  }
  for (const grid::RuleInfo& rule : grid::rules()) out.push_back(rule_of_grids(rule));
  return out;
}

Json metrics_list(const Catalog& catalog) {
  constexpr std::array tables = {"series", "scalar", "derived"};
  constexpr std::array aggregates = {"mean", "rms", "median"};
  Json out = Json::array();
  for (const MetricInfo& metric : metrics()) {
    out.push_back({{"name", metric.name},
                   {"table", tables[static_cast<std::size_t>(metric.table)]},
                   {"over repetitions", aggregates[static_cast<std::size_t>(metric.aggregate)]},
                   {"meaning", metric.meaning}});
  }
  for (const Catalog::OwnMetric& metric : catalog.metrics()) {
    out.push_back({{"name", metric.name}, {"table", "series"}, {"meaning", metric.meaning}});
  }
  return out;
}

Json agents(const Catalog& catalog) {
  Json out = Json::array();
  out.push_back(
      {{"name", "estimator"},
       {"meaning", "looks, updates its beliefs, talks now and then, fuses what it hears"}});
  out.push_back({{"name", "tracker"},
                 {"meaning", "scans, finds targets it cannot tell apart, exchanges tracks"}});
  out.push_back({{"name", "localizer"},
                 {"meaning",
                  "keeps its own pose from odometry, landmarks and companions, and tells "
                  "companions where it saw them"}});
  out.push_back({{"name", "explorer"},
                 {"meaning",
                  "flies over an area with a certainty grid, goes where a look tells most, tells "
                  "others what it believes and fuses what it hears"}});
  out.push_back({{"name", "forager"},
                 {"meaning",
                  "drives on a floor from event to event, lays trails of crumbs, tells others of "
                  "them and follows those it hears of"}});
  out.push_back({{"name", "source"}, {"meaning", "makes traffic, counts what it hears"}});
  for (const auto& [name, kind] : catalog.agents()) {
    out.push_back({{"name", name}, {"meaning", kind.meaning}});
  }
  return out;
}

Json key_of(const KeyInfo& key) {
  return {{"name", key.path},          {"type", key.type},
          {"unit", unit_of(key.path)}, {"default", key.default_value},
          {"allowed", key.allowed},    {"meaning", key.meaning}};
}

/// The keys of scenario files below `prefix`.
Json keys(const std::string& prefix) {
  Json out = Json::array();
  for (const KeyInfo& key : schema_keys()) {
    if (key.path.starts_with(prefix)) out.push_back(key_of(key));
  }
  return out;
}

Json radios() {
  Json out = Json::array();
  for (const RadioModelInfo& model : radio_models()) {
    const std::string chosen =
        model.chosen_by.empty() ? "" : model.chosen_by + " = \"" + model.name + "\"";
    Json parameter_list = Json::array();
    for (const KeyInfo& key : parameters(model)) parameter_list.push_back(key_of(key));
    out.push_back({{"name", model.name},
                   {"part", model.part},
                   {"chosen by", chosen},
                   {"meaning", model.meaning},
                   {"parameters", parameter_list},
                   {"source", model.source}});
  }
  return out;
}

Json scenarios() {
  Json out = Json::array();
  const auto root = share_directory() / "scenarios";
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    const bool study = file.string().ends_with(".study.toml");
    out.push_back({{"name", std::filesystem::relative(file, root).string()},
                   {"kind", study ? "study" : "scenario"},
                   {"file", file.string()}});
  }
  return out;
}

/// A parameter on one line: "radio.latency_s: number, s, ≥ 0, default 0.0: from the …".
std::string line_of(const Json& parameter) {
  const auto part = [&](const char* key, const char* before) {
    const auto text = parameter[key].get<std::string>();
    return text.empty() ? text : before + text;
  };
  return part("name", "") + part("type", ": ") + part("unit", ", ") + part("allowed", ", ") +
         part("default", ", default ") + part("meaning", ": ");
}

void print(const std::string& title, const Json& rows) {
  fmt::print("{}\n", title);
  for (const Json& row : rows) {
    fmt::print("  {}\n", row["name"].get<std::string>());
    for (const auto& [key, value] : row.items()) {
      if (value.is_array()) {
        for (const Json& parameter : value) fmt::print("      {}\n", line_of(parameter));
      } else if (key != "name" && !value.get<std::string>().empty()) {
        fmt::print("      {}: {}\n", key, value.get<std::string>());
      }
    }
  }
  fmt::print("\n");
}

}  // namespace

int list(const ListVerb& verb, const Catalog& catalog) {
  const std::vector<std::pair<std::string, std::function<Json()>>> topics = {
      {"rules", rules},
      {"radios", radios},
      {"sensors", [] { return keys("agents.sensor."); }},
      {"agents", [&] { return agents(catalog); }},
      {"metrics", [&] { return metrics_list(catalog); }},
      {"keys", [] { return keys(""); }},
      {"scenarios", scenarios},
  };
  Json out = Json::object();
  for (const auto& [topic, make] : topics) {
    if (verb.what == topic || (verb.what == "all" && topic != "keys")) out[topic] = make();
  }
  if (verb.json) {
    fmt::print("{}\n", out.dump(2));
    return exit_done;
  }
  for (const auto& [topic, rows] : out.items()) print(topic, rows);
  return exit_done;
}

}  // namespace hearsay::program
