// Reads a study file and checks that every cell of it can be run.
#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include "scenarios/loader.hpp"
#include "scenarios/overrides.hpp"
#include "scenarios/schema.hpp"
#include "scenarios/study_parts.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr double cells_max = 1e6;

std::string cell_text(const Cell& cell) {
  std::string text;
  for (const auto& [axis, label] : cell.labels) {
    text += (text.empty() ? "" : ", ") + axis + " = " + to_string(label);
  }
  return text;
}

class StudyReader {
 public:
  StudyReader(const std::string& file, const KnownNames& names, std::span<const Override> overrides)
      : root_(read_toml_file(file)), names_(names), overrides_(overrides) {
    study_.file = file;
  }

  Study read_all() {
    static const std::vector<std::string> known = {"scenario", "name",   "title", "repetitions",
                                                   "seed",     "set",    "axes",  "skip",
                                                   "claims",   "figures"};
    expect_known_keys(root_, top_, known);
    read_scalars();
    if (const TomlNode* node = root_.find("set")) {
      const KeyPath path = top_["set"];
      expect_table(*node, path);
      collect(*node, "", "", study_.set);
    }
    study_.set.insert(study_.set.end(), overrides_.begin(), overrides_.end());
    if (const TomlNode* node = root_.find("axes")) read_axes(*node);
    check_conflicts();
    if (const TomlNode* node = root_.find("skip")) read_skips(*node);
    check_cells();
    if (const TomlNode* node = root_.find("claims")) {
      study_.claims = read_claims(*node, top_["claims"], {study_, cells_, agents_, names_});
    }
    if (const TomlNode* node = root_.find("figures")) read_figures(*node);
    return std::move(study_);
  }

 private:
  void read_scalars();
  void collect(const TomlNode& table, const std::string& prefix, const std::string& axis,
               std::vector<Override>& into) const;
  void resolve_path(TomlNode& value, const std::string& key, const std::string& table,
                    const std::string& entry) const;
  Override override_from(TomlNode value, const std::string& key, const std::string& axis) const;
  void read_axes(const TomlNode& node);
  void read_values(const TomlNode& node, const KeyPath& path, Axis& axis) const;
  void read_points(const TomlNode& node, const KeyPath& path, Axis& axis) const;
  void check_labels(const TomlNode& node, Axis& axis) const;
  void check_conflicts() const;
  void read_skips(const TomlNode& node);
  void read_figures(const TomlNode& node);
  void check_cells();
  int line_of_change(const Cell& cell, const Cell* before) const;
  [[noreturn]] void blame_cell(const TomlNode& scenario, const Cell& cell, const Cell* before,
                               const InputError& error) const;

  TomlNode root_;
  KnownNames names_;
  std::span<const Override> overrides_;
  KeyPath top_;
  Study study_;
  std::vector<Cell> cells_;
  std::vector<std::string> agents_;  // names, in the first cell
};

void StudyReader::read_scalars() {
  const TomlNode& scenario = required(root_, top_, "scenario", "a study names its scenario file");
  std::string given;
  read(scenario, top_["scenario"], anything(), given);
  const std::filesystem::path here(study_.file);
  study_.scenario_file = (here.parent_path() / given).lexically_normal().string();
  std::error_code ignored;
  if (!std::filesystem::exists(study_.scenario_file, ignored)) {
    reject(scenario, top_["scenario"], "there is no file " + study_.scenario_file);
  }
  study_.name = here.filename().string();
  for (const std::string ending : {".toml", ".study"}) {
    if (study_.name.size() > ending.size() && study_.name.ends_with(ending)) {
      study_.name.resize(study_.name.size() - ending.size());
    }
  }
  const auto field = [&](const char* key, const Allowed& allowed, auto& member) {
    if (const TomlNode* node = root_.find(key)) read(*node, top_[key], allowed, member);
  };
  field("name", anything(), study_.name);
  field("title", anything(), study_.title);
  field("repetitions", between(1, 1e6), study_.repetitions);
  field("seed", at_least(0), study_.seed);
}

Override StudyReader::override_from(TomlNode value, const std::string& key,
                                    const std::string& axis) const {
  const std::string origin = value.origin.text();
  const std::string place = axis.empty() ? origin : origin + ": axis '" + axis + "'";
  parse_key(key, place);
  if (key == "seed") {
    throw InputError(place + ": 'seed' comes from the study's own seed and the repetition");
  }
  resolve_path(value, key, "world.log", "directory");
  resolve_path(value, key, "radio", "contacts");
  resolve_path(value, key, "world.area", "heights");
  resolve_path(value, key, "world.plan", "file");
  return {key, to_toml(value), origin};
}

// A path in a study file is meant from there. It may be set alone or with the table around it.
void StudyReader::resolve_path(TomlNode& value, const std::string& key, const std::string& table,
                               const std::string& entry) const {
  TomlNode* path = key == table + "." + entry ? &value : nullptr;
  if (key == table) path = value.find(entry);
  if (!path || path->type != TomlNode::Type::string || path->text.empty()) return;
  const auto folder = std::filesystem::path(study_.file).parent_path();
  path->text = (folder / path->text).lexically_normal().string();
}

// Overrides from a table whose keys are "agents.sensor.period_s", with or without the quotes.
void StudyReader::collect(const TomlNode& table, const std::string& prefix, const std::string& axis,
                          std::vector<Override>& into) const {
  for (const TomlNode& child : table.children) {
    const std::string key = prefix + child.key;
    if (child.type == TomlNode::Type::table && !child.inline_table) {
      collect(child, key + ".", axis, into);
    } else {
      into.push_back(override_from(child, key, axis));
    }
  }
}

void StudyReader::read_axes(const TomlNode& node) {
  static const std::vector<std::string> known = {"key", "values", "points"};
  const KeyPath axes = top_["axes"];
  expect_table(node, axes);
  for (const TomlNode& table : node.children) {
    const KeyPath path = axes[table.key];
    expect_table(table, path);
    expect_known_keys(table, path, known);
    if (table.key == "agent" || table.key == "metric") {
      reject_key(table.origin, path.text(), "has another meaning in claims; take another name");
    }
    Axis axis{table.key, {}, table.origin.line};
    const bool by_values = table.find("key") || table.find("values");
    if (by_values == (table.find("points") != nullptr)) {
      reject_key(table.origin, path.text(), "needs either key and values, or points");
    }
    if (by_values) {
      read_values(table, path, axis);
    } else {
      read_points(table, path, axis);
    }
    if (axis.points.empty()) {
      throw InputError(table.origin.text() + ": axis '" + axis.name + "' has no values");
    }
    check_labels(table, axis);
    study_.axes.push_back(std::move(axis));
  }
}

void StudyReader::read_values(const TomlNode& node, const KeyPath& path, Axis& axis) const {
  const TomlNode& key_node = required(node, path, "key");
  std::string key;
  read(key_node, path["key"], anything(), key);
  parse_key(key, key_node.origin.text() + ": axis '" + axis.name + "'");
  const TomlNode& values = required(node, path, "values");
  const KeyPath values_path = path["values"];
  expect_array(values, values_path, "an array");
  for (std::size_t i = 0; i < values.children.size(); ++i) {
    const TomlNode& value = values.children[i];
    axis.points.push_back(
        {read_value(value, values_path[i]), {override_from(value, key, axis.name)}});
  }
}

void StudyReader::read_points(const TomlNode& node, const KeyPath& path, Axis& axis) const {
  static const std::vector<std::string> known = {"label", "set"};
  const TomlNode& points = *node.find("points");
  const KeyPath points_path = path["points"];
  expect_array(points, points_path, "an array of tables");
  for (std::size_t i = 0; i < points.children.size(); ++i) {
    const TomlNode& point = points.children[i];
    const KeyPath here = points_path[i];
    expect_table(point, here);
    expect_known_keys(point, here, known);
    AxisPoint result{read_value(required(point, here, "label"), here["label"]), {}};
    const TomlNode& set = required(point, here, "set");
    expect_table(set, here["set"]);
    collect(set, "", axis.name, result.set);
    axis.points.push_back(std::move(result));
  }
}

void StudyReader::check_labels(const TomlNode& node, Axis& axis) const {
  const auto is_number = [](const AxisPoint& point) {
    return std::holds_alternative<double>(point.label);
  };
  // [0, 0.1] is an axis of numbers, not of one integer and one number.
  if (std::any_of(axis.points.begin(), axis.points.end(), is_number)) {
    for (AxisPoint& point : axis.points) {
      if (const auto* integer = std::get_if<std::int64_t>(&point.label)) {
        point.label = static_cast<double>(*integer);
      }
    }
  }
  for (std::size_t i = 0; i < axis.points.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (!same_value(axis.points[i].label, axis.points[k].label)) continue;
      throw InputError(node.origin.text() + ": axis '" + axis.name + "' has the value " +
                       to_string(axis.points[i].label) + " twice");
    }
  }
}

// An axis whose settings another one wipes out would be an axis in name only.
void StudyReader::check_conflicts() const {
  struct Setting {
    std::string key;
    std::vector<KeyStep> steps;
    const Axis* axis;
  };
  std::vector<Setting> settings;
  for (const Axis& axis : study_.axes) {
    std::vector<Setting> own;
    for (const AxisPoint& point : axis.points) {
      for (const Override& override_ : point.set) {
        const bool listed = std::any_of(own.begin(), own.end(), [&](const Setting& setting) {
          return setting.key == override_.key;
        });
        if (!listed) {
          own.push_back({override_.key, parse_key(override_.key, override_.origin), &axis});
        }
      }
    }
    for (const Setting& later : own) {
      for (const Setting& earlier : settings) {
        if (!covers(later.steps, earlier.steps)) continue;
        throw InputError(study_.file, axis.line,
                         "axis '" + axis.name + "' sets '" + later.key + "', and so does axis '" +
                             earlier.axis->name + "'");
      }
    }
    settings.insert(settings.end(), own.begin(), own.end());
  }
  for (const Override& override_ : overrides_) {
    const auto steps = parse_key(override_.key, origin_text(override_));
    for (const Setting& setting : settings) {
      if (!covers(setting.steps, steps)) continue;
      throw InputError(origin_text(override_) + ": without effect; axis '" + setting.axis->name +
                       "' of " + study_.file + " sets '" + setting.key + "'");
    }
  }
}

void StudyReader::read_skips(const TomlNode& node) {
  static const std::vector<std::string> known = {"when"};
  const KeyPath path = top_["skip"];
  expect_array(node, path, "an array of tables");
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    const TomlNode& table = node.children[i];
    const KeyPath here = path[i];
    expect_table(table, here);
    expect_known_keys(table, here, known);
    const TomlNode& when = required(table, here, "when");
    if (when.type == TomlNode::Type::table && when.children.empty()) {
      reject(when, here["when"], "names no axis, so every cell would be skipped");
    }
    study_.skips.push_back({read_where(when, here["when"], study_), table.origin.line});
  }
}

void StudyReader::read_figures(const TomlNode& node) {
  static const std::vector<std::string> known = {"script", "output", "arguments"};
  const KeyPath path = top_["figures"];
  expect_array(node, path, "an array of tables");
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    const TomlNode& table = node.children[i];
    const KeyPath here = path[i];
    expect_table(table, here);
    expect_known_keys(table, here, known);
    Figure figure;
    read(required(table, here, "script"), here["script"], anything(), figure.script);
    read(required(table, here, "output"), here["output"], anything(), figure.output);
    if (const TomlNode* arguments = table.find("arguments")) {
      const KeyPath arguments_path = here["arguments"];
      expect_array(*arguments, arguments_path, "an array of strings");
      for (std::size_t k = 0; k < arguments->children.size(); ++k) {
        auto& argument = figure.arguments.emplace_back();
        read(arguments->children[k], arguments_path[k], anything(), argument);
      }
    }
    study_.figures.push_back(std::move(figure));
  }
}

void StudyReader::check_cells() {
  double count = 1.0;
  for (const Axis& axis : study_.axes) count *= static_cast<double>(axis.points.size());
  if (count > cells_max) {
    throw InputError(study_.file, root_.find("axes")->origin.line,
                     "the axes make more than 1000000 cells");
  }
  cells_ = cells(study_);
  if (cells_.empty()) {
    throw InputError(study_.file, study_.skips.front().line, "every cell is skipped");
  }
  const TomlNode scenario = read_toml_file(study_.scenario_file);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    try {
      const Scenario loaded = build_scenario(scenario, study_.scenario_file, cells_[i].set, names_);
      if (i > 0) continue;
      agents_ = agent_names(loaded);
      const bool seed_given =
          std::any_of(overrides_.begin(), overrides_.end(),
                      [](const Override& override_) { return override_.key == "seed"; });
      if (seed_given || !root_.find("seed")) study_.seed = loaded.seed;
    } catch (const InputError& error) {
      blame_cell(scenario, cells_[i], i > 0 ? &cells_[i - 1] : nullptr, error);
    }
  }
}

// Cells are tried in order, so a value that cannot be is met when its axis first turns to it.
int StudyReader::line_of_change(const Cell& cell, const Cell* before) const {
  for (std::size_t i = 0; before && i < cell.labels.size(); ++i) {
    if (!same_value(cell.labels[i].second, before->labels[i].second)) return study_.axes[i].line;
  }
  return root_.find("scenario")->origin.line;
}

void StudyReader::blame_cell(const TomlNode& scenario, const Cell& cell, const Cell* before,
                             const InputError& error) const {
  const std::string what = error.what();
  const auto begins_with = [&](const std::string& origin) {
    return what.starts_with(origin + ":");
  };
  const bool located = begins_with(study_.file) ||
                       std::any_of(overrides_.begin(), overrides_.end(),
                                   [&](const Override& o) { return begins_with(origin_text(o)); });
  if (located || cell.labels.empty()) throw error;
  try {
    build_scenario(scenario, study_.scenario_file, {}, names_);
  } catch (const InputError& own) {
    // The scenario file has this mistake without any axis.
    if (own.what() == what) throw error;
  }
  throw InputError(study_.file, line_of_change(cell, before),
                   "in the cell " + cell_text(cell) + ": " + what);
}

}  // namespace

Study load_study(const std::string& file, const KnownNames& names,
                 std::span<const Override> overrides) {
  return StudyReader(file, names, overrides).read_all();
}

}  // namespace hearsay
