// Agents filed in the cells of a square grid that has no bounds.
//
//     tiles of 4 × 4 cells,       a tile's cells, a line of the     where the cell has more agents
//     found by their numbers      cache each: up to 7 agents        than fit: further lines
//     +----+  +----+              +-------+-------+-------+---
//     |    |  | ---|------------> |a b    |       |c d … i|             +-------+
//     +----+  +----+              +-------+-------+-----|-+---          |j k    |
//     +----+                      |       |             +-------------->+-----|-+
//     |    |                      +-------+--                                 +----> …
//     +----+                      …
//
// Of a chain of lines all are full but the second, or the first if there is no other. Tiles and
// lines that are empty are used again; nothing is allocated once there are as many as the motion
// needs. An area where nobody is costs nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/kernel/ids.hpp"

namespace hearsay {

class PlaceGrid {
 public:
  /// An agent, and where in its cell it is filed: from the cell's lower corner, in units of 2^-16
  /// of its side.
  struct Filed {
    std::uint16_t x = 0;
    std::uint16_t y = 0;
    AgentId agent = no_agent;
  };
  static constexpr std::uint32_t none = (std::uint32_t{1} << 29) - 1;  // line
  static constexpr std::size_t line_room = 7;
  /// The first `count` of each array are used; arrays, and eight places, so that a compiler can
  /// look at all at once.
  struct alignas(64) Line {
    std::array<std::uint16_t, 8> x{};
    std::array<std::uint16_t, 8> y{};
    std::array<AgentId, line_room> agent{};
    std::uint32_t count : 3 = 0;
    std::uint32_t next : 29 = none;  // line
  };
  static_assert(sizeof(Line) == 64);

  /// For agents 0 … agents−1, none of which is filed.
  explicit PlaceGrid(int agents) : spots_(static_cast<std::size_t>(agents)) {}

  bool has(AgentId agent) const { return spot(agent).cell != none; }
  /// Files an agent in a cell, and nowhere else any more.
  void put(const Filed& filed, std::int64_t column, std::int64_t row);

  static constexpr std::int64_t tile_side = 4;  // cells
  static constexpr std::int64_t tile_of(std::int64_t cell) { return cell >> 2; }
  /// The cells of a tile, row by row, each the first of its lines; null if nobody is there.
  const Line* tile(std::int64_t tile_column, std::int64_t tile_row) const;
  const Line& line(std::uint32_t number) const { return lines_[number]; }

 private:
  static constexpr std::uint32_t tile_cells = tile_side * tile_side;
  struct Spot {
    std::uint32_t cell = none;  // its first line
    std::uint32_t line : 29 = none;
    std::uint32_t place : 3 = 0;  // in the line
  };
  struct Tile {  // its cells are the lines from 16 · its number on
    std::int64_t column = 0, row = 0;
    std::uint32_t agents = 0;
  };
  const Spot& spot(AgentId agent) const { return spots_[static_cast<std::size_t>(agent)]; }
  void add(const Filed& filed, std::uint32_t cell);
  void remove(const Spot& gone);
  void write(const Filed& filed, std::uint32_t line, std::uint32_t place);
  std::uint32_t take_line();
  std::uint32_t take_block();

  std::size_t bucket(std::int64_t column, std::int64_t row) const;
  std::uint32_t find(std::int64_t column, std::int64_t row) const;
  std::uint32_t take_tile(std::int64_t column, std::int64_t row);
  void free_tile(std::uint32_t tile);
  void enter(std::uint32_t tile);
  void grow_table();

  std::vector<Spot> spots_;          // by agent
  std::vector<Line> lines_;          // in blocks of 16: a tile each, or of further lines
  std::vector<Tile> tiles_;          // by block
  std::uint32_t free_block_ = none;  // its first line; linked through Line::next
  std::uint32_t free_line_ = none;
  std::vector<std::uint32_t> table_;  // tiles by hash, open addressing, at most half full
  std::size_t tiles_used_ = 0;
};

}  // namespace hearsay
