#include <algorithm>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "scenarios/channel.hpp"
#include "scenarios/scenario_under_check.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

// A key that has an effect for one model only.
struct Belongs {
  const char* key;
  bool given;
  std::vector<std::string> to;
};

// Refuses keys that are given though `model` does not know them. `what` is the key that says which
// model it is.
void refuse_strangers(const ScenarioUnderCheck& file, const KeyPath& path, const char* what,
                      const std::string& model, const std::vector<Belongs>& keys) {
  for (const Belongs& key : keys) {
    if (!key.given || std::find(key.to.begin(), key.to.end(), model) != key.to.end()) continue;
    std::string allowed;
    for (const std::string& name : key.to) {
      allowed += (allowed.empty() ? "\"" : " or \"") + name + "\"";
    }
    file.fail(path[key.key],
              std::string("only for ") + what + " = " + allowed + "; found \"" + model + "\"");
  }
}

void need(const ScenarioUnderCheck& file, const KeyPath& path, const char* key, bool given) {
  if (!given) file.fail(path[key], "missing");
}

// The number of the agent that `key` of the table at `path` names.
void resolve(const ScenarioUnderCheck& file, const KeyPath& path, const char* key,
             std::optional<AgentRef>& agent) {
  need(file, path, key, agent.has_value());
  const KeyPath at = path[key];
  agent->number = file.resolve_agent(file.locate(at), at, agent->number);
}

void check_links(ScenarioUnderCheck& file, const KeyPath& path) {
  std::vector<std::tuple<int, int, std::size_t>> ends;
  std::vector<LinkLossSpec>& links = file.scenario.radio.loss.links;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const KeyPath link = path[i];
    resolve(file, link, "from", links[i].from);
    resolve(file, link, "to", links[i].to);
    need(file, link, "probability", links[i].probability.has_value());
    if (links[i].from == links[i].to) file.fail(link, "joins an agent to itself");
    ends.emplace_back(links[i].from->number, links[i].to->number, i);
  }
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 1; i < ends.size(); ++i) {
    const auto [from, to, entry] = ends[i];
    if (std::tie(from, to) != std::tie(std::get<0>(ends[i - 1]), std::get<1>(ends[i - 1]))) {
      continue;
    }
    file.fail(path[entry], "the link from " + file.agents()[static_cast<std::size_t>(from)] +
                               " to " + file.agents()[static_cast<std::size_t>(to)] +
                               " stands there twice");
  }
}

void check_bursts(const ScenarioUnderCheck& file, const KeyPath& path) {
  const LossSpec& loss = file.scenario.radio.loss;
  const bool p = loss.good_to_bad.has_value();
  const bool r = loss.bad_to_good.has_value();
  if (!loss.mean_burst && !p && !r) {
    file.fail(path["model"],
              "\"gilbert-elliott\" needs probability and mean_burst, or good_to_bad and "
              "bad_to_good");
  }
  if (loss.mean_burst && (p || r)) {
    file.fail(path["mean_burst"],
              "not together with good_to_bad and bad_to_good; give one of them");
  }
  if (p != r) {
    file.fail(path[p ? "good_to_bad" : "bad_to_good"],
              std::string("needs ") + (p ? "bad_to_good" : "good_to_bad") + ", too");
  }
  if (p && loss.probability > 0.0) {
    file.fail(path["probability"],
              "not together with good_to_bad and bad_to_good, which say how much is lost");
  }
  std::string wrong = loss.mean_burst ? wrong_with(burst_loss_of(loss)) : std::string();
  if (wrong.empty()) wrong = wrong_with(chain_of(loss));
  if (!wrong.empty()) file.fail(path, wrong);
}

void check_loss(ScenarioUnderCheck& file, const KeyPath& path) {
  const LossSpec& loss = file.scenario.radio.loss;
  if (loss.model == "none" && loss.probability > 0.0) {
    file.fail(path["probability"], "without effect; set radio.loss.model = \"bernoulli\", too");
  }
  const std::vector<std::string> bursts = {"gilbert-elliott"};
  refuse_strangers(file, path, "model", loss.model,
                   {{"links", !loss.links.empty(), {"bernoulli"}},
                    {"mean_burst", loss.mean_burst.has_value(), bursts},
                    {"good_to_bad", loss.good_to_bad.has_value(), bursts},
                    {"bad_to_good", loss.bad_to_good.has_value(), bursts},
                    {"loss_good", loss.loss_good != LossSpec{}.loss_good, bursts},
                    {"loss_bad", loss.loss_bad != LossSpec{}.loss_bad, bursts}});
  check_links(file, path["links"]);
  if (loss.model == "gilbert-elliott") check_bursts(file, path);
}

void check_propagation(const ScenarioUnderCheck& file, const KeyPath& radio_path) {
  const RadioSpec& radio = file.scenario.radio;
  const KeyPath path = radio_path["propagation"];
  const bool by_position = radio.topology == "by-position";
  if (radio.propagation && !by_position) {
    file.fail(path, "only for topology = \"by-position\"; found \"" + radio.topology + "\"");
  }
  if (!by_position) return;
  if (!radio.propagation) {
    file.fail(radio_path["topology"],
              "\"by-position\" needs radio.propagation, as { model = \"disk\", range_m = 100 }");
  }
  if (radio.range_m > 0.0) {
    file.fail(radio_path["range_m"],
              "only for topology = \"disk\"; give radio.propagation.range_m");
  }
  const PropagationSpec& spec = *radio.propagation;
  const PropagationSpec plain;
  const std::vector<std::string> zone = {"grey-zone"};
  const std::vector<std::string> log = {"log-distance"};
  refuse_strangers(
      file, path, "model", spec.model,
      {{"range_m", spec.range_m.has_value(), {"disk", "log-distance"}},
       {"inner_m", spec.inner_m != plain.inner_m, zone},
       {"outer_m", spec.outer_m != plain.outer_m, zone},
       {"exponent", spec.exponent != plain.exponent, log},
       {"reference_loss_db", spec.reference_loss_db != plain.reference_loss_db, log},
       {"reference_m", spec.reference_m != plain.reference_m, log},
       {"shadowing_sigma_db", spec.shadowing_sigma_db != plain.shadowing_sigma_db, log},
       {"transmit_dbm", spec.transmit_dbm != plain.transmit_dbm, log},
       {"noise_dbm", spec.noise_dbm != plain.noise_dbm, log}});
  if (spec.model == "disk") need(file, path, "range_m", spec.range_m.has_value());
  if (spec.model == "grey-zone") need(file, path, "outer_m", spec.outer_m > 0.0);
  const std::string wrong = spec.model == "grey-zone"      ? wrong_with(grey_zone_of(spec))
                            : spec.model == "log-distance" ? wrong_with(log_distance_of(spec))
                                                           : std::string();
  if (!wrong.empty()) file.fail(path, wrong);
}

void check_jammer(const ScenarioUnderCheck& file, const KeyPath& path, const JammerSpec& jammer) {
  need(file, path, "position_m", !jammer.position_m.empty());
  if (jammer.period_s.has_value() != jammer.duty.has_value()) {
    const bool period = jammer.period_s.has_value();
    file.fail(path[period ? "period_s" : "duty"],
              std::string("needs ") + (period ? "duty" : "period_s") + ", too");
  }
  if (jammer.until_s && *jammer.until_s <= jammer.from_s) {
    file.fail(path["until_s"], "must be after from_s (" + to_toml(jammer.from_s) + " s)");
  }
  const std::string wrong = wrong_with(jammer_of(jammer));
  if (!wrong.empty()) file.fail(path, wrong);
  const auto& propagation = file.scenario.radio.propagation;
  if (jammer.power_dbm && !(propagation && propagation->model == "log-distance")) {
    file.fail(path["power_dbm"],
              "only for radio.propagation.model = \"log-distance\", which knows powers; give "
              "radius_m");
  }
}

void check_jammers(const ScenarioUnderCheck& file, const KeyPath& path) {
  const auto& jammers = file.scenario.radio.jammers;
  for (std::size_t i = 0; i < jammers.size(); ++i) check_jammer(file, path[i], jammers[i]);
}

// The first thing that does not go together in a dropout; `key` says where.
std::pair<const char*, std::string> contradiction(const DropoutSpec& d) {
  const bool planned = d.from_s.has_value();
  const bool random = d.mean_up_s.has_value();
  const bool dies = d.kind == "die";
  const std::string dead = "not for kind = \"die\", from which nobody comes back";
  if (planned && random) return {"mean_up_s", "not together with from_s; give one of them"};
  if (!planned && !random) return {"from_s", "missing; give it, or mean_up_s for random times"};
  if (planned && d.mean_down_s) return {"mean_down_s", "only with mean_up_s"};
  if (random && d.until_s) return {"until_s", "only with from_s"};
  if (dies && d.until_s) return {"until_s", dead};
  if (dies && d.mean_down_s) return {"mean_down_s", dead};
  if (!dies && planned && !d.until_s) {
    return {"until_s", "missing; only with kind = \"die\" is an outage without end"};
  }
  if (!dies && random && !d.mean_down_s) {
    return {"mean_down_s", "missing; only with kind = \"die\" is an outage without end"};
  }
  if (d.outages_max && !d.mean_down_s) return {"outages_max", "only with mean_down_s"};
  if (d.memory && d.kind != "reboot") {
    return {"memory", "only for kind = \"reboot\"; found \"" + d.kind + "\""};
  }
  if (d.until_s && *d.until_s <= *d.from_s) {
    return {"until_s", "must be after from_s (" + to_toml(*d.from_s) + " s)"};
  }
  return {nullptr, {}};
}

void check_dropouts(ScenarioUnderCheck& file) {
  const KeyPath top;
  const KeyPath all = top["dropouts"];
  for (std::size_t i = 0; i < file.scenario.dropouts.size(); ++i) {
    DropoutSpec& dropout = file.scenario.dropouts[i];
    const KeyPath path = all[i];
    const KeyPath agents = path["agents"];
    for (std::size_t k = 0; k < dropout.agents.size(); ++k) {
      AgentRef& agent = dropout.agents[k];
      const KeyPath at = agents[k];
      agent.number = file.resolve_agent(file.locate(at), at, agent.number);
      const auto here = dropout.agents.begin() + static_cast<std::ptrdiff_t>(k);
      if (std::find(dropout.agents.begin(), here, agent) != here) {
        reject(file.locate(at), at, "stands there twice");
      }
    }
    const auto [key, why] = contradiction(dropout);
    if (key) file.fail(path[key], why);
  }
}

}  // namespace

void check_channel(ScenarioUnderCheck& file) {
  const KeyPath top;
  const KeyPath radio = top["radio"];
  check_loss(file, radio["loss"]);
  check_propagation(file, radio);
  check_jammers(file, radio["jammers"]);
  check_dropouts(file);
}

}  // namespace hearsay
