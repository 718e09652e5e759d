#include "scenarios/study_parts.hpp"

#include <algorithm>

#include "scenarios/names.hpp"

namespace hearsay {
namespace {

std::string label_text(const Value& label) {
  const auto* text = std::get_if<std::string>(&label);
  return text ? *text : to_string(label);
}

}  // namespace

Value read_value(const TomlNode& node, const KeyPath& path) {
  switch (node.type) {
    case TomlNode::Type::boolean:
      return node.boolean;
    case TomlNode::Type::integer:
      return node.integer;
    case TomlNode::Type::number: {
      double number = 0.0;
      read(node, path, anything(), number);
      return number;
    }
    case TomlNode::Type::string: {
      std::string text;
      read(node, path, anything(), text);
      return text;
    }
    default:
      reject_type(node, path, "a number, string or boolean (for more, use points)");
  }
}

std::vector<Value> read_labels(const TomlNode& node, const KeyPath& path, const Study& study) {
  const auto axis = std::find_if(study.axes.begin(), study.axes.end(),
                                 [&](const Axis& a) { return a.name == node.key; });
  if (axis == study.axes.end()) {
    std::vector<std::string> names;
    for (const Axis& a : study.axes) names.push_back(a.name);
    reject(node, path, "there is no axis '" + node.key + "'" + near_or_allowed(node.key, names));
  }
  const auto label = [&](const TomlNode& given, const KeyPath& where) {
    const Value value = read_value(given, where);
    for (const AxisPoint& point : axis->points) {
      if (same_value(point.label, value)) return point.label;
    }
    std::vector<std::string> labels;
    for (const AxisPoint& point : axis->points) labels.push_back(label_text(point.label));
    reject(given, where,
           "not on axis '" + axis->name + "'" + allowed_names(label_text(value), labels));
  };
  if (node.type != TomlNode::Type::array) return {label(node, path)};
  std::vector<Value> values;
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    values.push_back(label(node.children[i], path[i]));
  }
  if (values.empty()) reject(node, path, "names no value");
  return values;
}

Where read_where(const TomlNode& node, const KeyPath& path, const Study& study) {
  expect_table(node, path);
  Where where;
  for (const TomlNode& entry : node.children) {
    where[entry.key] = read_labels(entry, path[entry.key], study);
  }
  return where;
}

}  // namespace hearsay
