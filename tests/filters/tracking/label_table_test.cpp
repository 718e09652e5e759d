// What a label table does with messages, one after the other.
#include "filters/tracking/label_table.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "sim/kernel/error.hpp"

namespace hearsay::tracking {
namespace {

using Verdict = LabelTable::Verdict;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t peer = 7;

Table table(std::initializer_list<std::initializer_list<double>> rows) {
  Table t(static_cast<int>(rows.size()), static_cast<int>(rows.begin()->size()));
  int i = 0;
  for (const auto& row : rows) {
    int j = 0;
    for (const double value : row) t(i, j++) = value;
    ++i;
  }
  return t;
}

const std::vector<Label> theirs{100, 200};
const std::vector<Label> mine{1, 2};

TEST(LabelTable, PairsWhatLiesWithinTheGate) {
  LabelTable labels({});
  const auto decisions = labels.judge(peer, theirs, mine, table({{20, 1}, {2, 20}}));
  EXPECT_EQ(decisions[0].verdict, Verdict::same);
  EXPECT_EQ(decisions[0].mine, 1);
  EXPECT_EQ(decisions[1].mine, 0);
  EXPECT_EQ(labels.mine_of(peer, 100), 2u);
  EXPECT_EQ(labels.mine_of(peer, 200), 1u);
  EXPECT_FALSE(labels.mine_of(8, 100));
}

TEST(LabelTable, WhatIsFarFromAllIsNews) {
  LabelTable labels({});
  const auto decisions = labels.judge(peer, theirs, mine, table({{1, 20}, {20, 20}}));
  EXPECT_EQ(decisions[1].verdict, Verdict::news);
  EXPECT_EQ(labels.size(), 1u);
  labels.add(peer, 200, 3);
  EXPECT_EQ(labels.mine_of(peer, 200), 3u);
}

// Even where the other one has come nearer: that is what the table is for.
TEST(LabelTable, APairStays) {
  LabelTable labels({});
  labels.judge(peer, theirs, mine, table({{1, 20}, {20, 1}}));
  const auto decisions = labels.judge(peer, theirs, mine, table({{8, 1}, {1, 8}}));
  EXPECT_EQ(decisions[0].verdict, Verdict::same);
  EXPECT_EQ(decisions[0].mine, 0);
  EXPECT_EQ(decisions[1].mine, 1);
}

TEST(LabelTable, APairBreaksAfterSoManyMessagesApartInARow) {
  LabelTable labels({.apart_max = 3});
  const auto hear = [&](double d2) {
    return labels.judge(peer, std::vector<Label>{100}, std::vector<Label>{1}, table({{d2}}))[0];
  };
  EXPECT_EQ(hear(1).verdict, Verdict::same);
  EXPECT_EQ(hear(10).verdict, Verdict::apart);
  EXPECT_EQ(hear(10).verdict, Verdict::apart);
  EXPECT_EQ(hear(1).verdict, Verdict::same);  // counts anew from here
  EXPECT_EQ(hear(10).verdict, Verdict::apart);
  EXPECT_EQ(hear(infinity).verdict, Verdict::apart);
  EXPECT_EQ(hear(10).verdict, Verdict::news);
  EXPECT_EQ(labels.broken(), 1u);
  EXPECT_EQ(labels.size(), 0u);
}

TEST(LabelTable, ABrokenPairMayFindOthersAtOnce) {
  LabelTable labels({.apart_max = 1});
  labels.judge(peer, theirs, mine, table({{1, 20}, {20, 1}}));
  const auto decisions = labels.judge(peer, theirs, mine, table({{20, 1}, {1, 20}}));
  EXPECT_EQ(labels.broken(), 2u);
  EXPECT_EQ(decisions[0].mine, 1);
  EXPECT_EQ(decisions[1].mine, 0);
}

// Two tracks of the other near one of mine: the second is news, not a second partner.
TEST(LabelTable, ATrackHasOnePartnerOfEachAgent) {
  LabelTable labels({});
  const auto decisions = labels.judge(peer, theirs, std::vector<Label>{1}, table({{2}, {1}}));
  EXPECT_EQ(decisions[0].verdict, Verdict::news);
  EXPECT_EQ(decisions[1].verdict, Verdict::same);
  // Another agent's tracks are no concern of it.
  const auto other = labels.judge(8, std::vector<Label>{5}, std::vector<Label>{1}, table({{1}}));
  EXPECT_EQ(other[0].verdict, Verdict::same);
}

TEST(LabelTable, WhatIGaveUpIsNoNewsButMayBeFoundAgain) {
  LabelTable labels({});
  labels.judge(peer, theirs, mine, table({{1, 20}, {20, 1}}));
  labels.ended(1, true);
  const std::vector<Label> left{2};
  EXPECT_EQ(labels.judge(peer, theirs, left, table({{20}, {1}}))[0].verdict, Verdict::buried);
  EXPECT_FALSE(labels.mine_of(peer, 100));
  // I saw it again myself, as number 3.
  const std::vector<Label> again{2, 3};
  const auto decision = labels.judge(peer, theirs, again, table({{20, 1}, {1, 20}}))[0];
  EXPECT_EQ(decision.verdict, Verdict::same);
  EXPECT_EQ(labels.mine_of(peer, 100), 3u);
}

TEST(LabelTable, WhatEndedForWantOfNewsIsNewsAgain) {
  LabelTable labels({});
  labels.judge(peer, theirs, mine, table({{1, 20}, {20, 1}}));
  labels.ended(1, false);
  const auto decisions = labels.judge(peer, theirs, std::vector<Label>{2}, table({{20}, {1}}));
  EXPECT_EQ(decisions[0].verdict, Verdict::news);
}

TEST(LabelTable, HoldsNoMoreThanTheLastMessageOfEach) {
  LabelTable labels({});
  for (Label label = 0; label < 1000; ++label) {
    labels.judge(peer, std::vector<Label>{label}, std::vector<Label>{1}, table({{1}}));
    EXPECT_EQ(labels.size(), 1u);
  }
  labels.judge(8, theirs, mine, table({{1, 20}, {20, 1}}));
  EXPECT_EQ(labels.size(), 3u);
  labels.forget(8);
  EXPECT_EQ(labels.size(), 1u);
}

TEST(LabelTable, RefusesTablesOfAnotherSize) {
  LabelTable labels({});
  EXPECT_THROW(labels.judge(peer, theirs, mine, Table(1, 2)), BrokenInvariant);
  EXPECT_THROW(LabelTable({.apart_max = 0}), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::tracking
