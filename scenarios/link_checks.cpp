#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "net/random_graphs.hpp"
#include "scenarios/contacts.hpp"
#include "scenarios/links.hpp"
#include "scenarios/motion.hpp"
#include "scenarios/scenario_under_check.hpp"

namespace hearsay {
namespace {

class LinkChecker {
 public:
  explicit LinkChecker(ScenarioUnderCheck& file) : file_(file), radio_(file.scenario.radio) {}

  void all() {
    check_keys();
    check_motion();
    check_sizes();
    check_places();
    resolve_pairs(path_["edges"], radio_.edges);
    if (radio_.topology == "contacts") {
      radio_.contact_trace =
          std::make_shared<const std::vector<LinkChange>>(read_contacts(radio_.contacts, file_));
    }
    const KeyPath outages = path_["outages"];
    for (std::size_t i = 0; i < radio_.outages.size(); ++i) {
      check_outage(outages[i], radio_.outages[i]);
    }
    check_that_links_exist();
    const KeyPath partitions = path_["partitions"];
    for (std::size_t i = 0; i < radio_.partitions.size(); ++i) {
      PartitionSpec& partition = radio_.partitions[i];
      const KeyPath path = partitions[i];
      check_groups(path, partition.groups);
      check_end(path["until_s"], partition.until_s, "from_s", partition.from_s);
    }
    if (radio_.rotation) check_rotation(path_["rotation"], *radio_.rotation);
  }

 private:
  void check_keys() const;
  void check_motion() const;
  void check_sizes() const;
  void check_places() const;
  void resolve_pairs(const KeyPath& path, std::vector<std::array<int, 2>>& pairs) const;
  void check_outage(const KeyPath& path, OutageSpec& outage) const;
  void check_that_links_exist() const;
  void check_groups(const KeyPath& path, GroupsSpec& groups) const;
  void check_rotation(const KeyPath& path, RotationSpec& rotation) const;
  void check_end(const KeyPath& path, const std::optional<double>& end_s, const char* begin_key,
                 double begin_s) const;
  [[noreturn]] void refuse(const KeyPath& path, const std::string& why) const {
    reject(file_.locate(path), path, why);
  }

  ScenarioUnderCheck& file_;
  RadioSpec& radio_;
  KeyPath top_;
  KeyPath path_ = top_["radio"];
};

// A key that belongs to another topology would be without effect.
void LinkChecker::check_keys() const {
  const bool ranged = radio_.topology == "disk" || radio_.topology == "random-geometric";
  // (check_propagation() says where "by-position" has its range.)
  if (radio_.range_m > 0.0 && !ranged && radio_.topology != "by-position") {
    file_.fail(path_["range_m"], "only for topology = \"disk\" or \"random-geometric\"; found \"" +
                                     radio_.topology + "\"");
  }
  struct Key {
    const char* key;
    const char* topology;
    bool given;
    const char* example;
  };
  const Key keys[] = {
      {"edges", "edges", !radio_.edges.empty(), ", as [[0, 1], [1, 2]]"},
      {"columns", "grid", radio_.columns.has_value(), ""},
      {"link_probability", "erdos-renyi", radio_.link_probability.has_value(), ""},
      {"mean_degree", "small-world", radio_.mean_degree.has_value(), ""},
      {"rewire_probability", "small-world", radio_.rewire_probability.has_value(), ""},
      {"side_m", "random-geometric", radio_.side_m.has_value(), ""},
      {"contacts", "contacts", !radio_.contacts.empty(), ", a CSV file t_s,a,b,state"}};
  for (const Key& key : keys) {
    const bool wanted = radio_.topology == key.topology;
    if (key.given && !wanted) {
      file_.fail(path_[key.key], std::string("only for topology = \"") + key.topology +
                                     "\"; found \"" + radio_.topology + "\"");
    }
    if (wanted && !key.given) {
      file_.fail(path_["topology"],
                 "\"" + radio_.topology + "\" needs radio." + key.key + key.example);
    }
  }
}

// Who hears whom among agents that move follows from where they are.
void LinkChecker::check_motion() const {
  const bool by_place = radio_.topology == "disk" || radio_.topology == "by-position";
  if (!by_place || !has_motion(file_.scenario)) return;
  const char* given = !radio_.outages.empty()      ? "outages"
                      : !radio_.partitions.empty() ? "partitions"
                      : radio_.rotation            ? "rotation"
                                                   : nullptr;
  if (given == nullptr) return;
  file_.fail(path_[given], "not for agents that move with topology = \"" + radio_.topology +
                               "\": their links come and go by where they are");
}

void LinkChecker::check_sizes() const {
  const int agents = file_.scenario.agent_count();
  const std::string all = std::to_string(agents) + ", the number of agents";
  if (radio_.columns && *radio_.columns > agents) {
    refuse(path_["columns"], "must be at most " + all);
  }
  if (radio_.mean_degree && *radio_.mean_degree % 2 != 0) {
    refuse(path_["mean_degree"], "must be even: as many neighbours on either side of a ring");
  }
  if (radio_.mean_degree && *radio_.mean_degree >= agents) {
    refuse(path_["mean_degree"], "must be less than " + all);
  }
  if (radio_.topology == "erdos-renyi" && agents > erdos_renyi_agents_max) {
    file_.fail(path_["topology"], "\"erdos-renyi\" is for at most " +
                                      std::to_string(erdos_renyi_agents_max) +
                                      " agents; there are " + std::to_string(agents));
  }
}

void LinkChecker::check_places() const {
  const bool drawn = radio_.topology == "random-geometric";
  if (!drawn && radio_.topology != "disk") return;
  if (radio_.range_m <= 0.0) {
    file_.fail(path_["topology"], "\"" + radio_.topology + "\" needs radio.range_m above 0");
  }
  const KeyPath agents = top_["agents"];
  for (std::size_t i = 0; i < file_.scenario.agents.size(); ++i) {
    const AgentSpec& agent = file_.scenario.agents[i];
    if (placed(agent) && drawn) {
      file_.fail(agents[i][agent.circle ? "circle" : "position_m"],
                 "not with topology = \"random-geometric\", which draws where agents stand; for "
                 "places of your own take \"disk\"");
    }
    if (has_place(agent) || drawn) continue;
    file_.fail(agents[i],
               "topology = \"disk\" needs to know where it stands: position_m, circle or motion");
  }
}

void LinkChecker::resolve_pairs(const KeyPath& path, std::vector<std::array<int, 2>>& pairs) const {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const KeyPath here = path[i];
    const TomlNode& node = file_.locate(here);
    auto& [a, b] = pairs[i];
    a = file_.resolve_agent(node.children[0], here, a);
    b = file_.resolve_agent(node.children[1], here, b);
    if (a == b) reject(node, here, "joins an agent to itself");
  }
}

void LinkChecker::check_outage(const KeyPath& path, OutageSpec& outage) const {
  if (outage.links.empty()) file_.fail(path["links"], "missing; which links, as [[0, 1], [1, 2]]");
  resolve_pairs(path["links"], outage.links);
  check_end(path["up_s"], outage.up_s, "down_s", outage.down_s);
}

// An outage or a loss of a link that is not in the graph would be without effect. (Whether a graph
// that is drawn at random has a link depends on the seed; and who moves may meet anybody.)
void LinkChecker::check_that_links_exist() const {
  const std::vector<LinkLossSpec>& losses = radio_.loss.links;
  if (radio_.outages.empty() && losses.empty()) return;
  const bool by_place = radio_.topology == "disk" || radio_.topology == "by-position";
  if (radio_.topology == "full" || is_drawn(radio_)) return;
  if (by_place && has_motion(file_.scenario)) return;
  const Topology graph = topology_of(file_.scenario, agent_positions(file_.scenario));
  const auto require_link = [&](const KeyPath& path, int a, int b) {
    if (graph.link(a, b) >= 0) return;
    refuse(path, "there is no such link in the topology \"" + radio_.topology + "\"");
  };
  const KeyPath outages = path_["outages"];
  for (std::size_t i = 0; i < radio_.outages.size(); ++i) {
    const KeyPath outage = outages[i];
    const KeyPath links = outage["links"];
    for (std::size_t k = 0; k < radio_.outages[i].links.size(); ++k) {
      const auto [a, b] = radio_.outages[i].links[k];
      require_link(links[k], a, b);
    }
  }
  const KeyPath loss = path_["loss"];
  const KeyPath links = loss["links"];
  for (std::size_t i = 0; i < losses.size(); ++i) {
    require_link(links[i], losses[i].from->number, losses[i].to->number);
  }
}

void LinkChecker::check_groups(const KeyPath& path, GroupsSpec& groups) const {
  const KeyPath all = path["groups"];
  if (groups.size() < 2) file_.fail(all, "needs at least two groups, as [[0, 1], [2, 3]]");
  std::vector<bool> grouped(static_cast<std::size_t>(file_.scenario.agent_count()), false);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const KeyPath group = all[g];
    const TomlNode& node = file_.locate(group);
    if (groups[g].empty()) reject(node, group, "must name at least one agent");
    for (std::size_t i = 0; i < groups[g].size(); ++i) {
      const KeyPath member = group[i];
      const TomlNode& written = node.children[i];
      int& agent = groups[g][i];
      agent = file_.resolve_agent(written, member, agent);
      const auto slot = static_cast<std::size_t>(agent);
      if (grouped[slot]) reject(written, member, "stands in groups twice");
      grouped[slot] = true;
    }
  }
  for (std::size_t agent = 0; agent < grouped.size(); ++agent) {
    if (grouped[agent]) continue;
    file_.fail(all, "leaves out agent " + std::to_string(agent) + ", '" + file_.agents()[agent] +
                        "'; each stands in one group");
  }
}

void LinkChecker::check_rotation(const KeyPath& path, RotationSpec& rotation) const {
  check_groups(path, rotation.groups);
  if (!rotation.period_s) file_.fail(path["period_s"], "missing");
  if (rotation.cut_s && *rotation.cut_s > *rotation.period_s) {
    refuse(path["cut_s"], "must be at most period_s (" + to_toml(*rotation.period_s) + " s)");
  }
  const bool whole_period = rotation.cut_s.value_or(*rotation.period_s) == *rotation.period_s;
  if (rotation.groups.size() == 2 && whole_period) {
    file_.fail(path["groups"],
               "two groups would be apart all the time; give cut_s below period_s, or "
               "[[radio.partitions]]");
  }
  if (!rotation.until_s && !file_.scenario.duration_s) {
    file_.fail(path["until_s"], "missing; only with duration_s it has a default");
  }
  check_end(path["until_s"], rotation.until_s, "from_s", rotation.from_s);
}

void LinkChecker::check_end(const KeyPath& path, const std::optional<double>& end_s,
                            const char* begin_key, double begin_s) const {
  if (!end_s || *end_s > begin_s) return;
  refuse(path, std::string("must be after ") + begin_key + " (" + to_toml(begin_s) + " s)");
}

}  // namespace

void check_links(ScenarioUnderCheck& file) { LinkChecker(file).all(); }

}  // namespace hearsay
