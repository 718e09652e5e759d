#include "scenarios/overrides.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "scenarios/schema.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t";
  const auto begin = text.find_first_not_of(blank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blank) - begin + 1);
}

// Text that is not TOML but can only have been meant as a string: naive, ../data/mrclam6.
bool is_bare_word(std::string_view text) {
  const bool begins_as_toml = std::string_view("\"'[{").find(text.front()) != text.npos;
  const bool control = std::any_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
  });
  return !begins_as_toml && !control;
}

struct Setting {
  const std::vector<KeyStep>& steps;
  const TomlNode& value;
  const std::string& origin;
};

// The first `depth` + 1 steps as a key of the schema.
std::string path_to(const Setting& setting, std::size_t depth) {
  std::string path;
  for (std::size_t i = 0; i <= depth; ++i) {
    path += (path.empty() ? "" : ".") + setting.steps[i].name;
  }
  return path;
}

void set(TomlNode& table, const Setting& setting, std::size_t depth);

void set_element(TomlNode& element, const Setting& setting, std::size_t depth) {
  if (depth + 1 < setting.steps.size()) {
    set(element, setting, depth + 1);
  } else {
    element = setting.value;
  }
}

void set_elements(TomlNode& array, const Setting& setting, std::size_t depth) {
  const KeyStep& step = setting.steps[depth];
  const std::size_t count = array.children.size();
  if (step.index < 0) {
    for (TomlNode& element : array.children) set_element(element, setting, depth);
    return;
  }
  const auto index = static_cast<std::size_t>(step.index);
  if (index >= count) {
    const std::string known = count == 0 ? "none" : "0 … " + std::to_string(count - 1);
    throw InputError(setting.origin + ": there is no " + step.name + "[" + std::to_string(index) +
                     "]; in the file: " + known);
  }
  set_element(array.children[index], setting, depth);
}

void set(TomlNode& table, const Setting& setting, std::size_t depth) {
  // A file that has something else here is refused when it is read.
  if (table.type != TomlNode::Type::table) return;
  const KeyStep& step = setting.steps[depth];
  const bool last = depth + 1 == setting.steps.size();
  TomlNode* child = table.find(step.name);
  const bool of_array = is_table_array(path_to(setting, depth));
  if (of_array && (!last || step.index >= 0)) {
    if (child && child->type == TomlNode::Type::array) {
      set_elements(*child, setting, depth);
    } else if (!child) {
      throw InputError(setting.origin + ": there is no '" + step.name + "' in the file to set");
    }
    return;
  }
  if (last) {
    TomlNode value = setting.value;
    value.key = step.name;
    table.put(std::move(value));
    return;
  }
  if (!child) {
    TomlNode made;
    made.key = step.name;
    made.origin = setting.value.origin;
    table.put(std::move(made));
    child = table.find(step.name);
  }
  set(*child, setting, depth + 1);
}

}  // namespace

std::string origin_text(const Override& override_) {
  const bool bare = override_.origin.empty() || override_.origin == "--set";
  return bare ? "--set " + override_.key + "=" + override_.toml : override_.origin;
}

Override parse_set(std::string_view text) {
  const auto equals = text.find('=');
  const std::string_view key = trimmed(text.substr(0, equals));
  const std::string_view value =
      equals == std::string_view::npos ? std::string_view() : trimmed(text.substr(equals + 1));
  if (key.empty() || value.empty()) {
    throw InputError("--set needs key=value, found '" + std::string(text) + "'");
  }
  const std::string origin = "--set " + std::string(key) + "=" + std::string(value);
  std::string why;
  const auto source = std::make_shared<const std::string>(origin);
  if (const auto node = parse_toml_value(value, {source, 0}, why)) {
    return {std::string(key), to_toml(*node), origin};
  }
  if (!is_bare_word(value)) throw InputError(origin + ": the value is not TOML: " + why);
  return {std::string(key), to_toml(value), origin};
}

void apply(const Override& override_, TomlNode& root) {
  const std::string origin = origin_text(override_);
  const std::vector<KeyStep> steps = parse_key(override_.key, origin);
  std::string why;
  const auto source = std::make_shared<const std::string>(origin);
  const auto value = parse_toml_value(override_.toml, {source, 0}, why);
  if (!value) throw InputError(origin + ": the value is not TOML: " + why);
  set(root, {steps, *value, origin}, 0);
}

}  // namespace hearsay
