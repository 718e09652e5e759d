#include "scenarios/schema.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <utility>

#include "scenarios/describe.hpp"
#include "scenarios/names.hpp"
#include "scenarios/writer.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

const char* type_of(double) { return "number"; }
const char* type_of(int) { return "integer"; }
const char* type_of(std::uint64_t) { return "integer"; }
const char* type_of(bool) { return "boolean"; }
const char* type_of(const AgentRef&) { return "agent"; }
const char* type_of(const std::vector<AgentRef>&) { return "array of agents"; }
const char* type_of(const std::string&) { return "string"; }
const char* type_of(const std::vector<double>&) { return "2 coordinates"; }
const char* type_of(const NumberList&) { return "array of numbers"; }
const char* type_of(const std::vector<std::string>&) { return "array of strings"; }
const char* type_of(const std::vector<std::array<int, 2>>&) { return "array of pairs"; }
const char* type_of(const std::vector<std::array<double, 2>>&) { return "array of points"; }
const char* type_of(const std::vector<std::vector<int>>&) { return "array of groups"; }
const char* type_of(const std::map<std::string, double>&) { return "number"; }
template <class T>
const char* type_of(const std::optional<T>&) {
  return type_of(T{});
}

struct Schema {
  std::vector<KeyInfo> keys;
  std::map<std::string, std::vector<std::string>> tables;  // path → names of the entries
  std::vector<std::string> table_arrays;                   // paths
};

// Lists keys, tables and arrays of tables.
class Lister {
 public:
  Lister(Schema& schema, std::string path, const KnownNames& names)
      : schema_(schema), path_(std::move(path)), names_(names) {
    schema_.tables[path_];
  }
  const KnownNames& names() const { return names_; }

  template <class T>
  void field(const char* key, T& member, const Allowed& allowed, const char* meaning) {
    std::string path = enter(key);
    std::string value = toml_text(member);
    if constexpr (std::is_same_v<T, std::map<std::string, double>>) {
      schema_.tables[path];
      path += ".*";
      value.clear();
    }
    const bool none = value == "\"\"" || value == "[]";
    schema_.keys.push_back(
        {path, type_of(member), none ? std::string() : value, allowed.text(), meaning});
  }
  template <class S>
  void table(const char* key, S& member, const char*) {
    Lister inner(schema_, enter(key), names_);
    describe(inner, member);
  }
  template <class S>
  void table(const char* key, std::optional<S>&, const char* meaning) {
    S member;
    table(key, member, meaning);
  }
  template <class S>
  void table(const char* key, std::vector<S>&, const char* meaning) {
    S member;
    table(key, member, meaning);
    schema_.table_arrays.push_back(join_path(path_, key));
  }

 private:
  static std::string join_path(const std::string& path, const char* key) {
    return path.empty() ? key : path + "." + key;
  }
  std::string enter(const char* key) {
    schema_.tables[path_].emplace_back(key);
    return join_path(path_, key);
  }
  Schema& schema_;
  std::string path_;
  const KnownNames& names_;
};

Schema make_schema(const KnownNames& names) {
  Schema schema;
  Lister lister(schema, "", names);
  Scenario scenario;
  describe(lister, scenario);
  return schema;
}

// Paths do not depend on the names that a program adds.
const Schema& schema_paths() {
  static const Schema schema = make_schema({});
  return schema;
}

// "agents[1]" → {agents, 1}. Nothing if the brackets are not right.
std::optional<KeyStep> parse_step(std::string_view text) {
  KeyStep step;
  const auto bracket = text.find('[');
  step.name = std::string(text.substr(0, bracket));
  if (step.name.empty()) return std::nullopt;
  if (bracket == std::string_view::npos) return step;
  const char* begin = text.data() + bracket + 1;
  const char* end = text.data() + text.size();
  const auto [after, error] = std::from_chars(begin, end, step.index);
  const bool closed = after + 1 == end && *after == ']';
  if (error != std::errc() || !closed || step.index < 0) return std::nullopt;
  return step;
}

std::vector<KeyStep> split_key(std::string_view key, const std::string& origin) {
  std::vector<KeyStep> steps;
  for (std::size_t at = 0; at <= key.size();) {
    const std::size_t dot = std::min(key.find('.', at), key.size());
    const auto step = parse_step(key.substr(at, dot - at));
    if (!step) {
      throw InputError(origin + ": '" + std::string(key) +
                       "' is not a key; keys look like agents[1].talk.period_s");
    }
    steps.push_back(*step);
    at = dot + 1;
  }
  return steps;
}

std::string key_text(const std::vector<KeyStep>& steps) {
  std::string text;
  for (const KeyStep& step : steps) {
    text += (text.empty() ? "" : ".") + step.name;
    if (step.index >= 0) text += "[" + std::to_string(step.index) + "]";
  }
  return text;
}

// What to say where step `wrong` is not an entry of the table `path` ("" is the top).
std::string suggestion(std::vector<KeyStep> steps, std::size_t wrong, const std::string& path) {
  // The end of a path without its beginning: loss.probability.
  const std::string ending = "." + key_text(steps);
  const auto& siblings = schema_paths().tables.at(path);
  if (const auto near = nearest_name(steps[wrong].name, siblings)) {
    steps[wrong].name = *near;
    return "did you mean '" + key_text(steps) + "'?";
  }
  for (const KeyInfo& info : schema_paths().keys) {
    if (info.path.ends_with(ending)) return "did you mean '" + info.path + "'?";
  }
  const std::string place = path.empty() ? "at the top level" : "in [" + path + "]";
  return "allowed " + place + ": " + join(siblings);
}

}  // namespace

std::vector<KeyInfo> schema_keys(const KnownNames& names) { return make_schema(names).keys; }

std::vector<KeyStep> parse_key(std::string_view key, const std::string& origin) {
  const Schema& schema = schema_paths();
  const std::vector<KeyStep> steps = split_key(key, origin);
  const auto fail = [&](const std::string& why) {
    throw InputError(origin + ": unknown key '" + std::string(key) + "'; " + why);
  };
  std::string path;  // of the schema, without indices
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto table = schema.tables.find(path);
    if (table == schema.tables.end()) fail("'" + path + "' is not a table");
    const auto& names = table->second;
    const bool free_names = path == "agents.parameters";
    if (!free_names && std::find(names.begin(), names.end(), steps[i].name) == names.end()) {
      fail(suggestion(steps, i, path));
    }
    path += (path.empty() ? "" : ".") + steps[i].name;
    if (steps[i].index >= 0 && !is_table_array(path)) {
      fail("'" + path + "' takes no number in brackets");
    }
  }
  return steps;
}

bool is_table_array(const std::string& path) {
  const auto& arrays = schema_paths().table_arrays;
  return std::find(arrays.begin(), arrays.end(), path) != arrays.end();
}

bool covers(const std::vector<KeyStep>& later, const std::vector<KeyStep>& earlier) {
  if (later.size() > earlier.size()) return false;
  return std::equal(later.begin(), later.end(), earlier.begin(),
                    [](const KeyStep& a, const KeyStep& b) {
                      return a.name == b.name && (a.index < 0 || a.index == b.index);
                    });
}

}  // namespace hearsay
