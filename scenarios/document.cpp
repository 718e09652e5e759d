#include "scenarios/document.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using Source = std::shared_ptr<const std::string>;

int line_of(const toml::source_region& region) { return static_cast<int>(region.begin.line); }

template <class Date>
std::string date_text(const Date& date) {
  std::ostringstream out;
  out << date;
  return out.str();
}

// `with_lines` is false for values that did not come from a file.
TomlNode convert(const toml::node& node, const Source& source, bool with_lines);

void convert_table(const toml::table& table, const Source& source, bool with_lines,
                   TomlNode& into) {
  struct Entry {
    const toml::key* key;
    const toml::node* value;
  };
  std::vector<Entry> entries;
  for (auto&& [key, value] : table) entries.push_back({&key, &value});
  // The library keeps entries sorted by name; the order of the file is what people mean.
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    const auto& pa = a.key->source().begin;
    const auto& pb = b.key->source().begin;
    return std::pair(pa.line, pa.column) < std::pair(pb.line, pb.column);
  });
  for (const Entry& entry : entries) {
    TomlNode child = convert(*entry.value, source, with_lines);
    child.key = std::string(entry.key->str());
    if (with_lines) child.origin.line = line_of(entry.key->source());
    into.children.push_back(std::move(child));
  }
}

TomlNode convert(const toml::node& node, const Source& source, bool with_lines) {
  TomlNode result;
  result.origin = {source, with_lines ? line_of(node.source()) : 0};
  if (const auto* table = node.as_table()) {
    result.type = TomlNode::Type::table;
    result.inline_table = table->is_inline();
    convert_table(*table, source, with_lines, result);
  } else if (const auto* array = node.as_array()) {
    result.type = TomlNode::Type::array;
    for (const toml::node& element : *array) {
      result.children.push_back(convert(element, source, with_lines));
    }
  } else if (const auto* boolean = node.as_boolean()) {
    result.type = TomlNode::Type::boolean;
    result.boolean = boolean->get();
  } else if (const auto* integer = node.as_integer()) {
    result.type = TomlNode::Type::integer;
    result.integer = integer->get();
  } else if (const auto* number = node.as_floating_point()) {
    result.type = TomlNode::Type::number;
    result.number = number->get();
  } else if (const auto* string = node.as_string()) {
    result.type = TomlNode::Type::string;
    result.text = string->get();
  } else {
    result.type = TomlNode::Type::date;
    if (const auto* date = node.as_date()) result.text = date_text(date->get());
    if (const auto* time = node.as_time()) result.text = date_text(time->get());
    if (const auto* both = node.as_date_time()) result.text = date_text(both->get());
  }
  return result;
}

std::string read_text(const std::string& file) {
  // A directory opens, too, and fails only when it is read.
  std::ifstream in(file, std::ios::binary);
  std::string content;
  std::array<char, 4096> block;
  while (in) {
    in.read(block.data(), block.size());
    content.append(block.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (!in.eof()) throw InputError(file, 0, "cannot be read");
  return content;
}

bool is_bare_key(std::string_view key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
}

}  // namespace

std::string TextOrigin::text() const {
  if (!source) return "?";
  return line > 0 ? *source + ":" + std::to_string(line) : *source;
}

const TomlNode* TomlNode::find(std::string_view name) const {
  if (type != Type::table) return nullptr;
  const auto at = std::find_if(children.begin(), children.end(),
                               [&](const TomlNode& child) { return child.key == name; });
  return at == children.end() ? nullptr : &*at;
}

TomlNode* TomlNode::find(std::string_view name) {
  return const_cast<TomlNode*>(std::as_const(*this).find(name));
}

void TomlNode::put(TomlNode value) {
  if (TomlNode* old = find(value.key)) {
    *old = std::move(value);
  } else {
    children.push_back(std::move(value));
  }
}

TomlNode read_toml_file(const std::string& file) {
  const std::string content = read_text(file);
  const auto source = std::make_shared<const std::string>(file);
  try {
    TomlNode root = convert(toml::parse(content, file), source, true);
    root.origin.line = 0;
    return root;
  } catch (const toml::parse_error& error) {
    throw InputError(file, line_of(error.source()), std::string(error.description()));
  }
}

std::optional<TomlNode> parse_toml_value(std::string_view text, const TextOrigin& origin,
                                         std::string& why) {
  try {
    const toml::table table = toml::parse("value = " + std::string(text));
    const toml::node* value = table.get("value");
    if (table.size() == 1 && value != nullptr) {
      TomlNode node = convert(*value, origin.source, false);
      node.origin = origin;
      return node;
    }
    why = "more than one value";
  } catch (const toml::parse_error& error) {
    why = std::string(error.description());
  }
  return std::nullopt;
}

std::string to_toml(double number) {
  if (std::isnan(number)) return "nan";
  if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr;
  std::string text(buffer.data(), end);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string to_toml(std::string_view string) {
  static constexpr char hex[] = "0123456789ABCDEF";
  std::string text = "\"";
  for (const char c : string) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      text += {'\\', c};
    } else if (byte < 0x20 || byte == 0x7f) {
      text += {'\\', 'u', '0', '0', hex[byte >> 4], hex[byte & 15]};
    } else {
      text += c;
    }
  }
  return text + '"';
}

std::string shortened(std::string text) {
  constexpr std::size_t longest = 80;
  if (text.size() <= longest) return text;
  std::size_t cut = longest;
  while (cut > 0 && (static_cast<unsigned char>(text[cut]) & 0xC0) == 0x80) --cut;
  return text.substr(0, cut) + "…";
}

std::string to_toml(const TomlNode& node) {
  using Type = TomlNode::Type;
  switch (node.type) {
    case Type::boolean:
      return node.boolean ? "true" : "false";
    case Type::integer:
      return std::to_string(node.integer);
    case Type::number:
      return to_toml(node.number);
    case Type::string:
      return to_toml(std::string_view(node.text));
    case Type::date:
      return node.text;
    case Type::array:
    case Type::table:
      break;
  }
  const bool table = node.type == Type::table;
  std::string text;
  for (const TomlNode& child : node.children) {
    if (!text.empty()) text += ", ";
    if (table) text += (is_bare_key(child.key) ? child.key : to_toml(std::string_view(child.key)));
    if (table) text += " = ";
    text += to_toml(child);
  }
  if (!table) return "[" + text + "]";
  return text.empty() ? "{}" : "{ " + text + " }";
}

}  // namespace hearsay
