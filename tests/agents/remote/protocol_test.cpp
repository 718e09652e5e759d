// Orders and answers as bytes: what is packed comes back, and bytes that are none do no harm.
#include "agents/remote/protocol.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

#include "sim/kernel/random.hpp"

namespace hearsay::remote {
namespace {

using Bytes = std::vector<std::byte>;

gaussian::Belief belief(int n) {
  gaussian::Belief some = gaussian::Belief::unknown(n);
  for (int i = 0; i < n; ++i) {
    some.xi(i) = 1.5 * i - 2.0;
    some.omega(i, i) = 3.0 + i;
  }
  return some;
}

Ledger ledger() {
  Ledger some;
  for (const std::size_t index : {0u, 3u, 4u}) some.measured(index);
  return some;
}

Order full_order() {
  Order order{.kind = OrderKind::packet, .now = Time::nanoseconds(123456789012)};
  order.surroundings = {.up = false,
                        .hears_strangers = true,
                        .waiting = 7,
                        .position_m = Point{1.0, -2.0, 3.5},
                        .neighbours = std::vector<AgentId>{3, 1, 4}};
  order.measured_at = {{1, 2, 3}, {}, {-5}};
  order.measurement = {.subject = 2, .information = belief(4), .index = 99};
  order.message_kind = "gaussian";
  order.sender = 3;
  order.receiver = 1;
  order.sent = Time::nanoseconds(-1);
  order.bytes = Bytes(37, std::byte{0xa5});
  order.rider = Bytes(5, std::byte{1});
  order.yes = true;
  order.lives = 2;
  order.stamp = std::numeric_limits<std::int64_t>::min();
  order.value = -0.25;
  order.content = Bytes(11, std::byte{9});
  order.number = 12;
  return order;
}

Answer full_answer() {
  Answer answer{.kind = AnswerKind::send};
  answer.notes = Bytes(9, std::byte{8});
  answer.plans = {{.event = 5, .time = Time::nanoseconds(8), .phase = Phase::act},
                  {.event = 6, .cancelled = true}};
  answer.rows = {{.kind = Row::Kind::event, .name = "a", .text = "b"},
                 {.kind = Row::Kind::series,
                  .time = Time::nanoseconds(9),
                  .name = "x",
                  .text = "",
                  .value = 4.0}};
  answer.message_kind = "gaussian";
  answer.receiver = 2;
  answer.tick = 17;
  answer.news_of = 3;
  answer.acknowledged = true;
  answer.bytes = Bytes(20, std::byte{7});
  answer.rider = Bytes(3, std::byte{2});
  answer.subject = 1;
  answer.belief = belief(8);
  answer.failure = "it failed";
  answer.number = 13;
  answer.content = Bytes(2, std::byte{6});
  answer.beliefs = {{belief(2), ledger()}, {belief(2), Ledger()}};
  answer.counts = {.measurements = 1, .fusions = 2, .refused = 4, .fusion_gain_max = 0.5};
  return answer;
}

/// Fills an object anew from a pool, as riders cannot be made otherwise.
struct Rider {
  LedgerPool pool;
  LedgerRider* rider = nullptr;
  RiderPtr holds = pool.make(rider);
};

Bytes full_rider() {
  Rider full;
  Ledger moving = Ledger::moving(2);
  moving.measured(1);
  full.rider->ledgers = {ledger(), moving};
  full.rider->fresh = {ledger()};
  Bytes bytes;
  pack(*full.rider, bytes);
  return bytes;
}

template <class T>
Bytes packed(const T& message) {
  Bytes bytes;
  pack(message, bytes);
  return bytes;
}

TEST(RemoteProtocol, WhatIsPackedComesBack) {
  Order order;
  ASSERT_TRUE(unpack(packed(full_order()), order));
  EXPECT_EQ(packed(order), packed(full_order()));
  EXPECT_EQ(order.surroundings.neighbours, full_order().surroundings.neighbours);
  EXPECT_EQ(order.measured_at, full_order().measured_at);
  EXPECT_EQ(order.measurement.information.omega, belief(4).omega);
  EXPECT_EQ(order.stamp, std::numeric_limits<std::int64_t>::min());

  Answer answer;
  ASSERT_TRUE(unpack(packed(full_answer()), answer));
  EXPECT_EQ(packed(answer), packed(full_answer()));
  EXPECT_EQ(answer.tick, 17u);
  EXPECT_EQ(answer.rows[1].value, 4.0);
  EXPECT_EQ(answer.beliefs[0].ledger.weights().size(), ledger().weights().size());

  Rider rider;
  ASSERT_TRUE(unpack(full_rider(), *rider.rider));
  EXPECT_EQ(packed(*rider.rider), full_rider());
}

TEST(RemoteProtocol, NothingOfAnEarlierMessageIsLeft) {
  Order order = full_order();
  ASSERT_TRUE(unpack(packed(Order()), order));
  EXPECT_EQ(packed(order), packed(Order()));
  Answer answer = full_answer();
  ASSERT_TRUE(unpack(packed(Answer()), answer));
  EXPECT_EQ(packed(answer), packed(Answer()));
}

template <class T>
void expect_refusal_of_all_but_the_whole(const Bytes& whole, T& out) {
  for (std::size_t size = 0; size < whole.size(); ++size) {
    ASSERT_FALSE(unpack(std::span(whole).first(size), out)) << size << " of " << whole.size();
  }
  Bytes longer = whole;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(unpack(longer, out));
  EXPECT_TRUE(unpack(whole, out));
}

TEST(RemoteProtocol, TruncatedAndLongerBytesAreRefused) {
  Order order;
  expect_refusal_of_all_but_the_whole(packed(full_order()), order);
  Answer answer;
  expect_refusal_of_all_but_the_whole(packed(full_answer()), answer);
  Rider rider;
  expect_refusal_of_all_but_the_whole(full_rider(), *rider.rider);
}

TEST(RemoteProtocol, UnknownKindsAndDimensionsAreRefused) {
  Bytes bytes = packed(full_order());
  bytes[0] = static_cast<std::byte>(static_cast<int>(OrderKind::dismiss) + 1);
  Order order;
  EXPECT_FALSE(unpack(bytes, order));
  bytes = packed(full_answer());
  bytes[0] = static_cast<std::byte>(static_cast<int>(AnswerKind::failed) + 1);
  Answer answer;
  EXPECT_FALSE(unpack(bytes, answer));
  // A belief begins with its dimension, behind the four bytes of its subject.
  const Bytes small = packed(Answer{.subject = 0x01020304, .belief = belief(1)});
  const std::array subject = {std::byte{4}, std::byte{3}, std::byte{2}, std::byte{1}};
  const auto found = std::search(small.begin(), small.end(), subject.begin(), subject.end());
  ASSERT_NE(found, small.end());
  bytes = small;
  std::byte& dimension = bytes[static_cast<std::size_t>(found - small.begin()) + subject.size()];
  ASSERT_EQ(dimension, std::byte{1});
  EXPECT_TRUE(unpack(bytes, answer));
  dimension = std::byte{gaussian::dimension_max + 1};
  bytes.insert(bytes.end(), 1000, std::byte{0});
  EXPECT_FALSE(unpack(bytes, answer));
}

/// Bytes of which some are others, or of which the end is missing.
Bytes damaged(const Bytes& whole, Stream& stream) {
  Bytes bytes = whole;
  if (stream.uniform() < 0.3) bytes.resize(stream.bits() % (bytes.size() + 1));
  const std::uint64_t changes = bytes.empty() ? 0 : 1 + stream.bits() % 8;
  for (std::uint64_t i = 0; i < changes; ++i) {
    std::byte& one = bytes[stream.bits() % bytes.size()];
    one = stream.uniform() < 0.5 ? one ^ std::byte(1u << (stream.bits() % 8))
                                 : static_cast<std::byte>(stream.bits());
  }
  return bytes;
}

/// What is taken for a message can be packed again, and is the same message then.
template <class T>
int fuzz(const Bytes& whole, T& out, std::uint64_t seed) {
  Stream stream(seed, Purpose("fuzz"), Entity{0});
  int taken = 0;
  for (int round = 0; round < 5000; ++round) {
    if (!unpack(damaged(whole, stream), out)) continue;
    ++taken;
    const Bytes once = packed(out);
    EXPECT_TRUE(unpack(once, out));
    EXPECT_EQ(packed(out), once);
  }
  return taken;
}

TEST(RemoteProtocol, DamagedBytesDoNoHarm) {
  // Numbers may be any; most places hold numbers. Lengths may not.
  Order order;
  const int orders = fuzz(packed(full_order()), order, 1);
  EXPECT_GT(orders, 250);
  EXPECT_LT(orders, 4750);
  Answer answer;
  const int answers = fuzz(packed(full_answer()), answer, 2);
  EXPECT_GT(answers, 250);
  EXPECT_LT(answers, 4750);
  Rider rider;
  const int riders = fuzz(full_rider(), *rider.rider, 3);
  EXPECT_GT(riders, 25);
  EXPECT_LT(riders, 4750);
}

TEST(RemoteProtocol, NoiseIsNoMessage) {
  Stream stream(4, Purpose("noise"), Entity{0});
  Order order;
  Answer answer;
  Rider rider;
  for (int round = 0; round < 5000; ++round) {
    Bytes bytes(stream.bits() % 400);
    for (std::byte& one : bytes) one = static_cast<std::byte>(stream.bits());
    EXPECT_FALSE(unpack(bytes, order));
    EXPECT_FALSE(unpack(bytes, answer));
    EXPECT_FALSE(unpack(bytes, *rider.rider));
  }
}

}  // namespace
}  // namespace hearsay::remote
