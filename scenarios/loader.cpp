#include "scenarios/loader.hpp"

#include <filesystem>
#include <utility>

#include "scenarios/checks.hpp"
#include "scenarios/describe.hpp"
#include "scenarios/overrides.hpp"
#include "scenarios/writer.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

// Names of the entries of a table.
class KeyNames {
 public:
  const KnownNames& names() const { return names_; }
  template <class T>
  void field(const char* key, T&, const Allowed&, const char*) {
    keys.emplace_back(key);
  }
  template <class T>
  void table(const char* key, T&, const char*) {
    keys.emplace_back(key);
  }
  std::vector<std::string> keys;

 private:
  KnownNames names_;
};

template <class S>
const std::vector<std::string>& key_names() {
  static const std::vector<std::string> keys = [] {
    KeyNames visitor;
    S member;
    describe(visitor, member);
    return visitor.keys;
  }();
  return keys;
}

// Reads the entries of a table into the members of a struct.
class Reader {
 public:
  Reader(const TomlNode& table, const KeyPath& path, const KnownNames& names)
      : table_(table), path_(path), names_(names) {}
  const KnownNames& names() const { return names_; }

  template <class T>
  void field(const char* key, T& member, const Allowed& allowed, const char*) {
    if (const TomlNode* node = table_.find(key)) read(*node, path_[key], allowed, member);
  }
  template <class S>
  void table(const char* key, S& member, const char*) {
    if (const TomlNode* node = table_.find(key)) read_struct(*node, path_[key], member);
  }
  template <class S>
  void table(const char* key, std::optional<S>& member, const char*) {
    if (const TomlNode* node = table_.find(key)) read_struct(*node, path_[key], member.emplace());
  }
  template <class S>
  void table(const char* key, std::vector<S>& members, const char*) {
    const TomlNode* node = table_.find(key);
    if (!node) return;
    const KeyPath path = path_[key];
    expect_array(*node, path, "an array of tables");
    members.resize(node->children.size());
    for (std::size_t i = 0; i < members.size(); ++i) {
      read_struct(node->children[i], path[i], members[i]);
    }
  }
  /// The table itself: its keys first, because a misspelt key explains what else is wrong.
  template <class S>
  void read_all(S& member) {
    expect_table(table_, path_);
    expect_known_keys(table_, path_, key_names<S>());
    describe(*this, member);
  }

 private:
  template <class S>
  void read_struct(const TomlNode& node, const KeyPath& path, S& member) {
    Reader(node, path, names_).read_all(member);
  }
  const TomlNode& table_;
  const KeyPath& path_;
  const KnownNames& names_;
};

// Writes members as the inside of a TOML table.
class Writer {
 public:
  explicit Writer(const char* separator) : separator_(separator) {}
  const KnownNames& names() const { return names_; }

  template <class T>
  void field(const char* key, T& member, const Allowed&, const char*) {
    const std::string value = toml_text(member);
    if (!value.empty()) put(key, value);
  }
  template <class S>
  void table(const char* key, S& member, const char*) {
    put(key, braces(member));
  }
  template <class S>
  void table(const char* key, std::optional<S>& member, const char*) {
    if (member) put(key, braces(*member));
  }
  template <class S>
  void table(const char* key, std::vector<S>& members, const char*) {
    std::string value;
    for (S& member : members) value += (value.empty() ? "\n  " : ",\n  ") + braces(member);
    put(key, "[" + value + "]");
  }
  const std::string& text() const { return text_; }

 private:
  template <class S>
  static std::string braces(S& member) {
    Writer inner(", ");
    describe(inner, member);
    return "{ " + inner.text() + " }";
  }
  void put(const char* key, const std::string& value) {
    if (!text_.empty()) text_ += separator_;
    text_ += std::string(key) + " = " + value;
  }
  const char* separator_;
  std::string text_;
  KnownNames names_;
};

// A path named in the file is meant from there; one named with --set from where the user is.
void resolve_path(const TomlNode* node, const std::string& file, std::string& value) {
  const std::filesystem::path path(value);
  const bool from_file = node && node->origin.line > 0;
  if (!from_file || value.empty() || path.is_absolute()) return;
  value = (std::filesystem::path(file).parent_path() / path).lexically_normal().string();
}

void resolve_paths(const TomlNode& root, const std::string& file, Scenario& scenario) {
  if (scenario.world.log) {
    const TomlNode* node = root.find("world")->find("log")->find("directory");
    resolve_path(node, file, scenario.world.log->directory);
  }
  if (scenario.world.area && scenario.world.area->heights) {
    const TomlNode* node = root.find("world")->find("area")->find("heights");
    resolve_path(node, file, *scenario.world.area->heights);
  }
  if (scenario.world.plan) {
    const TomlNode* node = root.find("world")->find("plan")->find("file");
    resolve_path(node, file, scenario.world.plan->file);
  }
  if (!scenario.radio.contacts.empty()) {
    resolve_path(root.find("radio")->find("contacts"), file, scenario.radio.contacts);
  }
  for (std::size_t i = 0; i < scenario.agents.size(); ++i) {
    std::optional<MotionSpec>& motion = scenario.agents[i].motion;
    if (!motion || !motion->file) continue;
    const TomlNode* node = root.find("agents")->children[i].find("motion");
    resolve_path(node->find("file"), file, *motion->file);
  }
}

}  // namespace

Scenario build_scenario(TomlNode root, const std::string& file, std::span<const Override> overrides,
                        const KnownNames& names) {
  if (const TomlNode* node = root.find("scenario")) {
    throw InputError(node->origin.text() +
                     ": has a key 'scenario', so it is a study, not a scenario");
  }
  for (const Override& override_ : overrides) apply(override_, root);
  Scenario scenario;
  scenario.file = file;
  const KeyPath top;
  Reader(root, top, names).read_all(scenario);
  resolve_paths(root, file, scenario);
  finish(root, scenario);
  return scenario;
}

Scenario load_scenario(const std::string& file, std::span<const Override> overrides,
                       const KnownNames& names) {
  return build_scenario(read_toml_file(file), file, overrides, names);
}

bool is_study(const std::string& file) { return read_toml_file(file).find("scenario") != nullptr; }

std::string canonical_text(const Scenario& scenario) {
  Scenario copy = scenario;  // describe() wants members that could be written to
  Writer writer("\n");
  describe(writer, copy);
  return writer.text() + "\n";
}

}  // namespace hearsay
