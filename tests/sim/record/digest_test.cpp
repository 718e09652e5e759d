#include "sim/record/digest.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace hearsay {
namespace {

std::span<const std::byte> bytes(std::string_view text) { return std::as_bytes(std::span(text)); }

// Values of XXH3-128 as the xxHash project publishes them (seed 0, canonical form).
TEST(Digest, OfNothingIsThatOfXxh3) {
  EXPECT_EQ(Xxh3Digest().hex(), "99aa06d3014798d86001c324468d497f");
}

TEST(Digest, OfAShortTextIsThatOfXxh3) {
  Xxh3Digest digest;
  digest.update(bytes("abc"));
  EXPECT_EQ(digest.hex(), "06b05ab6733a618578af5f94892f3950");
}

// Worked out by the scalar form of xxHash 0.8.1 (XXH_VECTOR=0), whatever vectors this machine has.
TEST(Digest, OfALongTextIsThatOfXxh3WithoutVectors) {
  std::string text;
  for (int i = 0; i < 10'000; ++i) text += static_cast<char>(i % 251);
  Xxh3Digest digest;
  digest.update(bytes(text));
  EXPECT_EQ(digest.hex(), "89dec82a789965e61cb3abee1c2fc1c4");
}

TEST(Digest, DoesNotDependOnHowTheBytesAreCut) {
  const std::string text(10'000, 'x');
  Xxh3Digest whole;
  whole.update(bytes(text));
  Xxh3Digest parts;
  for (std::size_t at = 0, part = 1; at < text.size(); at += part, part = part * 3 % 257 + 1) {
    parts.update(bytes(std::string_view(text).substr(at, part)));
  }
  EXPECT_EQ(whole.hex(), parts.hex());
  EXPECT_EQ(text_digest(text), std::string(digest_name) + ":" + whole.hex());
}

TEST(Digest, OneBitMakesAnother) { EXPECT_NE(text_digest("a"), text_digest("c")); }

TEST(Digest, TextNamesTheFunctionAndAppendsTheLedger) {
  Xxh3Digest run;
  Xxh3Digest ledger;
  ledger.update(bytes("abc"));
  EXPECT_EQ(digest_text(run, nullptr), "xxh3-128/1:99aa06d3014798d86001c324468d497f");
  EXPECT_EQ(digest_text(run, &ledger),
            "xxh3-128/1:99aa06d3014798d86001c324468d497f+06b05ab6733a618578af5f94892f3950");
}

TEST(Digest, MayBeReadBeforeTheEnd) {
  Xxh3Digest digest;
  EXPECT_EQ(digest.hex(), "99aa06d3014798d86001c324468d497f");
  digest.update(bytes("abc"));
  EXPECT_EQ(digest.hex(), "06b05ab6733a618578af5f94892f3950");
}

}  // namespace
}  // namespace hearsay
