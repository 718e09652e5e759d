// The keys of scenario files, as data.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenarios/loader.hpp"

namespace hearsay {

/// One key that a scenario file may set.
struct KeyInfo {
  std::string path;           ///< "agents.sensor.period_s"; "agents.parameters.*": any name
  std::string type;           ///< "number", "integer", "string", "2 coordinates", …
  std::string default_value;  ///< as TOML; empty if there is none
  std::string allowed;  ///< "> 0", "0 … 1", "line | ring | …"; empty: anything of the type
  std::string meaning;  ///< one line
};

/// All keys, in the order of canonical_text().
std::vector<KeyInfo> schema_keys(const KnownNames& names = {});

/// One step of a key given to --set or an axis: a name and, in brackets, which element.
struct KeyStep {
  std::string name;
  int index = -1;  ///< −1: not given, that is all
};

/// Splits "agents[1].sensor.period_s" and checks it against the schema. Tables may be named, too
/// ("agents.sensor"). @throws InputError "<origin>: unknown key '…'; did you mean '…'?".
std::vector<KeyStep> parse_key(std::string_view key, const std::string& origin);

/// True if the key, given without indices, is an array of tables ("agents", "world.targets").
bool is_table_array(const std::string& path);

/// True if setting `later` leaves nothing of what setting `earlier` did (same key, or its table).
bool covers(const std::vector<KeyStep>& later, const std::vector<KeyStep>& earlier);

}  // namespace hearsay
