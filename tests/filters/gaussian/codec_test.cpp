#include "filters/gaussian/codec.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

std::vector<std::byte> bytes(std::initializer_list<int> values) {
  std::vector<std::byte> out;
  for (const int value : values) out.push_back(static_cast<std::byte>(value));
  return out;
}

Message message(int beliefs, int n) {
  Stream random = stream("codec");
  Message m{7, 9, {}};
  for (int i = 0; i < beliefs; ++i) {
    m.beliefs.push_back({static_cast<std::uint32_t>(100 + i), random_belief(random, n)});
  }
  return m;
}

void expect_same(const Message& a, const Message& b) {
  EXPECT_EQ(a.incarnation, b.incarnation);
  EXPECT_EQ(a.count, b.count);
  ASSERT_EQ(a.beliefs.size(), b.beliefs.size());
  for (std::size_t i = 0; i < a.beliefs.size(); ++i) {
    EXPECT_EQ(a.beliefs[i].subject, b.beliefs[i].subject);
    EXPECT_EQ(a.beliefs[i].belief.omega, b.beliefs[i].belief.omega);
    EXPECT_EQ(a.beliefs[i].belief.xi, b.beliefs[i].belief.xi);
  }
}

// 1.0 = 3f f0 00 00 00 00 00 00, −2.0 = c0 00…, 0.5 = 3f e0…, 3.0 = 40 08….
TEST(GaussianCodec, ASmallMessageByteForByte) {
  const Message small{
      1, 0x01020304, {{5, {matrix({{3.0, 0.5}, {0.5, 1.0}}), vector({1.0, -2.0})}}}};
  const auto expected = bytes({
      0x00, 0x01, 0x00, 0x00,                          // CDR, little-endian
      0x01, 0x00, 0x00, 0x00,                          // incarnation
      0x04, 0x03, 0x02, 0x01,                          // count
      0x01, 0x00, 0x00, 0x00,                          // one belief
      0x05, 0x00, 0x00, 0x00,                          // subject
      0x02, 0x00, 0x00, 0x00,                          // two entries of ξ
      0x00, 0x00, 0x00, 0x00,                          // to a multiple of 8
      0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xf0, 0x3f,  // 1.0
      0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xc0,  // −2.0
      0x03, 0x00, 0x00, 0x00,                          // three entries of Ω
      0x00, 0x00, 0x00, 0x00,                          // to a multiple of 8
      0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x08, 0x40,  // Ω₁₁ = 3.0
      0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xe0, 0x3f,  // Ω₁₂ = 0.5
      0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xf0, 0x3f,  // Ω₂₂ = 1.0
  });
  std::vector<std::byte> out;
  encode(small, out);
  EXPECT_EQ(out, expected);
  EXPECT_EQ(out.size(), encoded_size(1, 2));
}

TEST(GaussianCodec, AnEmptyMessageIsSixteenBytes) {
  std::vector<std::byte> out;
  encode(Message{2, 3, {}}, out);
  EXPECT_EQ(out, bytes({0, 1, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(encoded_size(0, 2), 16u);
}

TEST(GaussianCodec, SizesByHand) {
  // Header 4, three words 12, subject and length 8, padding 4, ξ 8n, length and padding 8, Ω.
  EXPECT_EQ(encoded_size(1, 1), 4u + 12 + 8 + 4 + 8 + 8 + 8);
  EXPECT_EQ(encoded_size(1, 2), 4u + 12 + 8 + 4 + 16 + 8 + 24);
  // From the second belief on nothing is padded before ξ.
  EXPECT_EQ(encoded_size(15, 2), encoded_size(1, 2) + 14 * (8 + 16 + 8 + 24));
  EXPECT_THROW(encoded_size(1, 0), BrokenInvariant);
  EXPECT_THROW(encoded_size(1, dimension_max + 1), BrokenInvariant);
}

TEST(GaussianCodec, EverySizeAndDimensionComesBack) {
  std::vector<std::byte> out;
  Message back;
  for (int n = 1; n <= dimension_max; ++n) {
    for (const int beliefs : {0, 1, 2, 15}) {
      const Message m = message(beliefs, n);
      encode(m, out);
      EXPECT_EQ(out.size(), encoded_size(static_cast<std::size_t>(beliefs), n));
      ASSERT_TRUE(decode(out, back));
      expect_same(m, back);
    }
  }
}

TEST(GaussianCodec, BeliefsOfDifferentDimensionsMayTravelTogether) {
  Message m = message(1, 3);
  for (const int n : {1, 8, 2}) m.beliefs.push_back(message(1, n).beliefs[0]);
  std::vector<std::byte> out;
  Message back;
  encode(m, out);
  ASSERT_TRUE(decode(out, back));
  expect_same(m, back);
}

TEST(GaussianCodec, StorageThatHeldABiggerMessageIsOverwritten) {
  std::vector<std::byte> out;
  std::vector<std::byte> fresh;
  Message back;
  encode(message(15, 8), out);
  ASSERT_TRUE(decode(out, back));
  encode(message(2, 2), out);
  encode(message(2, 2), fresh);
  EXPECT_EQ(out, fresh);
  ASSERT_TRUE(decode(out, back));
  expect_same(message(2, 2), back);
}

TEST(GaussianCodec, NumbersAreTakenAsTheyAre) {
  const double nan = std::bit_cast<double>(std::uint64_t{0x7ff8000000000123});
  Message m{1, 1, {{0, {matrix({{nan}}), vector({-0.0})}}}};
  std::vector<std::byte> out;
  Message back;
  encode(m, out);
  ASSERT_TRUE(decode(out, back));
  EXPECT_EQ(std::bit_cast<std::uint64_t>(back.beliefs[0].belief.omega(0, 0)), 0x7ff8000000000123u);
  EXPECT_TRUE(std::signbit(back.beliefs[0].belief.xi(0)));
}

TEST(GaussianCodec, EveryTruncationIsRejected) {
  std::vector<std::byte> out;
  Message back;
  for (const int beliefs : {0, 1, 3}) {
    encode(message(beliefs, 2), out);
    for (std::size_t length = 0; length < out.size(); ++length) {
      EXPECT_FALSE(decode(std::span(out).first(length), back)) << length;
    }
  }
}

TEST(GaussianCodec, TrailingBytesAreRejected) {
  std::vector<std::byte> out;
  Message back;
  encode(message(2, 2), out);
  for (int extra = 1; extra <= 9; ++extra) {
    out.push_back(std::byte{0});
    EXPECT_FALSE(decode(out, back)) << extra;
  }
}

TEST(GaussianCodec, AnotherHeaderIsRejected) {
  std::vector<std::byte> out;
  Message back;
  encode(message(1, 2), out);
  for (std::size_t at = 0; at < 4; ++at) {
    auto changed = out;
    changed[at] ^= std::byte{0x01};
    EXPECT_FALSE(decode(changed, back)) << at;
  }
}

TEST(GaussianCodec, EveryOtherLengthFieldIsRejected) {
  const auto with = [](std::size_t offset, std::uint32_t value) {
    std::vector<std::byte> out;
    encode(message(2, 2), out);
    for (std::size_t i = 0; i < 4; ++i) {
      out[offset + i] = static_cast<std::byte>(value >> (8 * i));
    }
    return out;
  };
  Message back;
  // Number of beliefs; length of the first ξ and Ω; of the second ξ and Ω.
  const std::size_t offsets[] = {12, 20, 44, 80, 100};
  const std::uint32_t right[] = {2, 2, 3, 2, 3};
  for (std::size_t i = 0; i < 5; ++i) {
    ASSERT_TRUE(decode(with(offsets[i], right[i]), back)) << i;
    for (const std::uint32_t wrong : {0u, 1u, 2u, 3u, 4u, 6u, 8u, 9u, 255u, 0x80000000u, ~0u}) {
      if (wrong == right[i]) continue;
      EXPECT_FALSE(decode(with(offsets[i], wrong), back)) << i << " " << wrong;
    }
  }
}

TEST(GaussianCodec, ADimensionBeyondTheLargestIsRejectedEvenIfAllBytesAreThere) {
  // n = 9 spelled out: subject, 9, ξ, 45, Ω.
  std::vector<std::byte> out(4 + 12 + 12 + 72 + 8 + 360);
  out[1] = std::byte{1};
  out[12] = std::byte{1};
  out[20] = std::byte{9};
  out[4 + 24 + 72] = std::byte{45};
  Message back;
  EXPECT_FALSE(decode(out, back));
  // The same with n = 8 is a message.
  out.assign(4 + 12 + 12 + 64 + 8 + 288, std::byte{0});
  out[1] = std::byte{1};
  out[12] = std::byte{1};
  out[20] = std::byte{8};
  out[4 + 24 + 64] = std::byte{36};
  EXPECT_TRUE(decode(out, back));
}

TEST(GaussianCodec, RandomBytesNeverCrash) {
  Stream random = stream("fuzz");
  Message back;
  std::vector<std::byte> out;
  std::vector<std::byte> again;
  std::vector<std::byte> valid;
  encode(message(3, 2), valid);
  int accepted = 0;
  for (int i = 0; i < 50000; ++i) {
    if (i % 2 == 0) {  // noise behind a right header
      out.resize(random.below(300));
      for (auto& b : out) b = static_cast<std::byte>(random.below(i % 4 == 0 ? 256 : 4));
      for (std::size_t k = 0; k < std::min<std::size_t>(4, out.size()); ++k) out[k] = valid[k];
    } else {  // a message with a few bytes changed, cut or not
      out = valid;
      for (std::uint64_t k = random.below(4); k-- > 0;) {
        out[random.below(out.size())] = static_cast<std::byte>(random.below(256));
      }
      if (random.below(2) == 0) out.resize(random.below(out.size() + 1));
    }
    if (!decode(out, back)) continue;
    ++accepted;
    encode(back, again);
    EXPECT_EQ(again.size(), out.size());
  }
  EXPECT_GT(accepted, 1000);  // changed numbers are still numbers
}

TEST(GaussianCodec, ABeliefWithoutShapeIsNotEncoded) {
  std::vector<std::byte> out;
  EXPECT_THROW(encode(Message{1, 1, {BeliefEntry{}}}, out), BrokenInvariant);
  EXPECT_THROW(encode(Message{1, 1, {{0, {Matrix::Zero(2, 2), Vector::Zero(3)}}}}, out),
               BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::gaussian
