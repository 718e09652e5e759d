#include "filters/grid/codec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "filters/grid/fusion.hpp"
#include "sim/kernel/error.hpp"
#include "tests/filters/grid/samples.hpp"

namespace hearsay::grid {
namespace {

constexpr Form forms[] = {Form::whole, Form::changed, Form::runs};
constexpr std::size_t no_mtu = std::size_t{1} << 30;

std::vector<std::byte> bytes(std::initializer_list<int> values) {
  std::vector<std::byte> out;
  for (const int value : values) out.push_back(static_cast<std::byte>(value));
  return out;
}

std::vector<std::vector<std::byte>> encoded(const Encoder::Message& message, const Shape& shape,
                                            std::size_t mtu = no_mtu) {
  Encoder encoder;
  const auto packets = encoder.encode(message, shape, mtu);
  return {packets.begin(), packets.end()};
}

/// Few values, so that there are runs and cells that did not change.
std::vector<float> patchy(Stream& random, std::size_t numbers) {
  std::vector<float> evidence(numbers, 0.0F);
  for (std::size_t i = 0; i < numbers; ++i) {
    if (i > 1 && random.bernoulli(0.8)) {
      evidence[i] = evidence[i - 2];
    } else if (random.bernoulli(0.5)) {
      evidence[i] = static_cast<float>(random.normal());
    }
  }
  return evidence;
}

// 1.0F = 3f 80 00 00, −2.0F = c0 00 00 00.
TEST(GridCodec, ASmallWholeGridByteForByte) {
  const std::vector<float> evidence{1.0F, -2.0F};
  const auto packets = encoded({7, 0x01020304, Form::whole, evidence}, {2, 1});
  ASSERT_EQ(packets.size(), 1u);
  EXPECT_EQ(packets[0], bytes({
                            0x00, 0x01, 0x00, 0x00,  // CDR, little-endian
                            0x07, 0x00, 0x00, 0x00,  // incarnation
                            0x04, 0x03, 0x02, 0x01,  // count
                            0x00, 0x00, 0x00, 0x00,  // part 0
                            0x01, 0x00, 0x00, 0x00,  // of 1
                            0x02, 0x00, 0x00, 0x00,  // cells
                            0x00, 0x01, 0x00, 0x00,  // whole, one layer, to a multiple of 4
                            0x00, 0x00, 0x00, 0x00,  // from cell 0 on
                            0x02, 0x00, 0x00, 0x00,  // two numbers
                            0x00, 0x00, 0x80, 0x3f,  // 1.0
                            0x00, 0x00, 0x00, 0xc0,  // −2.0
                        }));
}

TEST(GridCodec, ChangesAndRunsByteForByte) {
  const std::vector<float> sent{0.0F, 0.0F, 1.0F, 1.0F}, evidence{1.0F, 1.0F, 1.0F, -2.0F};
  auto packets = encoded({1, 2, Form::changed, evidence, sent}, {4, 1});
  ASSERT_EQ(packets.size(), 1u);
  std::vector<std::byte> body(packets[0].begin() + 24, packets[0].end());
  EXPECT_EQ(body,
            bytes({1, 1, 0, 0,  // changed, one layer
                   3, 0, 0, 0, 0, 0, 0,    0,    1, 0, 0,    0,    3, 0, 0, 0,  // cells 0, 1, 3
                   3, 0, 0, 0, 0, 0, 0x80, 0x3f, 0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0}));
  packets = encoded({1, 2, Form::runs, evidence}, {4, 1});
  ASSERT_EQ(packets.size(), 1u);
  body.assign(packets[0].begin() + 24, packets[0].end());
  EXPECT_EQ(body, bytes({2, 1, 0, 0,                                // runs, one layer
                         2, 0, 0, 0, 0, 0, 0,    0,    3, 0, 0, 0,  // from cells 0 and 3
                         2, 0, 0, 0, 3, 0, 0,    0,    1, 0, 0, 0,  // 3 and 1 long
                         2, 0, 0, 0, 0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0}));
}

TEST(GridCodec, SizesByHand) {
  EXPECT_EQ(packet_size(Form::whole, 1, 100), 4u + 24 + 4 + 4 + 400);
  EXPECT_EQ(packet_size(Form::whole, 2, 100), 4u + 24 + 4 + 4 + 800);
  EXPECT_EQ(packet_size(Form::changed, 1, 10), 4u + 24 + 4 + 40 + 4 + 40);
  EXPECT_EQ(packet_size(Form::changed, 2, 10), 4u + 24 + 4 + 40 + 4 + 80);
  EXPECT_EQ(packet_size(Form::runs, 1, 10), 4u + 24 + 4 + 40 + 4 + 40 + 4 + 40);
  EXPECT_EQ(packet_size(Form::runs, 2, 10), 4u + 24 + 4 + 40 + 4 + 40 + 4 + 80);
  EXPECT_EQ(blocks_that_fit(Form::whole, 1, 1500), 366u);
  EXPECT_EQ(blocks_that_fit(Form::whole, 1, 39), 0u);
  EXPECT_EQ(blocks_that_fit(Form::whole, 1, 40), 1u);
  EXPECT_EQ(blocks_that_fit(Form::runs, 1, 10), 0u);
  EXPECT_THROW(packet_size(Form::whole, 3, 1), BrokenInvariant);
}

TEST(GridCodec, AHundredByAHundredDoesNotFitInAFrame) {
  const std::vector<float> evidence(10000, 0.0F);
  const Shape shape{10000, 1};
  const MessageSize whole = message_size(Form::whole, shape, evidence, {}, 1500);
  EXPECT_EQ(whole.packets, 28u);  // 10000/366, rounded up
  EXPECT_EQ(whole.bytes, 28u * 36 + 40000);
  const MessageSize runs = message_size(Form::runs, shape, evidence, {}, 1500);
  EXPECT_EQ(runs.blocks, 1u);
  EXPECT_EQ(runs.bytes, 52u);
  const MessageSize changed = message_size(Form::changed, shape, evidence, evidence, 1500);
  EXPECT_EQ(changed.blocks, 0u);
  EXPECT_EQ(changed.bytes, 36u);
}

TEST(GridCodec, EveryFormShapeAndMtuComesBack) {
  Stream random = stream("grid codec");
  Encoder encoder;
  for (const std::size_t layers : {1u, 2u}) {
    for (const int cells : {1, 7, 256, 1000}) {
      const Shape shape{cells, layers};
      const std::size_t numbers = layers * static_cast<std::size_t>(cells);
      const std::vector<float> sent = patchy(random, numbers);
      std::vector<float> evidence = sent;
      for (float& e : evidence) {
        if (random.bernoulli(0.1)) e += 1.0F;
      }
      for (const Form form : forms) {
        for (const std::size_t mtu :
             {std::size_t{64}, std::size_t{127}, std::size_t{1500}, no_mtu}) {
          const MessageSize size = message_size(form, shape, evidence, sent, mtu);
          const auto packets = encoder.encode({3, 4, form, evidence, sent}, shape, mtu);
          ASSERT_EQ(packets.size(), size.packets);
          std::vector<float> copy =
              form == Form::changed ? sent : std::vector<float>(numbers, -99.0F);
          std::size_t sum = 0, blocks = 0;
          std::uint32_t part = 0;
          for (const std::vector<std::byte>& bytes : packets) {
            EXPECT_LE(bytes.size(), mtu);
            sum += bytes.size();
            const auto packet = Packet::parse(bytes, shape);
            ASSERT_TRUE(packet);
            EXPECT_EQ(packet->head().incarnation, 3u);
            EXPECT_EQ(packet->head().count, 4u);
            EXPECT_EQ(packet->head().part, part++);
            EXPECT_EQ(packet->head().parts, packets.size());
            EXPECT_EQ(packet->head().form, form);
            EXPECT_EQ(bytes.size(), packet_size(form, layers, packet->blocks()));
            blocks += packet->blocks();
            packet->apply(copy);
          }
          EXPECT_EQ(sum, size.bytes);
          EXPECT_EQ(blocks, size.blocks);
          EXPECT_EQ(copy, evidence);
        }
      }
    }
  }
}

TEST(GridCodec, ALostPacketLeavesJustItsCellsUnsaid) {
  Stream random = stream("lost packet");
  const std::vector<float> evidence = random_evidence(random, 100, 1.0);
  const auto packets = encoded({1, 1, Form::whole, evidence}, {100, 1}, 36 + 4 * 30);
  ASSERT_EQ(packets.size(), 4u);
  BernoulliGrid grid(square(10));
  for (const std::size_t arrived : {3u, 0u, 2u}) {
    Packet::parse(packets[arrived], {100, 1})->for_each_range([&](int first, auto values) {
      fuse(Rule::naive, grid, {first, values});
    });
  }
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(grid.evidence()[i], i >= 30 && i < 60 ? 0.0F : evidence[i]);
  }
}

TEST(GridCodec, RangesAreShortRisingAndWhole) {
  const std::vector<float> evidence(3000, 2.0F);
  for (const Form form : {Form::whole, Form::runs}) {
    const auto packets = encoded({1, 1, form, evidence}, {1500, 2});
    const auto packet = Packet::parse(packets[0], {1500, 2});
    ASSERT_TRUE(packet);
    int next = 0;
    packet->for_each_range([&](int first, std::span<const float> values) {
      EXPECT_EQ(first, next);
      EXPECT_LE(values.size(), 256u);
      for (const float value : values) EXPECT_EQ(value, 2.0F);
      next = first + static_cast<int>(values.size() / 2);
    });
    EXPECT_EQ(next, 1500);
  }
}

// Refusals.
void put(std::vector<std::byte>& bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(bytes.data() + at, &value, 4);
}

TEST(GridCodec, RefusesEveryCutAndEveryTail) {
  Stream random = stream("cuts");
  const std::vector<float> sent(50, 0.0F), evidence = patchy(random, 50);
  for (const Form form : forms) {
    auto packet = encoded({1, 1, form, evidence, sent}, {25, 2})[0];
    for (std::size_t length = 0; length < packet.size(); ++length) {
      EXPECT_FALSE(Packet::parse(std::span(packet).first(length), {25, 2}));
    }
    EXPECT_TRUE(Packet::parse(packet, {25, 2}));
    EXPECT_FALSE(Packet::parse(packet, {25, 1}));
    EXPECT_FALSE(Packet::parse(packet, {26, 2}));
    packet.push_back(std::byte{0});
    EXPECT_FALSE(Packet::parse(packet, {25, 2}));
  }
}

TEST(GridCodec, RefusesWhatIsMalformed) {
  const std::vector<float> sent(4, 0.0F), evidence{1.0F, 1.0F, 1.0F, -2.0F};
  const Shape shape{4, 1};
  const auto with = [&](Form form, std::size_t at, std::uint32_t value) {
    auto packet = encoded({1, 1, form, evidence, sent}, shape)[0];
    put(packet, at, value);
    return Packet::parse(packet, shape).has_value();
  };
  for (const Form form : forms) {
    EXPECT_TRUE(with(form, 4, 77));            // any incarnation is legal
    EXPECT_FALSE(with(form, 0, 0));            // not CDR_LE
    EXPECT_FALSE(with(form, 12, 1));           // part 1 of 1
    EXPECT_FALSE(with(form, 16, 0));           // of no parts
    EXPECT_FALSE(with(form, 16, 5));           // of more parts than cells
    EXPECT_FALSE(with(form, 20, 5));           // another grid
    EXPECT_FALSE(with(form, 24, 0x0103));      // an unknown form
    EXPECT_FALSE(with(form, 24, 0x0200));      // another number of layers
    EXPECT_FALSE(with(form, 28, 0xffffffff));  // far too many, or far outside
    EXPECT_FALSE(with(form, 28, 1));           // lengths disagree, or one cell too far
  }
  EXPECT_FALSE(with(Form::changed, 32, 1));        // cell 1 twice
  EXPECT_FALSE(with(Form::changed, 44, 4));        // beyond the grid
  EXPECT_FALSE(with(Form::runs, 36, 2));           // run from 2 in the run from 0 to 3
  EXPECT_FALSE(with(Form::runs, 44, 0));           // an empty run
  EXPECT_FALSE(with(Form::runs, 48, 2));           // beyond the grid
  EXPECT_FALSE(with(Form::runs, 48, 0xffffffff));  // far beyond
  for (const std::uint32_t bad : {0x7fc00000u, 0x7f800000u, 0xff800000u, 0xffffffffu}) {
    EXPECT_FALSE(with(Form::whole, 36, bad));  // NaN and infinities
    EXPECT_FALSE(with(Form::changed, 60, bad));
    EXPECT_FALSE(with(Form::runs, 56, bad));
  }
}

TEST(GridCodec, BytesInDisorderNeitherBreakNorReachBeyondTheGrid) {
  // Random bytes changed in good packets: either refused, or within the grid and finite.
  Stream random = stream("grid fuzz");
  const Shape shape{40, 1};
  const std::vector<float> sent(40, 0.0F), evidence = patchy(random, 40);
  int taken = 0, refused = 0;
  for (const Form form : forms) {
    const auto good = encoded({1, 1, form, evidence, sent}, shape)[0];
    for (int trial = 0; trial < 20000; ++trial) {
      auto packet = good;
      const std::uint64_t changes = 1 + random.below(4);
      for (std::uint64_t i = 0; i < changes; ++i) {
        packet[random.below(packet.size())] = static_cast<std::byte>(random.below(256));
      }
      if (random.bernoulli(0.1)) packet.resize(random.below(packet.size()));
      const auto parsed = Packet::parse(packet, shape);
      parsed ? ++taken : ++refused;
      if (!parsed) continue;
      int next = 0;
      parsed->for_each_range([&](int first, std::span<const float> values) {
        ASSERT_GE(first, next);
        next = first + static_cast<int>(values.size());
        ASSERT_LE(next, 40);
        for (const float value : values) ASSERT_TRUE(std::isfinite(value));
      });
    }
  }
  EXPECT_GT(taken, 1000);
  EXPECT_GT(refused, 1000);
}

TEST(GridCodec, EncodesNoNonsense) {
  const std::vector<float> four(4, 0.0F), three(3, 0.0F);
  std::vector<float> wild = four;
  wild[2] = std::numeric_limits<float>::infinity();
  EXPECT_THROW(encoded({1, 1, Form::whole, three}, {4, 1}), BrokenInvariant);
  EXPECT_THROW(encoded({1, 1, Form::changed, four, three}, {4, 1}), BrokenInvariant);
  EXPECT_THROW(encoded({1, 1, Form::whole, four}, {4, 1}, 39), BrokenInvariant);
  EXPECT_THROW(encoded({1, 1, Form::whole, wild}, {4, 1}), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::grid
