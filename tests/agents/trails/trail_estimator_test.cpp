#include "agents/trails/trail_estimator.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "sim/math/functions.hpp"
#include "tests/filters/trails/samples.hpp"

namespace hearsay {
namespace {

using trails::Crumb;
using trails::EventId;
using trails::Identity;
using trails::Laying;
using trails::Point;
using trails::point;

constexpr EventId a = 0, b = 1;
using Packets = std::vector<std::vector<std::byte>>;

/// A frame: where a point of the world is for a robot.
struct Frame {
  double rotation_rad = 0.0, x_m = 0.0, y_m = 0.0, scale = 1.0;
  Point of(double x, double y) const {
    const double c = math::cos(rotation_rad), s = math::sin(rotation_rad);
    return point(scale * (c * x - s * y) + x_m, scale * (s * x + c * y) + y_m);
  }
};
const Frame own{}, turned{2.1, -7.0, 13.0, 1.25};

TrailEstimator::Options options(trails::RobotId robot) {
  TrailEstimator::Options options;
  options.store.robot = robot;
  options.store.age_max_s = 1e6;
  return options;
}
TrailEstimator::Options relaying(trails::RobotId robot) {
  TrailEstimator::Options relay = options(robot);
  relay.relay = true;
  return relay;
}

/// Events happen at (0, 0) and (20, 0) of the world; ways lie between them on a bow.
struct World {
  double x_m, y_m;
};
World bow(double x_m) { return {x_m, 0.1 * x_m * (20.0 - x_m)}; }

void visit(TrailEstimator& robot, EventId event, const Frame& frame, double now_s) {
  robot.visit(event, frame.of(event == a ? 0.0 : 20.0, 0.0), now_s, now_s);
}
/// From A at `from_s` to B 40 s later, at half a metre a second, a step ten times a second.
void go(TrailEstimator& robot, const Frame& frame, double from_s) {
  visit(robot, a, frame, from_s);
  for (int k = 1; k < 400; ++k) {
    const World at = bow(0.05 * k);
    robot.lay(from_s + 0.1 * k, frame.of(at.x_m, at.y_m), from_s + 0.1 * k, b);
  }
  visit(robot, b, frame, from_s + 40.0);
}
Packets said(TrailEstimator& robot, double now_s) {
  const auto packets = robot.speech(now_s);
  return {packets.begin(), packets.end()};
}
std::size_t hear(TrailEstimator& robot, const Packets& packets, double now_s) {
  std::size_t crumbs = 0;
  for (const auto& packet : packets) crumbs += robot.heard(packet, now_s).size();
  return crumbs;
}
std::vector<Crumb> content(const TrailEstimator& robot) { return trails::content(robot.store()); }

/// What robots who went laid, by hand: a crumb a second from 0.1 s on, d the time since A.
void expect_bow(const std::vector<Crumb>& crumbs, const Frame& frame, double from_s) {
  ASSERT_EQ(crumbs.size(), 40U);
  for (std::size_t i = 0; i < crumbs.size(); ++i) {
    const double time_s = 0.1 + static_cast<double>(i);
    const World at = bow(0.5 * time_s);
    const Point where = frame.of(at.x_m, at.y_m);
    EXPECT_NEAR(crumbs[i].position.x_m, where.x_m, 1e-3) << i;
    EXPECT_NEAR(crumbs[i].position.y_m, where.y_m, 1e-3) << i;
    EXPECT_NEAR(crumbs[i].distance_s, time_s, 1e-5) << i;
    EXPECT_NEAR(crumbs[i].created_s, from_s + time_s, 1e-9) << i;
    EXPECT_EQ(crumbs[i].event, a) << i;
  }
}

TEST(TrailEstimator, AtOnceCrumbsLeadBackAndDIsTheTimeSinceTheLastEvent) {
  TrailEstimator robot(options(3));
  EXPECT_EQ(robot.lay(0.0, {}, 0.0, b), trails::Laid::nothing)
      << "no event yet, nothing to lead to";
  go(robot, turned, 100.0);
  expect_bow(content(robot), turned, 100.0);
  for (const Crumb& crumb : content(robot)) {
    EXPECT_EQ(crumb.goal, trails::no_event) << "it does not say";
    EXPECT_EQ(crumb.identity.robot, 3U);
  }
  EXPECT_EQ(robot.counts().laid, 40U);
  TrailEstimator::Options telling = options(3);
  telling.names_goal = true;
  TrailEstimator opposing(telling);
  go(opposing, own, 0.0);
  for (const Crumb& crumb : content(opposing)) EXPECT_EQ(crumb.goal, b);
}

TEST(TrailEstimator, ACompletedTrailCountsTheTimeToItsEvent) {
  TrailEstimator::Options completing = options(3);
  completing.laying = Laying::completed;
  TrailEstimator robot(completing);
  go(robot, own, 100.0);
  const std::vector<Crumb> crumbs = content(robot);
  ASSERT_EQ(crumbs.size(), 40U);
  for (std::size_t i = 0; i < 40; ++i) {
    const double time_s = 0.1 + static_cast<double>(i);
    EXPECT_NEAR(crumbs[i].distance_s, 40.0 - time_s, 1e-5);
    EXPECT_NEAR(crumbs[i].position.x_m, 0.5 * time_s, 1e-5);
    EXPECT_EQ(crumbs[i].event, b);
    EXPECT_EQ(crumbs[i].goal, b);
  }
  EXPECT_EQ(robot.counts().laid, 40U);
  robot.lay(141.0, {}, 141.0, a);
  robot.set_off_anew();
  EXPECT_TRUE(robot.visit(a, {}, 150.0, 150.0).empty()) << "it forgot that trail";
}

TEST(TrailEstimator, ATrailOfMoreThanLCrumbsIsAbandoned) {
  TrailEstimator::Options completing = options(3);
  completing.laying = Laying::completed;
  completing.trail_crumbs_max = 5;
  TrailEstimator robot(completing);
  std::vector<int> abandoned;
  for (int second = 0; second < 9; ++second) {
    const auto laid = robot.lay(second, point(second, 0.0), second, b);
    if (laid == trails::Laid::abandoned) abandoned.push_back(second);
  }
  EXPECT_EQ(abandoned, std::vector<int>{5}) << "the sixth";
  EXPECT_EQ(robot.counts().abandoned, 1U);
  const auto told = robot.visit(b, point(9.0, 0.0), 9.0, 9.0);
  ASSERT_EQ(told.size(), 3U) << "those of 6, 7 and 8 s";
  EXPECT_FLOAT_EQ(told.front().distance_s, 3.0F);
}

TEST(TrailEstimator, WithTwoCommonPlacesCrumbsOfAnotherFrameAreWhereTheyWereLaid) {
  for (const Laying laying : {Laying::at_once, Laying::completed}) {
    TrailEstimator::Options says = options(0);
    says.laying = laying;
    TrailEstimator sender(says), receiver(options(1));
    go(sender, turned, 100.0);
    visit(receiver, a, own, 60.0);
    visit(receiver, b, own, 120.0);
    EXPECT_EQ(hear(receiver, said(sender, 141.0), 141.0), 40U);
    EXPECT_EQ(receiver.counts().heard, 40U);
    EXPECT_EQ(receiver.counts().no_frame, 0U);
    if (laying == Laying::at_once) expect_bow(content(receiver), own, 100.0);
    for (const Crumb& crumb : content(receiver)) {
      const World at = bow(0.5 * (crumb.created_s - 100.0));
      EXPECT_NEAR(crumb.position.x_m, at.x_m, 1e-3);
      EXPECT_NEAR(crumb.position.y_m, at.y_m, 1e-3);
    }
    // And back, into the frame that is turned and larger.
    go(receiver, own, 200.0);
    EXPECT_EQ(hear(sender, said(receiver, 241.0), 241.0), 40U);
    for (const Crumb& crumb : content(sender)) {
      if (crumb.identity.robot != 1) continue;
      const World at = bow(0.5 * (crumb.created_s - 200.0));
      const Point where = turned.of(at.x_m, at.y_m);
      EXPECT_NEAR(crumb.position.x_m, where.x_m, 1e-3);
      EXPECT_NEAR(crumb.position.y_m, where.y_m, 1e-3);
    }
  }
}

TEST(TrailEstimator, WithFewerPlacesThePessimistTakesNothingAndTheOptimistTranslates) {
  for (const int common : {0, 1}) {
    TrailEstimator::Options hopes = options(2);
    hopes.align.optimistic = true;
    TrailEstimator sender(options(0)), pessimist(options(1)), optimist(hopes);
    go(sender, turned, 100.0);
    if (common == 1) {
      for (TrailEstimator* robot : {&pessimist, &optimist}) visit(*robot, a, own, 50.0);
    }
    const Packets packets = said(sender, 141.0);
    EXPECT_EQ(hear(pessimist, packets, 141.0), 0U);
    EXPECT_EQ(pessimist.counts().no_frame, packets.size());
    EXPECT_EQ(pessimist.counts().heard, 0U);
    EXPECT_EQ(pessimist.store().size(), 0U);
    EXPECT_EQ(pessimist.store().places().size(), static_cast<std::size_t>(common));
    // A of the sender comes to lie on A of the receiver: own (0, 0). Nothing turns or shrinks.
    Frame moved = turned;
    if (common == 1) moved.x_m = moved.y_m = 0.0;
    EXPECT_EQ(hear(optimist, packets, 141.0), 40U);
    EXPECT_EQ(optimist.counts().no_frame, 0U);
    expect_bow(content(optimist), moved, 100.0);
  }
}

TEST(TrailEstimator, AsIsTakesOverWhatItHears) {
  TrailEstimator::Options copies = options(1);
  copies.as_is = true;
  TrailEstimator sender(options(0)), receiver(copies);
  go(sender, turned, 100.0);
  visit(receiver, a, own, 60.0);
  visit(receiver, b, own, 120.0);
  hear(receiver, said(sender, 141.0), 141.0);
  EXPECT_EQ(content(receiver), content(sender));
  EXPECT_EQ(*receiver.store().place(b), *sender.store().place(b)) << "the later one";
}

/// Who knows both places, in a frame.
TrailEstimator guide(const TrailEstimator::Options& options, const Frame& frame) {
  TrailEstimator robot(options);
  visit(robot, a, frame, 10.0);
  visit(robot, b, frame, 60.0);
  robot.speech(60.0);  // its places are told
  return robot;
}

TEST(TrailEstimator, OneCrumbHeardTwiceOrOverARelayIsOneCrumb) {
  const Frame third{-0.7, 3.0, 4.0, 0.8};
  for (const bool relays : {true, false}) {
    TrailEstimator sender(options(0));
    TrailEstimator relay = guide(relays ? relaying(1) : options(1), third);
    TrailEstimator near = guide(options(2), own), far = guide(options(3), own);
    go(sender, turned, 100.0);
    const Packets first = said(sender, 141.0);
    EXPECT_EQ(hear(near, first, 141.0), 40U);
    EXPECT_EQ(hear(near, first, 142.0), 0U) << "again";
    EXPECT_EQ(hear(relay, first, 142.0), 40U);
    const Packets passed_on = said(relay, 143.0);
    EXPECT_EQ(hear(near, passed_on, 143.0), 0U);
    EXPECT_EQ(hear(far, passed_on, 143.0), relays ? 40U : 0U);
    EXPECT_EQ(near.store().counts().known, relays ? 80U : 40U);
    expect_bow(content(near), own, 100.0);
    if (relays) expect_bow(content(far), own, 100.0);
    EXPECT_TRUE(said(relay, 144.0).empty()) << "it has said so once";
    EXPECT_EQ(passed_on.empty(), !relays);
  }
}

TEST(TrailEstimator, WhatIsNewIsToldOnceWithAllPlaces) {
  TrailEstimator sender(options(0)), receiver = guide(options(1), own);
  EXPECT_TRUE(said(sender, 0.0).empty());
  visit(sender, a, own, 1.0);
  EXPECT_EQ(said(sender, 1.0).size(), 1U) << "a place is news";
  EXPECT_TRUE(said(sender, 1.0).empty());
  visit(sender, b, own, 2.0);
  std::size_t crumbs = 0;
  for (int second = 3; second < 20; ++second) {
    sender.lay(second, point(second, 0.0), second, a);
    const Packets packets = said(sender, second);
    ASSERT_EQ(packets.size(), 1U);
    EXPECT_EQ(trails::MetricPacket::parse(packets[0])->crumbs(), 1U)
        << "LOST 2002: {places, crumb}";
    EXPECT_EQ(trails::MetricPacket::parse(packets[0])->places(), 2U);
    crumbs += hear(receiver, packets, 100.0);
  }
  EXPECT_EQ(crumbs, 17U);
}

TEST(TrailEstimator, WhoForgetsGetsItsOwnCrumbsBackFromOthers) {
  TrailEstimator forgetful(options(0)), friendly = guide(relaying(1), turned);
  go(forgetful, own, 100.0);
  EXPECT_EQ(hear(friendly, said(forgetful, 141.0), 141.0), 40U);
  forgetful.forget();
  EXPECT_EQ(forgetful.store().size(), 0U);
  EXPECT_TRUE(forgetful.store().places().empty());
  EXPECT_TRUE(said(forgetful, 142.0).empty());
  EXPECT_EQ(forgetful.lay(143.0, {}, 143.0, a), trails::Laid::nothing) << "it knows no event";
  const Packets back = said(friendly, 144.0);
  EXPECT_EQ(hear(forgetful, back, 144.0), 0U) << "it knows no place";
  EXPECT_EQ(forgetful.counts().no_frame, back.size());
  visit(forgetful, a, own, 150.0);
  visit(forgetful, b, own, 200.0);
  EXPECT_EQ(hear(forgetful, back, 200.0), 40U);
  expect_bow(content(forgetful), own, 100.0);
  // What it lays anew is not taken for what it laid before.
  go(forgetful, own, 300.0);
  EXPECT_EQ(forgetful.store().size(), 80U);
  visit(friendly, a, turned, 330.0);
  EXPECT_EQ(hear(friendly, said(forgetful, 341.0), 341.0), 40U);
  EXPECT_EQ(friendly.store().size(), 80U);
}

TEST(TrailEstimator, WhoIsCarriedElsewhereLaysNoWayBackFromThere) {
  TrailEstimator robot(options(0));
  go(robot, own, 0.0);
  EXPECT_EQ(robot.lay(41.0, {}, 41.0, a), trails::Laid::crumb);
  robot.carried();
  for (int second = 42; second < 50; ++second) {
    EXPECT_EQ(robot.lay(second, {}, second, a), trails::Laid::nothing);
  }
  EXPECT_EQ(robot.store().size(), 41U) << "what it knows stays";
  visit(robot, a, own, 50.0);
  EXPECT_EQ(robot.lay(51.0, {}, 51.0, b), trails::Laid::crumb);
  EXPECT_FLOAT_EQ(robot.laid().distance_s, 1.0F);
  EXPECT_EQ(robot.laid().event, a);
}

TEST(TrailEstimator, WhatIsNoPacketIsRefusedAndCounted) {
  TrailEstimator sender(options(0)), receiver = guide(options(1), own);
  go(sender, turned, 100.0);
  const Packets packets = said(sender, 141.0);
  ASSERT_FALSE(packets.empty());
  std::uint64_t refused = 0;
  for (const std::size_t size : {std::size_t{0}, std::size_t{7}, packets[0].size() - 1}) {
    EXPECT_TRUE(receiver.heard(std::span(packets[0]).first(size), 141.0).empty());
    EXPECT_EQ(receiver.counts().refused, ++refused);
  }
  std::vector<std::byte> longer = packets[0];
  longer.push_back(std::byte{0});
  EXPECT_TRUE(receiver.heard(longer, 141.0).empty());
  EXPECT_EQ(receiver.counts().refused, ++refused);
  EXPECT_EQ(receiver.store().size(), 0U);
  EXPECT_EQ(receiver.counts().heard, 0U);
  EXPECT_EQ(hear(receiver, packets, 141.0), 40U) << "and what is one is not";
  EXPECT_EQ(receiver.counts().refused, refused);
}

TEST(TrailEstimator, PacketsKeepToTheirBytes) {
  for (const std::size_t bytes : {200U, 457U, 1400U, 65000U}) {
    TrailEstimator::Options small = options(0);
    small.packet_bytes = bytes;
    TrailEstimator sender(small), receiver = guide(options(1), own);
    go(sender, own, 100.0);
    const Packets packets = said(sender, 141.0);
    std::size_t all = 0;
    for (const auto& packet : packets) {
      EXPECT_LE(packet.size(), bytes);
      all += packet.size();
    }
    // 40 bytes a crumb, 32 a place (in each packet), and a head.
    EXPECT_GE(all, 40U * 40U + packets.size() * 64U);
    EXPECT_EQ(hear(receiver, packets, 141.0), 40U);
  }
}

/// A trail in packets of about 8 crumbs, told in three messages.
Packets trail_in_pieces() {
  TrailEstimator::Options small = options(0);
  small.packet_bytes = 440;
  TrailEstimator sender(small);
  visit(sender, a, turned, 90.0);
  visit(sender, b, turned, 100.0);
  Packets all;
  for (int second = 1; second <= 60; ++second) {
    const World at = bow(second / 3.0);
    sender.lay(100.0 + second, turned.of(at.x_m, at.y_m), 100.0 + second, a);
    if (second % 20 != 0) continue;
    for (auto& packet : said(sender, 100.0 + second)) all.push_back(std::move(packet));
  }
  return all;
}

TEST(TrailEstimator, ATrailIsTheSameInWhateverOrderAndHoweverOftenItsPacketsCome) {
  const Packets packets = trail_in_pieces();
  ASSERT_GE(packets.size(), 7U);
  TrailEstimator orderly = guide(options(1), own);
  EXPECT_EQ(hear(orderly, packets, 200.0), 60U);
  const std::vector<Crumb> expected = content(orderly);
  Stream random = trails::stream("order of packets");
  for (int trial = 0; trial < 200; ++trial) {
    Packets mixed = packets;
    for (std::uint64_t more = random.below(6); more > 0; --more) {
      mixed.push_back(packets[random.below(packets.size())]);
    }
    trails::shuffle(mixed, random);
    TrailEstimator receiver = guide(relaying(1), own);
    // Half of what comes goes over a relay, in batches of its own.
    TrailEstimator relay = guide(relaying(2), Frame{0.3, 1.0, 2.0, 1.1});
    for (const auto& packet : mixed) {
      hear(random.bernoulli(0.5) ? receiver : relay, {packet}, 200.0);
      if (random.bernoulli(0.3)) hear(receiver, said(relay, 200.0), 200.0);
    }
    hear(receiver, said(relay, 200.0), 200.0);
    const std::vector<Crumb> got = content(receiver);
    ASSERT_EQ(got.size(), expected.size()) << trial;
    for (std::size_t i = 0; i < got.size(); ++i) {
      Crumb there = got[i];
      ASSERT_NEAR(there.position.x_m, expected[i].position.x_m, 1e-3);
      ASSERT_NEAR(there.position.y_m, expected[i].position.y_m, 1e-3);
      there.position = expected[i].position;
      ASSERT_EQ(there, expected[i]) << "but for roundings on the way";
    }
  }
}

TEST(TrailEstimator, InOneFrameItIsTheVerySameTrail) {
  TrailEstimator::Options copies = options(1);
  copies.as_is = true;
  const Packets packets = trail_in_pieces();
  TrailEstimator orderly = guide(copies, own);
  hear(orderly, packets, 200.0);
  Stream random = trails::stream("direct packets");
  for (int trial = 0; trial < 100; ++trial) {
    Packets mixed = packets;
    mixed.insert(mixed.end(), packets.begin(), packets.end());
    trails::shuffle(mixed, random);
    TrailEstimator receiver = guide(copies, own);
    EXPECT_EQ(hear(receiver, mixed, 200.0), 60U);
    ASSERT_EQ(content(receiver), content(orderly)) << trial;
  }
}

}  // namespace
}  // namespace hearsay
