// Plans drawn in text.
#include <cmath>
#include <string>

#include "sim/kernel/error.hpp"
#include "sim/world/plan.hpp"
#include "sim/world/plan_parts.hpp"

namespace hearsay::plan {
namespace {

constexpr std::uintmax_t text_bytes_max = (side_max + 2) * (side_max + 1ULL);

constexpr bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

/// A character as it may stand in a message.
std::string shown(char c) {
  if (c > ' ' && c <= '~') return std::string("\"") + c + "\"";
  constexpr const char* digits = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(c);
  return std::string("byte 0x") + digits[byte / 16] + digits[byte % 16];
}

std::vector<std::string_view> lines_of(std::string_view text, const std::string& name) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    if (lines.size() == side_max) {
      throw InputError(name, side_max + 1,
                       "more than " + std::to_string(side_max) + " lines; no more are allowed");
    }
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return lines;
}

class TextReader {
 public:
  TextReader(std::string_view text, const std::string& name, double cell_m)
      : lines_(lines_of(text, name)), name_(name) {
    if (lines_.empty()) throw InputError(name, 0, "the drawing is empty");
    drawing_.columns = columns();
    drawing_.rows = static_cast<int>(lines_.size());
    drawing_.cell_m = cell_m;
    drawing_.walls.reserve(lines_.size() * lines_[0].size());
  }

  Drawing read() {
    for (int row = 0; row < drawing_.rows; ++row) {
      const int line = drawing_.rows - row;
      for (int column = 0; column < drawing_.columns; ++column) cell(line, column, row);
    }
    parts::check_free(drawing_, name_);
    return std::move(drawing_);
  }

 private:
  int columns() const {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const int line = static_cast<int>(i) + 1;
      const std::size_t length = lines_[i].size();
      if (length > side_max || length == 0) {
        throw InputError(
            name_, line,
            std::to_string(length) + " columns; 1 … " + std::to_string(side_max) + " are allowed");
      }
      if (length != lines_[0].size()) {
        throw InputError(name_, line,
                         std::to_string(length) + " columns; line 1 has " +
                             std::to_string(lines_[0].size()) + ", and all must have as many");
      }
    }
    return static_cast<int>(lines_[0].size());
  }

  void cell(int line, int column, int row) {
    const char c = lines_[static_cast<std::size_t>(line - 1)][static_cast<std::size_t>(column)];
    drawing_.walls.push_back(c == '#');
    if (c == '#' || c == ' ' || c == '.') return;
    const std::string where = "column " + std::to_string(column + 1) + ": ";
    if (!is_letter(c)) {
      throw InputError(name_, line,
                       where + "found " + shown(c) +
                           "; allowed are # (wall), space and . (free), A-Z and a-z (places)");
    }
    for (const Place& place : drawing_.places) {
      if (place.name[0] != c) continue;
      throw InputError(
          name_, line,
          where + "place " + place.name + " is also in line " +
              std::to_string(drawing_.rows - static_cast<int>(place.at.y_m / drawing_.cell_m)) +
              "; each letter is allowed once");
    }
    drawing_.places.push_back(
        {std::string(1, c), {(column + 0.5) * drawing_.cell_m, (row + 0.5) * drawing_.cell_m}});
  }

  std::vector<std::string_view> lines_;
  const std::string& name_;
  Drawing drawing_;
};

}  // namespace

Drawing parse_text(std::string_view text, const std::string& name, double cell_m) {
  parts::check_cell(cell_m, name);
  return TextReader(text, name, cell_m).read();
}

Drawing read_text(const std::string& file, double cell_m) {
  return parse_text(parts::content_of(file, text_bytes_max), file, cell_m);
}

}  // namespace hearsay::plan
