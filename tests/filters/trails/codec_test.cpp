#include "filters/trails/codec.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "filters/gaussian/cdr.hpp"
#include "tests/filters/trails/samples.hpp"

namespace hearsay::trails {
namespace {

constexpr std::size_t no_mtu = std::size_t{1} << 30;

std::vector<Place> some_places(Stream& random, std::size_t count) {
  std::vector<Place> places;
  for (std::size_t i = 0; i < count; ++i) {
    places.push_back({static_cast<EventId>(3 * i),
                      random_point(random, 50.0),
                      random.uniform(0.0, 1e4),
                      {2, 0, static_cast<std::uint32_t>(i)}});
  }
  return places;
}

std::vector<std::vector<std::byte>> encoded(std::span<const Place> places,
                                            std::span<const Crumb> crumbs,
                                            std::size_t mtu = no_mtu) {
  MetricEncoder encoder;
  const auto packets = encoder.encode({4, 5, 6, places, crumbs}, mtu);
  return {packets.begin(), packets.end()};
}

std::vector<std::byte> bytes(std::initializer_list<int> values) {
  std::vector<std::byte> out;
  for (const int value : values) out.push_back(static_cast<std::byte>(value));
  return out;
}

// 1.0F = 3f 80 00 00, −2.0F = c0 00 00 00; 1.0 = 3f f0 and six zeros, 2.0 = 40 and seven zeros.
TEST(TrailCodec, APlaceAndACrumbByteForByte) {
  const std::vector<Place> places{{7, {1.0F, -2.0F}, 2.0, {1, 2, 3}}};
  const std::vector<Crumb> crumbs{{8, 9, {-2.0F, 1.0F}, 1.0F, 1.0, {4, 5, 0x01020304}}};
  const auto packets = encoded(places, crumbs);
  ASSERT_EQ(packets.size(), 1u);
  EXPECT_EQ(packets[0],
            bytes({
                0, 1, 0,    0,                                               // CDR, little-endian
                4, 0, 0,    0,    5, 0, 0,    0,    6, 0, 0, 0,              // from 4, message 5, 6
                0, 0, 0,    0,    1, 0, 0,    0,                             // part 0 of 1
                2, 0, 0,    0,                                               // numbers a position
                1, 0, 0,    0,    0, 0, 0,    0,                             // a place, padding
                0, 0, 0,    0,    0, 0, 0,    0x40,                          // time
                7, 0, 0,    0,    1, 0, 0,    0,    2, 0, 0, 0, 3, 0, 0, 0,  // event, identity
                1, 0, 0,    0,    0, 0, 0,    0,                             // a crumb, padding
                0, 0, 0,    0,    0, 0, 0xf0, 0x3f,                          // created
                8, 0, 0,    0,    9, 0, 0,    0,                             // event, goal
                4, 0, 0,    0,    5, 0, 0,    0,    4, 3, 2, 1,              // identity
                0, 0, 0x80, 0x3f,                                            // d
                4, 0, 0,    0,                                               // numbers
                0, 0, 0x80, 0x3f, 0, 0, 0,    0xc0,                          // of the place
                0, 0, 0,    0xc0, 0, 0, 0x80, 0x3f,                          // of the crumb
            }));
}

TEST(TrailCodec, SizesByHand) {
  EXPECT_EQ(packet_size(2, 0, 0), 4u + 24 + 4 + 4 + 4);
  EXPECT_EQ(packet_size(2, 1, 1), 4u + 24 + 8 + 24 + 8 + 32 + 4 + 16);
  EXPECT_EQ(packet_size(2, 2, 0), 4u + 24 + 8 + 48 + 4 + 4 + 16);
  EXPECT_EQ(packet_size(2, 0, 10), 4u + 24 + 4 + 4 + 320 + 4 + 80);
  EXPECT_EQ(packet_size(1024, 0, 1), 4u + 24 + 4 + 4 + 32 + 4 + 4096);
  for (const std::size_t places : {0u, 1u, 2u, 5u}) {
    for (std::size_t mtu = 0; mtu < 1000; ++mtu) {
      std::size_t fit = 0;
      while (packet_size(2, places, fit + 1) <= mtu) ++fit;
      ASSERT_EQ(crumbs_that_fit(2, places, mtu), fit) << places << ", " << mtu;
    }
  }
}

TEST(TrailCodec, ATrailComesThroughInPacketsThatStandAlone) {
  Stream random = stream("round trip");
  for (const std::size_t mtu : {200u, 500u, 1500u, 100000u}) {
    for (const std::size_t count : {0u, 1u, 2u, 3u, 100u}) {
      const auto places = some_places(random, 2);
      const auto crumbs = random_crumbs(random, count, 50.0, 1e4);
      const auto packets = encoded(places, crumbs, mtu);
      const MessageSize size = message_size(2, places.size(), count, mtu);
      ASSERT_EQ(packets.size(), size.packets);
      std::size_t total = 0;
      std::vector<Crumb> heard;
      for (std::size_t part = 0; part < packets.size(); ++part) {
        total += packets[part].size();
        ASSERT_LE(packets[part].size(), mtu);
        const auto packet = MetricPacket::parse(packets[part]);
        ASSERT_TRUE(packet);
        EXPECT_EQ(packet->head().sender, 4u);
        EXPECT_EQ(packet->head().incarnation, 5u);
        EXPECT_EQ(packet->head().count, 6u);
        EXPECT_EQ(packet->head().part, part);
        EXPECT_EQ(packet->head().parts, packets.size());
        ASSERT_EQ(packet->places(), places.size());
        for (std::size_t i = 0; i < places.size(); ++i) EXPECT_EQ(packet->place(i), places[i]);
        for (std::size_t i = 0; i < packet->crumbs(); ++i) heard.push_back(packet->crumb(i));
      }
      EXPECT_EQ(total, size.bytes);
      EXPECT_EQ(heard, crumbs);
    }
  }
}

TEST(TrailCodec, ViewsComeThroughAsWell) {
  const std::vector<CrumbOf<ViewSpace::Position>> crumbs{{.event = 1,
                                                          .goal = 1,
                                                          .position = {1.0F, 2.0F, 3.0F},
                                                          .distance_s = 4.0F,
                                                          .created_s = 5.0,
                                                          .identity = {1, 0, 7}},
                                                         {.event = 1,
                                                          .goal = 1,
                                                          .position = {-1.0F, 0.5F, 0.25F},
                                                          .distance_s = 3.0F,
                                                          .created_s = 6.0,
                                                          .identity = {1, 0, 8}}};
  Encoder<ViewSpace> encoder;
  const auto packets = encoder.encode({1, 0, 0, {}, crumbs}, 1000);
  ASSERT_EQ(packets.size(), 1u);
  EXPECT_EQ(packets[0].size(), packet_size(3, 0, 2));
  const auto packet = Packet<ViewSpace>::parse(packets[0]);
  ASSERT_TRUE(packet);
  ASSERT_EQ(packet->crumbs(), 2u);
  EXPECT_EQ(packet->crumb(0), crumbs[0]);
  EXPECT_EQ(packet->crumb(1), crumbs[1]);
  EXPECT_FALSE(MetricPacket::parse(packets[0]));
}

TEST(TrailCodec, TruncatedAndTrailingBytesAreRefused) {
  Stream random = stream("truncated");
  for (const std::size_t places : {0u, 2u}) {
    auto packet = encoded(some_places(random, places), random_crumbs(random, 3, 5.0, 9.0))[0];
    ASSERT_TRUE(MetricPacket::parse(packet));
    for (std::size_t size = 0; size < packet.size(); ++size) {
      ASSERT_FALSE(MetricPacket::parse(std::span(packet).first(size))) << size;
    }
    packet.push_back(std::byte{0});
    EXPECT_FALSE(MetricPacket::parse(packet));
  }
}

/// A packet of two places and a crumb, with one word of it changed; offsets after the header.
bool taken_with(std::size_t offset, std::uint32_t word) {
  const std::vector<Place> places{{7, {1.0F, 2.0F}, 2.0, {1, 2, 3}}, {9, {3.0F, 4.0F}, 2.5, {}}};
  const std::vector<Crumb> crumbs{{8, 9, {5.0F, 6.0F}, 1.0F, 1.0, {4, 5, 6}}};
  auto packet = encoded(places, crumbs)[0];
  EXPECT_EQ(packet.size(), 152u);
  gaussian::cdr::store(packet.data() + 4 + offset, word);
  return MetricPacket::parse(packet).has_value();
}

TEST(TrailCodec, WhatCannotBeIsRefused) {
  constexpr std::uint32_t infinite = 0x7f800000, nan = 0x7fc00000, minus_one = 0xbf800000;
  constexpr std::uint32_t infinite_high = 0x7ff00000, far = 0x4b800000;  // 2^24
  EXPECT_TRUE(taken_with(0, 77));                                        // another sender
  EXPECT_TRUE(taken_with(28, 123));                                      // padding
  EXPECT_TRUE(taken_with(100, no_event));                                // no goal
  EXPECT_FALSE(taken_with(12, 1));                                       // part 1 of 1
  EXPECT_FALSE(taken_with(16, 0));                                       // of 0
  EXPECT_FALSE(taken_with(16, packet_parts_max + 1));                    // of too many
  EXPECT_TRUE(taken_with(16, packet_parts_max));
  EXPECT_FALSE(taken_with(20, 3));  // numbers a position
  for (const std::uint32_t count : {0u, 1u, 3u, 65u, 0xffffffffu, 0x0aaaaaabu}) {
    EXPECT_FALSE(taken_with(24, count)) << count;  // places
  }
  EXPECT_FALSE(taken_with(36, infinite_high));  // time of a place
  EXPECT_FALSE(taken_with(40, 9));              // events not rising
  EXPECT_FALSE(taken_with(40, 10));
  EXPECT_FALSE(taken_with(64, no_event));
  for (const std::uint32_t count : {0u, 2u, 65537u, 0xffffffffu, 0x08000001u}) {
    EXPECT_FALSE(taken_with(80, count)) << count;  // crumbs
  }
  EXPECT_FALSE(taken_with(92, infinite_high));  // creation
  EXPECT_FALSE(taken_with(96, no_event));       // event
  EXPECT_FALSE(taken_with(116, nan));           // d
  EXPECT_FALSE(taken_with(116, infinite));
  EXPECT_FALSE(taken_with(116, minus_one));
  for (const std::uint32_t count : {0u, 5u, 7u, 0xffffffffu}) {
    EXPECT_FALSE(taken_with(120, count)) << count;  // numbers
  }
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_TRUE(taken_with(124 + 4 * i, minus_one));
    EXPECT_FALSE(taken_with(124 + 4 * i, nan));
    EXPECT_FALSE(taken_with(124 + 4 * i, infinite));
    EXPECT_FALSE(taken_with(124 + 4 * i, far));
  }
}

TEST(TrailCodec, MorePlacesThanAPacketMayHaveAreRefused) {
  Stream random = stream("places");
  for (const std::size_t count : {packet_places_max, packet_places_max + 1}) {
    std::vector<std::byte> packet;
    gaussian::cdr::Writer writer = gaussian::cdr::begin(packet_size(2, count, 0) - 4, packet);
    codec::write_head(writer, {}, 2);
    codec::write_body<MetricSpace>(writer, some_places(random, count), {});
    EXPECT_EQ(MetricPacket::parse(packet).has_value(), count == packet_places_max);
  }
}

TEST(TrailCodec, MutatedPacketsAreRefusedOrSoundAndEncodeAgain) {
  Stream random = stream("mutations");
  const auto original = encoded(some_places(random, 2), random_crumbs(random, 4, 50.0, 100.0))[0];
  int taken = 0, refused = 0;
  for (int i = 0; i < 30000; ++i) {
    auto packet = original;
    if (random.bernoulli(0.1)) packet.resize(random.below(packet.size() + 20));
    for (std::uint64_t k = random.below(4) + 1; k > 0 && !packet.empty(); --k) {
      packet[random.below(packet.size())] = static_cast<std::byte>(random.below(256));
    }
    const auto parsed = MetricPacket::parse(packet);
    if (!parsed) {
      ++refused;
      continue;
    }
    ++taken;
    std::vector<Place> places;
    std::vector<Crumb> crumbs;
    for (std::size_t k = 0; k < parsed->places(); ++k) places.push_back(parsed->place(k));
    for (std::size_t k = 0; k < parsed->crumbs(); ++k) crumbs.push_back(parsed->crumb(k));
    std::vector<std::vector<std::byte>> again;
    ASSERT_NO_THROW(again = encoded(places, crumbs));
    ASSERT_EQ(again[0].size(), packet.size());
  }
  EXPECT_GT(taken, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(TrailCodec, WhatNoReceiverWouldTakeIsNotSent) {
  const std::vector<Crumb> good{{8, 9, {5.0F, 6.0F}, 1.0F, 1.0, {4, 5, 6}}};
  std::vector<Crumb> bad = good;
  bad[0].distance_s = -1.0F;
  EXPECT_THROW(encoded({}, bad), BrokenInvariant);
  bad = good;
  bad[0].position.x_m = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(encoded({}, bad), BrokenInvariant);
  const std::vector<Place> disorder{{2, {}, 0.0, {}}, {1, {}, 0.0, {}}};
  EXPECT_THROW(encoded(disorder, good), BrokenInvariant);
  EXPECT_THROW(encoded({}, good, packet_size(2, 0, 1) - 1), BrokenInvariant);
  EXPECT_NO_THROW(encoded({}, good, packet_size(2, 0, 1)));
  EXPECT_THROW(message_size(2, packet_places_max + 1, 0, no_mtu), BrokenInvariant);
  EXPECT_THROW(message_size(2, 2, 0, 20), BrokenInvariant);
  EXPECT_THROW(message_size(2, 0, 70000, packet_size(2, 0, 1)), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::trails
