#include "net/packet.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

namespace hearsay {
namespace {

class CountedRider final : public Rider {
 public:
  int recycled = 0;

 private:
  void recycle() override { ++recycled; }
};

TEST(Fate, HasTheNamesThatAnalysisReliesOn) {
  EXPECT_STREQ(to_string(Fate::delivered), "delivered");
  EXPECT_STREQ(to_string(Fate::lost), "lost");
  EXPECT_STREQ(to_string(Fate::out_of_range), "out_of_range");
  EXPECT_STREQ(to_string(Fate::queue_full), "queue_full");
  EXPECT_STREQ(to_string(Fate::in_flight_at_end), "in_flight_at_end");
  std::set<std::string> names;
  for (int fate = 0; fate < fate_count; ++fate) names.insert(to_string(static_cast<Fate>(fate)));
  EXPECT_EQ(names.size(), static_cast<std::size_t>(fate_count));
}

TEST(RiderPtr, GivesTheRiderBackWhenTheLastLetsGo) {
  CountedRider rider;
  {
    RiderPtr a(&rider);
    const RiderPtr b = a;
    a = RiderPtr();
    EXPECT_EQ(rider.recycled, 0);
    EXPECT_EQ(a.get(), nullptr);
    EXPECT_EQ(b.get(), &rider);
  }
  EXPECT_EQ(rider.recycled, 1);
}

TEST(RiderPtr, MovesWithoutAnotherUse) {
  CountedRider rider;
  RiderPtr a(&rider);
  RiderPtr b = std::move(a);
  b = RiderPtr();
  EXPECT_EQ(rider.recycled, 1);
}

TEST(RiderPtr, SurvivesAssignmentToItself) {
  CountedRider rider;
  RiderPtr a(&rider);
  const RiderPtr& same = a;
  a = same;
  EXPECT_EQ(rider.recycled, 0);
  EXPECT_EQ(a.get(), &rider);
}

}  // namespace
}  // namespace hearsay
