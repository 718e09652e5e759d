#include "filters/trails/identity_table.hpp"

#include <gtest/gtest.h>

#include <map>

#include "sim/kernel/error.hpp"
#include "tests/filters/trails/samples.hpp"

namespace hearsay::trails {
namespace {

TEST(IdentityTable, DoesWhatAMapDoes) {
  Stream random = stream("table");
  IdentityTable table;
  std::map<Identity, std::uint32_t> map;
  for (std::uint32_t step = 0; step < 20000; ++step) {
    const Identity identity{static_cast<RobotId>(random.below(3)),
                            static_cast<std::uint32_t>(random.below(2)),
                            static_cast<std::uint32_t>(random.below(80))};
    const auto known = map.find(identity);
    ASSERT_EQ(table.find(identity),
              known == map.end() ? std::nullopt : std::optional(known->second));
    if (known == map.end()) {
      table.insert(identity, step);
      map[identity] = step;
    } else {
      table.erase(identity);
      map.erase(known);
    }
    ASSERT_EQ(table.size(), map.size());
  }
  for (const auto& [identity, slot] : map) EXPECT_EQ(table.find(identity), slot);
  EXPECT_GT(map.size(), 100u);
}

TEST(IdentityTable, RefusesToHoldOneTwiceOrToForgetAStranger) {
  IdentityTable table;
  table.insert({1, 2, 3}, 4);
  EXPECT_THROW(table.insert({1, 2, 3}, 5), BrokenInvariant);
  EXPECT_THROW(table.erase({1, 2, 4}), BrokenInvariant);
  EXPECT_EQ(table.find({1, 2, 3}), 4u);
}

}  // namespace
}  // namespace hearsay::trails
