// What the readers of drawings share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "sim/kernel/error.hpp"
#include "sim/world/plan.hpp"

namespace hearsay::plan::parts {

inline void check_cell(double cell_m, const std::string& name) {
  if (cell_m >= cell_min_m && cell_m <= cell_max_m) return;
  throw InputError(name, 0,
                   "a cell of " + std::to_string(cell_m) + " m a side; 0.001 … 20 m are allowed");
}

inline void check_free(const Drawing& drawing, const std::string& name) {
  if (std::find(drawing.walls.begin(), drawing.walls.end(), 0) != drawing.walls.end()) return;
  throw InputError(name, 0, "all is wall; at least one cell must be free");
}

inline std::string content_of(const std::string& file, std::uintmax_t bytes_max) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError(file, 0, "no such file");
  if (!std::filesystem::is_regular_file(file, error)) throw InputError(file, 0, "not a file");
  const auto size = std::filesystem::file_size(file, error);
  if (error) throw InputError(file, 0, "cannot be read: " + error.message());
  if (size > bytes_max) {
    throw InputError(
        file, 0,
        std::to_string(size) + " bytes; at most " + std::to_string(bytes_max) + " are allowed");
  }
  std::string content(size, '\0');
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(content.data(), static_cast<std::streamsize>(size))) {
    throw InputError(file, 0, "cannot be read");
  }
  return content;
}

}  // namespace hearsay::plan::parts
