// What frames do to one another where they are on the air together.
#include "net/receptions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <limits>
#include <string>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

using testing::ElementsAre;

OnAir span(std::int64_t begin_s, std::int64_t end_s) {
  return {Time::at(1_s * begin_s), Time::at(1_s * end_s)};
}

// Writes down what it is told of one radio.
class Log final : public AirListener {
 public:
  void air_taken(AgentId radio) override { lines.push_back("taken " + std::to_string(radio)); }
  void air_free(AgentId radio, bool garbled) override {
    lines.push_back((garbled ? "garbled " : "free ") + std::to_string(radio));
  }
  std::vector<std::string> lines;
};

TEST(Receptions, AFrameAloneIsHeard) {
  Receptions air(2, {}, nullptr);
  Fate fate = Fate::delivered;
  air.begin(1, fate, 0.0, span(0, 1));
  EXPECT_TRUE(air.taken(1));
  EXPECT_FALSE(air.taken(0));
  air.end(1, fate);
  EXPECT_FALSE(air.taken(1));
  EXPECT_EQ(fate, Fate::delivered);
}

TEST(Receptions, TwoFramesCollideOnlyWhereBothAreHeard) {
  Receptions air(3, {}, nullptr);
  Fate first[2] = {}, second[2] = {};
  air.begin(0, first[0], 0.0, span(0, 2));
  air.begin(1, first[1], 0.0, span(0, 2));
  air.begin(1, second[1], 0.0, span(1, 3));
  air.begin(2, second[0], 0.0, span(1, 3));
  for (const auto& [radio, fate] : {std::pair<AgentId, Fate*>{0, &first[0]}, {1, &first[1]}}) {
    air.end(radio, *fate);
  }
  air.end(1, second[1]);
  air.end(2, second[0]);
  EXPECT_EQ(first[0], Fate::delivered);
  EXPECT_EQ(first[1], Fate::collided);
  EXPECT_EQ(second[1], Fate::collided);
  EXPECT_EQ(second[0], Fate::delivered);
}

TEST(Receptions, AFrameDoesNotMeetTheOneThatEndsAsItBegins) {
  for (const bool told_first : {true, false}) {
    Receptions air(1, {}, nullptr);
    Fate early = Fate::delivered, late = Fate::delivered;
    air.begin(0, early, 0.0, span(0, 1));
    if (told_first) air.end(0, early);
    air.begin(0, late, 0.0, span(1, 2));
    if (!told_first) air.end(0, early);
    air.end(0, late);
    EXPECT_EQ(early, Fate::delivered);
    EXPECT_EQ(late, Fate::delivered);
  }
}

TEST(Receptions, AStrongerFrameSurvivesByItsRatioToEachOther) {
  const auto met = [](const std::vector<double>& powers_dbm) {
    Receptions air(1, {.capture_db = 10.0}, nullptr);
    std::vector<Fate> fates(powers_dbm.size(), Fate::delivered);
    for (std::size_t i = 0; i < fates.size(); ++i) {
      air.begin(0, fates[i], powers_dbm[i], span(0, 1));
    }
    return fates;
  };
  constexpr Fate heard = Fate::delivered, spoilt = Fate::collided;
  EXPECT_THAT(met({-50.0, -60.0}), ElementsAre(heard, spoilt));  // the ratio itself is enough
  EXPECT_THAT(met({-50.0, -59.9}), ElementsAre(spoilt, spoilt));
  EXPECT_THAT(met({-60.0, -50.0}), ElementsAre(spoilt, heard));  // the later one, too
  // In pairs: two at −60 dBm do not add up to −57 dBm.
  EXPECT_THAT(met({-60.0, -50.0, -60.0}), ElementsAre(spoilt, heard, spoilt));
  EXPECT_THAT(met({-60.0, -50.0, -55.0}), ElementsAre(spoilt, spoilt, spoilt));
}

TEST(Receptions, WhoSendsHearsNothingIfHalfDuplex) {
  for (const bool half_duplex : {true, false}) {
    Receptions air(1, {.half_duplex = half_duplex}, nullptr);
    Fate before = Fate::delivered, during = Fate::delivered, after = Fate::delivered;
    air.begin(0, before, 0.0, span(0, 2));
    air.begin_sending(0, span(1, 4));
    air.end(0, before);
    air.begin(0, during, 0.0, span(3, 5));
    air.end_sending(0);
    air.end(0, during);
    air.begin(0, after, 0.0, span(5, 6));
    air.end(0, after);
    EXPECT_EQ(before, half_duplex ? Fate::half_duplex : Fate::delivered);
    EXPECT_EQ(during, half_duplex ? Fate::half_duplex : Fate::delivered);
    EXPECT_EQ(after, Fate::delivered);
  }
}

TEST(Receptions, OfTwoFatesTheGraverStays) {
  Receptions air(1, {}, nullptr);
  Fate far = Fate::out_of_range, lost = Fate::lost, other = Fate::delivered;
  air.begin(0, far, 0.0, span(0, 4));
  air.begin(0, lost, 0.0, span(1, 4));
  EXPECT_EQ(far, Fate::out_of_range);
  EXPECT_EQ(lost, Fate::collided);
  air.begin_sending(0, span(2, 4));
  EXPECT_EQ(far, Fate::out_of_range);
  EXPECT_EQ(lost, Fate::half_duplex);
  air.begin(0, other, 0.0, span(3, 4));
  EXPECT_EQ(other, Fate::half_duplex);
}

TEST(Receptions, TheListenerHearsWhenTheAirIsTakenAndFreeAgain) {
  Log log;
  Receptions air(2, {}, &log);
  Fate a = Fate::delivered, b = Fate::delivered;
  air.begin(1, a, 0.0, span(0, 2));
  air.begin_sending(1, span(1, 4));
  air.end(1, a);
  air.begin(1, b, 0.0, span(3, 5));
  air.end_sending(1);
  EXPECT_THAT(log.lines, ElementsAre("taken 1"));
  air.end(1, b);
  EXPECT_THAT(log.lines, ElementsAre("taken 1", "free 1"));
}

TEST(Receptions, WhatCouldNotBeReadIsToldOfOnce) {
  Log log;
  Receptions air(1, {}, &log);
  Fate a = Fate::delivered, b = Fate::delivered, c = Fate::delivered;
  air.begin(0, a, 0.0, span(0, 2));
  air.begin(0, b, 0.0, span(1, 3));
  air.end(0, a);
  air.end(0, b);
  air.begin(0, c, 0.0, span(4, 5));
  air.end(0, c);
  EXPECT_THAT(log.lines, ElementsAre("taken 0", "garbled 0", "taken 0", "free 0"));
}

TEST(Receptions, ClearingTakesEverythingOffTheAir) {
  Log log;
  Receptions air(3, {}, &log);
  Fate a = Fate::delivered, b = Fate::delivered;
  air.begin(0, a, 0.0, span(0, 9));
  air.begin_sending(1, span(0, 9));
  air.clear();
  EXPECT_THAT(log.lines, ElementsAre("taken 0", "taken 1", "free 0", "free 1"));
  air.begin(0, b, 0.0, span(1, 2));
  air.begin(1, a, 0.0, span(1, 2));
  EXPECT_EQ(a, Fate::delivered);
  EXPECT_EQ(b, Fate::delivered);
}

TEST(Receptions, AnEndWithoutABeginIsABrokenInvariant) {
  Receptions air(1, {}, nullptr);
  const Fate fate = Fate::delivered;
  EXPECT_THROW(air.end(0, fate), BrokenInvariant);
  EXPECT_THROW(air.end_sending(0), BrokenInvariant);
}

// Frames at one radio, and what it sends itself, at whole seconds, so that many touch.
struct Storm {
  struct Piece {
    std::int64_t begin_s, end_s;
    double power_dbm;
    bool own;  // sent by the radio itself
  };
  std::vector<Piece> pieces;

  explicit Storm(std::uint64_t seed) {
    Stream draw(seed, Purpose("storm"), Entity{0});
    std::int64_t own_s = 0;
    for (int n = 0; n < 12; ++n) {
      const auto begin = static_cast<std::int64_t>(draw.below(40));
      const auto length = 1 + static_cast<std::int64_t>(draw.below(6));
      pieces.push_back({begin, begin + length, static_cast<double>(draw.below(30)), false});
    }
    for (int n = 0; n < 3; ++n) {
      own_s += static_cast<std::int64_t>(draw.below(12));  // often none: one after another
      const auto length = 1 + static_cast<std::int64_t>(draw.below(4));
      pieces.push_back({own_s, own_s + length, 0.0, true});
      own_s += length;
    }
  }
  static bool meet(const Piece& a, const Piece& b) {
    return a.begin_s < b.end_s && b.begin_s < a.end_s;
  }
  Fate expected(std::size_t i, double capture_db) const {
    Fate fate = Fate::delivered;
    for (std::size_t j = 0; j < pieces.size(); ++j) {
      if (j == i || !meet(pieces[i], pieces[j])) continue;
      if (pieces[j].own) return Fate::half_duplex;
      if (pieces[i].power_dbm < pieces[j].power_dbm + capture_db) fate = Fate::collided;
    }
    return fate;
  }
};

// What happens when, told in any order at one instant.
struct Event {
  std::int64_t at_s;
  std::uint64_t tie;
  std::size_t piece;
  bool begins;
};

TEST(Receptions, AStormOfFramesMeetsTheFatesOfItsOverlaps) {
  int collided = 0, half_duplex = 0, delivered = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(seed);
    const Storm storm(seed);
    const double capture_db = seed % 2 == 0 ? 8.0 : std::numeric_limits<double>::infinity();
    Stream ties(seed, Purpose("ties"), Entity{0});
    std::vector<Event> events;
    for (std::size_t i = 0; i < storm.pieces.size(); ++i) {
      events.push_back({storm.pieces[i].begin_s, ties.below(1000), i, true});
      events.push_back({storm.pieces[i].end_s, ties.below(1000), i, false});
    }
    std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
      return a.at_s != b.at_s ? a.at_s < b.at_s : a.tie < b.tie;
    });
    Log log;
    Receptions air(1, {.capture_db = capture_db}, &log);
    std::deque<Fate> fates(storm.pieces.size(), Fate::delivered);
    for (const Event& event : events) {
      const Storm::Piece& piece = storm.pieces[event.piece];
      const OnAir on_air = span(piece.begin_s, piece.end_s);
      Fate& fate = fates[event.piece];
      if (piece.own) {
        event.begins ? air.begin_sending(0, on_air) : air.end_sending(0);
      } else {
        event.begins ? air.begin(0, fate, piece.power_dbm, on_air) : air.end(0, fate);
      }
      const bool taken = !log.lines.empty() && log.lines.back() == "taken 0";
      ASSERT_EQ(air.taken(0), taken);
    }
    EXPECT_FALSE(air.taken(0));
    for (std::size_t i = 0; i < log.lines.size(); ++i) {
      EXPECT_EQ(log.lines[i] == "taken 0", i % 2 == 0) << "told twice";
    }
    for (std::size_t i = 0; i < storm.pieces.size(); ++i) {
      if (storm.pieces[i].own) continue;
      ASSERT_EQ(fates[i], storm.expected(i, capture_db)) << "frame " << i;
      collided += fates[i] == Fate::collided;
      half_duplex += fates[i] == Fate::half_duplex;
      delivered += fates[i] == Fate::delivered;
    }
  }
  EXPECT_GT(collided, 500);
  EXPECT_GT(half_duplex, 500);
  EXPECT_GT(delivered, 500);
}

}  // namespace
}  // namespace hearsay
