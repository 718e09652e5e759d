#include "net/place_grid.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "sim/kernel/random.hpp"
#include "tools/memory/memory.hpp"

namespace hearsay {
namespace {

using CellNumber = std::pair<std::int64_t, std::int64_t>;
using Content = std::set<std::tuple<AgentId, int, int>>;

// Also checks how full lines are.
Content content(const PlaceGrid& grid, const CellNumber& cell) {
  Content all;
  const auto [column, row] = cell;
  const auto* tile = grid.tile(PlaceGrid::tile_of(column), PlaceGrid::tile_of(row));
  if (tile == nullptr) return all;
  const PlaceGrid::Line* line = &tile[(row & 3) * 4 + (column & 3)];
  for (int n = 0;; ++n) {
    const bool last = line->next == PlaceGrid::none;
    const bool may_have_room = n == 1 || (n == 0 && last);
    EXPECT_TRUE(may_have_room || line->count == PlaceGrid::line_room) << n;
    EXPECT_TRUE(n == 0 || line->count > 0) << n;
    for (std::uint32_t i = 0; i < line->count; ++i) {
      EXPECT_TRUE(all.insert({line->agent[i], line->x[i], line->y[i]}).second);
    }
    if (last) return all;
    line = &grid.line(line->next);
  }
}

TEST(PlaceGrid, HoldsEachAgentOnceWhereItWasPutLast) {
  constexpr int agents = 200;
  PlaceGrid grid(agents);
  std::map<CellNumber, Content> expected;
  std::map<AgentId, CellNumber> where;
  Stream stream(1, Purpose("grid"), Entity::agent(0));
  const auto draw = [&](std::uint64_t n) { return static_cast<std::int64_t>(stream.below(n)); };
  for (int step = 0; step < 40'000; ++step) {
    const auto agent = static_cast<AgentId>(draw(agents));
    // Times of crowds in few cells, and of a wide spread about the origin and far from it.
    const std::uint64_t width = step / 2000 % 2 == 0 ? 3 : 40;
    const std::int64_t far = step / 4000 % 3 == 2 ? 10'000'000'000'000 : 0;
    const CellNumber cell = {draw(width) - static_cast<std::int64_t>(width) / 2 - far,
                             draw(width) - static_cast<std::int64_t>(width) / 2 + far};
    const PlaceGrid::Filed filed = {static_cast<std::uint16_t>(draw(65536)),
                                    static_cast<std::uint16_t>(draw(65536)), agent};
    grid.put(filed, cell.first, cell.second);
    if (const auto old = where.find(agent); old != where.end()) {
      Content& left = expected[old->second];
      std::erase_if(left, [&](const auto& entry) { return std::get<0>(entry) == agent; });
      ASSERT_EQ(content(grid, old->second).size(), left.size() + (old->second == cell));
    }
    where[agent] = cell;
    expected[cell].insert({agent, filed.x, filed.y});
    ASSERT_EQ(content(grid, cell), expected[cell]) << step;
    if (step % 1000 != 0) continue;
    for (const auto& [number, all] : expected) ASSERT_EQ(content(grid, number), all);
  }
}

TEST(PlaceGrid, GivesUpWhatIsEmpty) {
  // A hundred agents that wander off together for ever.
  PlaceGrid grid(100);
  std::size_t bytes = 0;
  for (std::int64_t step = 0; step < 20'000; ++step) {
    const auto agent = static_cast<AgentId>(step % 100);
    grid.put({.agent = agent}, step * 7, -step * 3 + agent);
    if (step == 1000) bytes = memory::bytes_held();
  }
  EXPECT_EQ(memory::bytes_held(), bytes);
  EXPECT_EQ(grid.tile(0, 0), nullptr);
}

TEST(PlaceGrid, IsEmptyAtFirst) {
  const PlaceGrid grid(3);
  EXPECT_FALSE(grid.has(2));
  EXPECT_EQ(grid.tile(0, 0), nullptr);
}

}  // namespace
}  // namespace hearsay
