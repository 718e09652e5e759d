// Which numbers come, to the bit.
#include "sim/kernel/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using Words = std::array<std::uint64_t, 2>;

// Threefry2x64 with 13 rounds once more, from the paper's description (SC 2011, section 3.2).
Words threefry13(Words counter, Words key) {
  constexpr int rotations[] = {16, 42, 12, 31, 16, 32, 24, 21};
  const std::uint64_t schedule[] = {key[0], key[1], 0x1bd11bdaa9fc1a22 ^ key[0] ^ key[1]};
  auto [a, b] = counter;
  a += schedule[0];
  b += schedule[1];
  for (int round = 0; round < 13; ++round) {
    const int turn = rotations[round % 8];
    a += b;
    b = (b << turn) | (b >> (64 - turn));
    b ^= a;
    if (round % 4 == 3) {
      const int step = (round + 1) / 4;
      a += schedule[step % 3];
      b += schedule[(step + 1) % 3] + static_cast<std::uint64_t>(step);
    }
  }
  return {a, b};
}

Stream pinned() { return Stream(1, Purpose("pinned"), Entity::agent(0)); }

TEST(Threefry, TheTestsOwnVersionGivesThePublishedAnswers) {
  constexpr std::uint64_t ones = ~std::uint64_t{0};
  EXPECT_EQ(threefry13({0, 0}, {0, 0}), (Words{0xf167b032c3b480bd, 0xe91f9fee4b7a6fb5}));
  EXPECT_EQ(threefry13({ones, ones}, {ones, ones}),
            (Words{0xccdec5c917a874b1, 0x4df53abca26ceb01}));
  EXPECT_EQ(threefry13({0x243f6a8885a308d3, 0x13198a2e03707344},
                       {0xa4093822299f31d0, 0x082efa98ec4e6c89}),
            (Words{0xc3aac71561042993, 0x3fe7ae8801aff316}));
}

TEST(Stream, IsThreefryOfItsNameAndItsCount) {
  const std::uint64_t seed = 0x0123456789abcdef;
  const Purpose purpose("loss");
  const Entity entity = Entity::link(3, 4);
  Stream stream(seed, purpose, entity);
  for (std::uint64_t block = 0; block < 1000; ++block) {
    const Words words = threefry13({block, entity.key}, {seed, purpose.hash()});
    EXPECT_EQ(stream.bits(), words[0]);
    EXPECT_EQ(stream.bits(), words[1]);
  }
}

TEST(Stream, AtACountIsThreefryFromThatCountsFirstBlock) {
  const Purpose purpose("sensor noise");
  const Entity entity = Entity::sensor(3, 1);
  for (const std::uint64_t count :
       {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{123'456}, (std::uint64_t{1} << 48) - 1}) {
    EXPECT_EQ(Stream::uniform_at(9, purpose, entity, count),
              Stream::at(9, purpose, entity, count).uniform());
    Stream stream = Stream::at(9, purpose, entity, count);
    for (std::uint64_t block = 0; block < 3; ++block) {
      const Words words = threefry13({(count << 16) + block, entity.key}, {9, purpose.hash()});
      EXPECT_EQ(stream.bits(), words[0]);
      EXPECT_EQ(stream.bits(), words[1]);
    }
  }
  EXPECT_THROW((void)Stream::at(9, purpose, entity, std::uint64_t{1} << 48), BrokenInvariant);
  EXPECT_THROW((void)Stream::uniform_at(9, purpose, entity, std::uint64_t{1} << 48),
               BrokenInvariant);
}

TEST(Purpose, IsFnv1aOfItsName) {
  EXPECT_EQ(Purpose("").hash(), 0xcbf29ce484222325);
  EXPECT_EQ(Purpose("a").hash(), 0xaf63dc4c8601ec8c);
  EXPECT_EQ(Purpose("foobar").hash(), 0x85944171f73967e8);
}

TEST(Stream, EveryPartOfTheNameMatters) {
  std::set<std::uint64_t> first;
  for (const std::uint64_t seed : {1u, 2u}) {
    for (const char* purpose : {"loss", "noise"}) {
      for (const Entity entity : {Entity::agent(0), Entity::agent(1), Entity::agent(central_agent),
                                  Entity::link(1, 2), Entity::link(2, 1), Entity::sensor(1, 2)}) {
        first.insert(Stream(seed, Purpose(purpose), entity).bits());
        first.insert(Stream::at(seed, Purpose(purpose), entity, 1).bits());
      }
    }
  }
  // Sensor 2 of agent 1 and the link from 2 to 1 share a key: purposes tell them apart.
  EXPECT_EQ(first.size(), 2u * 2 * 5 * 2);
}

TEST(Stream, ACopyGoesOnFromWhereTheOriginalStood) {
  Stream stream = pinned();
  (void)stream.bits();
  (void)stream.normal();
  Stream copy = stream;
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(stream.normal(), copy.normal());
    EXPECT_EQ(stream.bits(), copy.bits());
  }
}

TEST(PinnedDraws, OfBits) {
  Stream stream = pinned();
  for (const std::uint64_t word :
       {0xb4d2a360e5c8893cu, 0x3302c6e50efbb758u, 0xc8bd1ae3d8eb7806u, 0xd86608a62bd1073eu}) {
    EXPECT_EQ(stream.bits(), word);
  }
  Stream at = Stream::at(1, Purpose("pinned"), Entity::link(2, 3), 77);
  EXPECT_EQ(at.bits(), 0x953907192fbd3f25);
  EXPECT_EQ(at.bits(), 0xc1004a2319c6f3b5);
}

TEST(PinnedDraws, OfUniform) {
  Stream stream = pinned();
  for (const double value :
       {0x1.69a546c1cb911p-1, 0x1.9816372877dd8p-3, 0x1.917a35c7b1d6fp-1, 0x1.b0cc114c57a2p-1}) {
    EXPECT_EQ(stream.uniform(), value);
  }
  stream = pinned();
  for (const double value :
       {0x1.534a8d8397222p+1, -0x1.67e9c8d788228p+0, 0x1.a2f46b8f63adep+1, 0x1.e1982298af44p+1}) {
    EXPECT_EQ(stream.uniform(-3, 5), value);
  }
}

TEST(PinnedDraws, OfBelow) {
  Stream stream = pinned();
  for (const std::uint64_t value : {0, 6, 4, 8, 6, 6, 0, 9}) EXPECT_EQ(stream.below(10), value);
}

TEST(PinnedDraws, OfNormal) {
  Stream stream = pinned();
  for (const double value :
       {0x1.f66f89b088187p-2, 0x1.7c9053cbe6d54p+0, 0x1.f95c4dc40e324p-1, -0x1.7245131e93c1p+0}) {
    EXPECT_EQ(stream.normal(), value);
  }
}

TEST(PinnedDraws, OfExponential) {
  Stream stream = pinned();
  for (const double value :
       {0x1.39af3216a3448p-1, 0x1.c71b7aa23090dp-4, 0x1.88798876c9131p-1, 0x1.ddc6a2f1dd00bp-1}) {
    EXPECT_EQ(stream.exponential(2.0), value);
  }
}

TEST(PinnedDraws, OfBernoulli) {
  Stream stream = pinned();
  for (const bool value : {false, true, false, false, true, true, false, false}) {
    EXPECT_EQ(stream.bernoulli(0.5), value);
  }
}

TEST(PinnedDraws, OfPoisson) {
  Stream stream = pinned();
  for (const std::uint64_t value : {5, 2, 5, 6, 3, 4}) EXPECT_EQ(stream.poisson(4.0), value);
  stream = pinned();
  for (const std::uint64_t value : {1019, 1028, 984, 1042, 960, 971}) {
    EXPECT_EQ(stream.poisson(1000.0), value);
  }
  // So many that each branch of the rejection and each of its constants has its part.
  std::uint64_t sum = 0;
  for (std::uint64_t i = 0; i < 100'000; ++i) sum = sum * 31 + stream.poisson(20.0);
  EXPECT_EQ(sum, 389301220041081623u);
}

TEST(Draws, FollowFromTheWordsByTheirFormulas) {
  Stream words = pinned();
  std::vector<double> u;
  for (int i = 0; i < 400; ++i)
    u.push_back(std::ldexp(static_cast<double>(words.bits() >> 11), -53));
  Stream uniform = pinned();
  Stream normal = pinned();
  Stream exponential = pinned();
  for (int i = 0; i < 400; i += 2) {
    EXPECT_EQ(uniform.uniform(), u[i]);
    EXPECT_EQ(uniform.uniform(), u[i + 1]);
    const double radius = std::sqrt(-2 * std::log(1 - u[i]));
    EXPECT_NEAR(normal.normal(), radius * std::cos(2 * M_PI * u[i + 1]), 1e-14);
    EXPECT_NEAR(normal.normal(), radius * std::sin(2 * M_PI * u[i + 1]), 1e-14);
    EXPECT_NEAR(exponential.exponential(0.25), -4 * std::log(1 - u[i]), 1e-13);
    EXPECT_NEAR(exponential.exponential(0.25), -4 * std::log(1 - u[i + 1]), 1e-13);
  }
}

TEST(Draws, BernoulliTakesOneUniformWhateverItsProbability) {
  for (const double p : {0.0, 0.3, 1.0}) {
    Stream stream = pinned();
    Stream reference = pinned();
    const double u = reference.uniform();
    EXPECT_EQ(stream.bernoulli(p), u < p);
    EXPECT_EQ(stream.bits(), reference.bits());
  }
}

TEST(Draws, BelowRejectsTheWordsThatWouldBiasIt) {
  // 2^64 mod n is n − 2^63 + … : with n = 3·2^62 a quarter of all words is left over.
  const std::uint64_t n = std::uint64_t{3} << 62;
  Stream words = pinned();
  Stream stream = pinned();
  for (int i = 0; i < 1000; ++i) {
    std::uint64_t word = words.bits();
    while (word < (std::uint64_t{1} << 62)) word = words.bits();
    EXPECT_EQ(stream.below(n), word % n);
  }
  EXPECT_EQ(stream.below(1), 0u);
}

TEST(Draws, OutOfTheirRangeAreRefused) {
  Stream stream = pinned();
  EXPECT_THROW((void)stream.below(0), BrokenInvariant);
  EXPECT_THROW((void)stream.uniform(1.0, 0.0), BrokenInvariant);
  EXPECT_THROW((void)stream.uniform(0.0, INFINITY), BrokenInvariant);
  EXPECT_THROW((void)stream.uniform(NAN, 1.0), BrokenInvariant);
  EXPECT_THROW((void)stream.exponential(0.0), BrokenInvariant);
  EXPECT_THROW((void)stream.exponential(NAN), BrokenInvariant);
  EXPECT_THROW((void)stream.poisson(-1.0), BrokenInvariant);
  EXPECT_THROW((void)stream.poisson(2e9), BrokenInvariant);
}

TEST(Draws, AtTheEdgesAreWhatTheyMustBe) {
  Stream stream = pinned();
  const double next = std::nextafter(1.0, 2.0);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(stream.uniform(2.5, 2.5), 2.5);
    EXPECT_EQ(stream.uniform(1.0, next), 1.0);  // the only double in [1, next)
    EXPECT_EQ(stream.poisson(0.0), 0u);
    EXPECT_EQ(stream.normal(3.0, 0.0), 3.0);
    EXPECT_FALSE(stream.bernoulli(0.0));
    EXPECT_TRUE(stream.bernoulli(1.0));
  }
}

}  // namespace
}  // namespace hearsay
