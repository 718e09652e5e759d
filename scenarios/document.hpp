// A TOML document as a tree of plain nodes that remember where they were written.
//
// The TOML library is seen by document.cpp alone; everything else reads these nodes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hearsay {

/// Where something was written: a line of a file, or an option ("--set a=1"; then line is 0).
struct TextOrigin {
  std::shared_ptr<const std::string> source;
  int line = 0;
  /// "ring.toml:12", or the source alone.
  std::string text() const;
};

struct TomlNode {
  enum class Type { boolean, integer, number, string, date, array, table };
  Type type = Type::table;
  TextOrigin origin;  ///< of the key; for an element of an array, of the element
  std::string key;    ///< name in the parent table; empty in an array
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0.0;
  std::string text;                ///< of a string; a date as written
  bool inline_table = false;       ///< written as { … }
  std::vector<TomlNode> children;  ///< elements of an array; entries of a table in file order

  /// The entry `name` of a table, or null.
  const TomlNode* find(std::string_view name) const;
  TomlNode* find(std::string_view name);
  /// Replaces or appends the entry `value.key`.
  void put(TomlNode value);
};

/// Reads and parses a file. @throws InputError if it cannot be read or is not TOML (with the line).
TomlNode read_toml_file(const std::string& file);

/// One TOML value ("0.1", "[1, 2]"). Nothing if `text` is not one, with the reason in `why`.
std::optional<TomlNode> parse_toml_value(std::string_view text, const TextOrigin& origin,
                                         std::string& why);

/// The value as TOML on one line, such that reading it gives the same value.
std::string to_toml(const TomlNode& node);
std::string to_toml(double number);
std::string to_toml(std::string_view string);

/// For messages: the text, or its first 80 bytes, cut between characters, and "…".
std::string shortened(std::string text);

}  // namespace hearsay
