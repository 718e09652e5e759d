#include "net/place_grid.hpp"

#include <algorithm>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr std::size_t table_min = 16;

// Grows by a quarter, so that little memory lies idle.
template <class T>
void grow_to(std::vector<T>* values, std::size_t size) {
  if (size > values->capacity()) {
    values->reserve(std::max(size, values->capacity() + values->capacity() / 4));
  }
  values->resize(size);
}

}  // namespace

void PlaceGrid::put(const Filed& filed, std::int64_t column, std::int64_t row) {
  const Spot old = spot(filed.agent);
  const std::int64_t tile_column = tile_of(column);
  const std::int64_t tile_row = tile_of(row);
  const auto within = static_cast<std::uint32_t>((row - tile_row * tile_side) * tile_side +
                                                 (column - tile_column * tile_side));
  if (old.cell != none) {
    const Tile& tile = tiles_[old.cell / tile_cells];
    const bool same_tile = tile.column == tile_column && tile.row == tile_row;
    if (same_tile && old.cell % tile_cells == within) {
      write(filed, old.line, old.place);
      return;
    }
    remove(old);
  }
  add(filed, tile_cells * take_tile(tile_column, tile_row) + within);
}

void PlaceGrid::add(const Filed& filed, std::uint32_t cell) {
  // The line with room is the second, or the first and only one.
  const std::uint32_t second = lines_[cell].next;
  std::uint32_t into = second == none ? cell : second;
  if (lines_[into].count == line_room) {
    into = take_line();
    lines_[into].next = lines_[cell].next;
    lines_[cell].next = into;
  }
  const std::uint32_t place = lines_[into].count++;
  spots_[static_cast<std::size_t>(filed.agent)] = {cell, into, place};
  write(filed, into, place);
  ++tiles_[cell / tile_cells].agents;
}

void PlaceGrid::remove(const Spot& gone) {
  Line& first = lines_[gone.cell];
  const std::uint32_t last = first.next == none ? gone.cell : first.next;
  const std::uint32_t place = --lines_[last].count;
  const Filed moved = {lines_[last].x[place], lines_[last].y[place], lines_[last].agent[place]};
  write(moved, gone.line, gone.place);
  Spot& spot = spots_[static_cast<std::size_t>(moved.agent)];
  spot.line = gone.line;
  spot.place = gone.place;
  if (last != gone.cell && lines_[last].count == 0) {
    first.next = lines_[last].next;
    lines_[last].next = free_line_;
    free_line_ = last;
  }
  const std::uint32_t tile = gone.cell / tile_cells;
  if (--tiles_[tile].agents == 0) free_tile(tile);
}

void PlaceGrid::write(const Filed& filed, std::uint32_t line, std::uint32_t place) {
  lines_[line].x[place] = filed.x;
  lines_[line].y[place] = filed.y;
  lines_[line].agent[place] = filed.agent;
}

std::uint32_t PlaceGrid::take_line() {
  if (free_line_ == none) {
    const std::uint32_t block = take_block();
    for (std::uint32_t i = 0; i < tile_cells; ++i) {
      lines_[tile_cells * block + i].next = free_line_;
      free_line_ = tile_cells * block + i;
    }
  }
  const std::uint32_t taken = free_line_;
  free_line_ = lines_[taken].next;
  lines_[taken].next = none;
  return taken;
}

// Sixteen empty lines.
std::uint32_t PlaceGrid::take_block() {
  if (free_block_ != none) {
    const std::uint32_t first = free_block_;
    free_block_ = lines_[first].next;
    lines_[first].next = none;
    return first / tile_cells;
  }
  const std::size_t block = tiles_.size();
  grow_to(&lines_, tile_cells * (block + 1));
  grow_to(&tiles_, block + 1);
  return static_cast<std::uint32_t>(block);
}

std::size_t PlaceGrid::bucket(std::int64_t column, std::int64_t row) const {
  std::uint64_t mixed =
      static_cast<std::uint64_t>(column) * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(row);
  mixed = (mixed ^ (mixed >> 32)) * 0xd6e8feb86659fd93ULL;
  return static_cast<std::size_t>(mixed >> 32) & (table_.size() - 1);
}

std::uint32_t PlaceGrid::find(std::int64_t column, std::int64_t row) const {
  if (table_.empty()) return none;
  for (std::size_t i = bucket(column, row); table_[i] != none; i = (i + 1) & (table_.size() - 1)) {
    const Tile& tile = tiles_[table_[i]];
    if (tile.column == column && tile.row == row) return table_[i];
  }
  return none;
}

const PlaceGrid::Line* PlaceGrid::tile(std::int64_t tile_column, std::int64_t tile_row) const {
  const std::uint32_t number = find(tile_column, tile_row);
  return number == none ? nullptr : &lines_[tile_cells * number];
}

std::uint32_t PlaceGrid::take_tile(std::int64_t column, std::int64_t row) {
  std::uint32_t tile = find(column, row);
  if (tile != none) return tile;
  if (2 * (tiles_used_ + 1) > table_.size()) grow_table();
  tile = take_block();
  tiles_[tile] = {column, row, 0};
  ++tiles_used_;
  enter(tile);
  return tile;
}

void PlaceGrid::enter(std::uint32_t tile) {
  std::size_t i = bucket(tiles_[tile].column, tiles_[tile].row);
  while (table_[i] != none) i = (i + 1) & (table_.size() - 1);
  table_[i] = tile;
}

void PlaceGrid::grow_table() {
  const std::size_t size = std::max(table_min, 2 * table_.size());
  const std::vector<std::uint32_t> old =
      std::exchange(table_, std::vector<std::uint32_t>(size, none));
  for (const std::uint32_t tile : old) {
    if (tile != none) enter(tile);
  }
}

void PlaceGrid::free_tile(std::uint32_t tile) {
  const std::size_t mask = table_.size() - 1;
  std::size_t hole = bucket(tiles_[tile].column, tiles_[tile].row);
  while (table_[hole] != tile) hole = (hole + 1) & mask;
  // What comes after moves up, unless the hole lies before its own bucket.
  for (std::size_t i = (hole + 1) & mask; table_[i] != none; i = (i + 1) & mask) {
    const Tile& other = tiles_[table_[i]];
    const std::size_t home = bucket(other.column, other.row);
    if (((i - home) & mask) < ((i - hole) & mask)) continue;
    table_[hole] = table_[i];
    hole = i;
  }
  table_[hole] = none;
  --tiles_used_;
  lines_[tile_cells * tile].next = free_block_;
  free_block_ = tile_cells * tile;
}

}  // namespace hearsay
