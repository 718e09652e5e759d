// Messages with more, or less, than whole beliefs: sizes by hand, there and back, and bytes that
// are none.
#include "filters/gaussian/message_forms.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

constexpr MessageForm forms[] = {MessageForm::plain,     MessageForm::split,
                                 MessageForm::consensus, MessageForm::hybrid,
                                 MessageForm::diagonal,  MessageForm::quantised};

struct Sample {
  Message message{3, 7, {}};
  MessageExtras extras;
};

Sample sample(MessageForm form, int beliefs, int n, int bits = 8) {
  Stream random = stream("forms");
  Sample out;
  out.extras.degree = 5;
  out.extras.bits = bits;
  for (int i = 0; i < beliefs; ++i) {
    Belief belief = random_belief(random, n), fresh = random_belief(random, n);
    if (form == MessageForm::diagonal) belief = *diagonal_part(belief);
    if (form == MessageForm::split) fresh.xi.setZero();
    if (form == MessageForm::quantised) {
      out.extras.quantised.push_back(*quantise(belief, bits));
      belief = *belief_of(out.extras.quantised.back(), bits);
    }
    out.message.beliefs.push_back({static_cast<std::uint32_t>(2 * i), belief});
    out.extras.fresh.push_back(fresh);
  }
  return out;
}

TEST(MessageForms, SizesAreThoseOfTheirTypes) {
  // Header 4, incarnation 4, count 4, number of beliefs 4; subject 4, lengths 4, doubles 8.
  EXPECT_EQ(encoded_size(MessageForm::plain, 1, 2), 76u);
  EXPECT_EQ(encoded_size(MessageForm::split, 1, 2), 76u + 8 + 24);
  EXPECT_EQ(encoded_size(MessageForm::consensus, 1, 2), 76u);  // its degree fills a gap
  EXPECT_EQ(encoded_size(MessageForm::hybrid, 1, 2), 76u + 8 + 16 + 8 + 24);
  EXPECT_EQ(encoded_size(MessageForm::diagonal, 1, 2), 76u - 8);
  EXPECT_EQ(encoded_size(MessageForm::diagonal, 1, 4), 4u + 12 + 8 + 4 + 32 + 8 + 32);
  // Two octets and padding; 2 × 5 octets and 3 entries of 8 bits.
  EXPECT_EQ(encoded_size(MessageForm::quantised, 1, 2, 8), 4u + 8 + 4 + 4 + 4 + 4 + 13);
  EXPECT_EQ(encoded_size(MessageForm::quantised, 1, 2, 4), 4u + 8 + 4 + 4 + 4 + 4 + 12);
  EXPECT_EQ(encoded_size(MessageForm::quantised, 1, 4, 8), 4u + 8 + 4 + 4 + 4 + 4 + 30);
}

TEST(MessageForms, ThereAndBack) {
  for (const MessageForm form : forms) {
    for (int beliefs = 0; beliefs <= 4; ++beliefs) {
      for (int n = 1; n <= dimension_max; ++n) {
        const int bits = form == MessageForm::quantised ? 4 + (n + 3 * beliefs) % 13 : 8;
        const Sample sent = sample(form, beliefs, n, bits);
        std::vector<std::byte> bytes;
        encode(form, sent.message, sent.extras, bytes);
        EXPECT_EQ(bytes.size(), encoded_size(form, static_cast<std::size_t>(beliefs), n, bits));
        Sample back;
        ASSERT_TRUE(decode(form, bytes, back.message, back.extras));
        EXPECT_EQ(back.message.incarnation, 3u);
        EXPECT_EQ(back.message.count, 7u);
        ASSERT_EQ(back.message.beliefs.size(), sent.message.beliefs.size());
        const bool fresh = form == MessageForm::split || form == MessageForm::hybrid;
        if (form == MessageForm::consensus || form == MessageForm::hybrid) {
          EXPECT_EQ(back.extras.degree, 5u);
        }
        for (std::size_t i = 0; i < sent.message.beliefs.size(); ++i) {
          EXPECT_EQ(back.message.beliefs[i].subject, 2 * i);
          EXPECT_EQ(back.message.beliefs[i].belief.omega, sent.message.beliefs[i].belief.omega);
          EXPECT_EQ(back.message.beliefs[i].belief.xi, sent.message.beliefs[i].belief.xi);
          if (!fresh) continue;
          EXPECT_EQ(back.extras.fresh[i].omega, sent.extras.fresh[i].omega);
          EXPECT_EQ(back.extras.fresh[i].xi, sent.extras.fresh[i].xi);
        }
      }
    }
  }
}

TEST(MessageForms, NoTruncatedOrLongerMessageIsOne) {
  for (const MessageForm form : forms) {
    const Sample sent = sample(form, 2, 3);
    std::vector<std::byte> bytes;
    encode(form, sent.message, sent.extras, bytes);
    Sample back;
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      EXPECT_FALSE(decode(form, std::span(bytes).first(length), back.message, back.extras));
    }
    bytes.push_back(std::byte{0});
    EXPECT_FALSE(decode(form, bytes, back.message, back.extras));
  }
}

TEST(MessageForms, OfAMovingStateAMessageStandsBehindAStamp) {
  for (const MessageForm form : forms) {
    for (int beliefs = 0; beliefs <= 2; ++beliefs) {
      const Sample sent = sample(form, beliefs, 4, 6);
      std::vector<std::byte> bytes, bare;
      encode(form, sent.message, sent.extras, bare);
      encode(form, StampedMessage{-5'000'000'000, sent.message}, sent.extras, bytes);
      // Header, stamp as two's complement from its lowest octet on, and all else as it was.
      ASSERT_EQ(bytes.size(), bare.size() + 8);
      EXPECT_TRUE(std::equal(bare.begin(), bare.begin() + 4, bytes.begin()));
      const int stamp[8] = {0x00, 0x0e, 0xfa, 0xd5, 0xfe, 0xff, 0xff, 0xff};
      for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(bytes[4 + i], std::byte(stamp[i])) << i;
      EXPECT_TRUE(std::equal(bare.begin() + 4, bare.end(), bytes.begin() + 12));

      StampedMessage back;
      MessageExtras extras;
      ASSERT_TRUE(decode(form, bytes, back, extras));
      EXPECT_EQ(back.stamp, -5'000'000'000);
      EXPECT_EQ(back.message.count, 7u);
      ASSERT_EQ(back.message.beliefs.size(), sent.message.beliefs.size());
      for (std::size_t i = 0; i < sent.message.beliefs.size(); ++i) {
        EXPECT_EQ(back.message.beliefs[i].subject, 2 * i);
        EXPECT_EQ(back.message.beliefs[i].belief.omega, sent.message.beliefs[i].belief.omega);
        EXPECT_EQ(back.message.beliefs[i].belief.xi, sent.message.beliefs[i].belief.xi);
      }
      for (std::size_t length = 0; length < bytes.size(); ++length) {
        EXPECT_FALSE(decode(form, std::span(bytes).first(length), back, extras)) << length;
      }
      bytes.push_back(std::byte{0});
      EXPECT_FALSE(decode(form, bytes, back, extras));
      bytes.pop_back();
      bytes[1] = std::byte{0};  // big-endian
      EXPECT_FALSE(decode(form, bytes, back, extras));
    }
  }
}

TEST(MessageForms, AnotherNumberOfBitsIsRefused) {
  const Sample sent = sample(MessageForm::quantised, 1, 2);
  std::vector<std::byte> bytes;
  encode(MessageForm::quantised, sent.message, sent.extras, bytes);
  Sample back;
  for (const int bits : {0, 3, 7, 9, 17, 255}) {
    bytes[13] = static_cast<std::byte>(bits);
    EXPECT_FALSE(decode(MessageForm::quantised, bytes, back.message, back.extras)) << bits;
  }
}

TEST(MessageForms, RandomBytesNeverCrash) {
  Stream random = stream("fuzz forms");
  for (const MessageForm form : forms) {
    const Sample sent = sample(form, 3, 2);
    std::vector<std::byte> valid, bytes, again;
    encode(form, sent.message, sent.extras, valid);
    Sample back;
    int accepted = 0;
    for (int i = 0; i < 10000; ++i) {
      if (i % 2 == 0) {  // noise behind a right header
        bytes.resize(random.below(300));
        for (auto& b : bytes) b = static_cast<std::byte>(random.below(i % 4 == 0 ? 256 : 5));
        std::copy_n(valid.begin(), std::min<std::size_t>(4, bytes.size()), bytes.begin());
      } else {
        bytes = valid;
        for (std::uint64_t k = random.below(4); k-- > 0;) {
          bytes[random.below(bytes.size())] = static_cast<std::byte>(random.below(256));
        }
        if (random.below(2) == 0) bytes.resize(random.below(bytes.size() + 1));
      }
      if (!decode(form, bytes, back.message, back.extras)) continue;
      ++accepted;
      encode(form, back.message, back.extras, again);
      EXPECT_EQ(again.size(), bytes.size());
    }
    EXPECT_GT(accepted, 200);
  }
}

}  // namespace
}  // namespace hearsay::gaussian
