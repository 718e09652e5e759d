// A scenario that was read and is being checked: what the checks of its parts share.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/csv.hpp"
#include "scenarios/document.hpp"
#include "scenarios/reading.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

class ScenarioUnderCheck {
 public:
  /// `root` is what `scenario` was read from.
  ScenarioUnderCheck(const TomlNode& root, Scenario& checked) : scenario(checked), root_(root) {}

  Scenario& scenario;

  /// Where `path` is written, or the innermost table around it that is in the file.
  const TomlNode& locate(const KeyPath& path) const;
  /// @throws InputError "ring.toml:12: radio.edges: …".
  [[noreturn]] void fail(const KeyPath& path, const std::string& why) const {
    reject_key(locate(path).origin, path.text(), why);
  }

  /// Once, before the following are asked: takes the names of all agents.
  void name_agents();
  const std::vector<std::string>& agents() const { return names_; }
  std::optional<std::size_t> agent_called(const std::string& name) const;
  /// The number of the agent that the element `end` at `path` names: by its name, or, `given`, by
  /// number. @throws InputError if there is none.
  int resolve_agent(const TomlNode& end, const KeyPath& path, int given) const;
  /// The number of the agent that a field of a CSV file names, by name or by number.
  /// @throws InputError if there is none.
  int resolve_agent(const CsvFile& csv, std::size_t row, std::size_t column) const;

 private:
  std::string no_agent_called(std::string_view name) const;
  std::string no_agent_with(const std::string& number) const;

  const TomlNode& root_;
  std::vector<std::string> names_;
  std::vector<std::size_t> by_name_;  // agents sorted by name
};

/// True if the file says where such an agent stands, or begins.
inline bool placed(const AgentSpec& agent) { return agent.position_m || agent.circle; }
/// True if it says where the agent is.
inline bool has_place(const AgentSpec& agent) {
  return placed(agent) || agent.motion || agent.robot;
}

/// The first one whose name an earlier one has, too.
std::optional<std::size_t> first_duplicate(const std::vector<std::string>& names);

/// Checks what sources send, and finds the numbers of its receivers.
/// @throws InputError.
void check_traffic(ScenarioUnderCheck& file);
/// Checks queue, frames and how the channel is shared.
/// @throws InputError.
void check_transmitter(ScenarioUnderCheck& file);
/// Checks [radio], finds the numbers of agents in it and reads its files.
/// @throws InputError.
void check_radio(ScenarioUnderCheck& file);
/// The part of check_radio() about who hears whom when.
void check_links(ScenarioUnderCheck& file);

/// Checks that agents' services go with one another and with their rules.
/// @throws InputError.
void check_services(ScenarioUnderCheck& file);

/// Checks what cameras and range-bearing sensors need to know.
/// @throws InputError.
void check_sensors(const ScenarioUnderCheck& file);

/// Checks that estimators, sensors and the motion of targets go together.
/// @throws InputError.
void check_estimators(ScenarioUnderCheck& file);
/// Checks agents that track, and their sensors.
/// @throws InputError.
void check_trackers(ScenarioUnderCheck& file);
/// Checks robots that localize themselves.
/// @throws InputError.
void check_localizers(const ScenarioUnderCheck& file);
/// Checks areas, and agents that explore them, and reads the heights of cells.
/// @throws InputError.
void check_explorers(ScenarioUnderCheck& file);
/// Reads the plan, and checks it and the agents that forage on it.
/// @throws InputError.
void check_foragers(ScenarioUnderCheck& file);
/// Checks that what rules and talk need is given, and nothing that would be without effect.
/// @throws InputError.
void check_talk(const ScenarioUnderCheck& file);

/// Checks how agents and targets move, and reads their tracks.
/// @throws InputError.
void check_motion(ScenarioUnderCheck& file);

/// Checks losses, propagation, jammers and dropouts, and finds the numbers of agents in them. Part
/// of check_radio().
/// @throws InputError.
void check_channel(ScenarioUnderCheck& file);

}  // namespace hearsay
