// Counter-based random streams, named by (seed, purpose, entity).
//
// A draw is a pure function of its name and its count: Threefry2x64-13 (Salmon et al., SC 2011; the
// Random123 library) with key (seed, purpose) and counter (count, entity). Nothing is shared, so a
// new consumer never shifts what another one draws, and any draw can be repeated alone. That is
// what makes comparisons of fusion rules paired: truth, noise and channel are the same under each.
//
// Layout: word 2b + i of a stream is output i of Threefry2x64-13 with key (seed, purpose hash) and
// counter (b, entity). A Stream starts at block b = 0; Stream::at(count) at block count·2^16, where
// 2^16 blocks, hence 131,072 words, belong to that count. So one name serves either as one long
// stream or as many short ones, never as both: they would overlap.
#pragma once

#include <cstdint>
#include <string_view>

#include "sim/kernel/ids.hpp"

namespace hearsay {

/// What draws are for, as a name: Purpose("loss"), Purpose("sensor noise"). Equal names are equal
/// purposes (64-bit FNV-1a of the text).
class Purpose {
 public:
  constexpr explicit Purpose(std::string_view name) {
    for (const char c : name) {
      hash_ = (hash_ ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    }
  }
  constexpr std::uint64_t hash() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

/// Whose draws: an agent, a directed link between two agents, an agent's n-th sensor.
struct Entity {
  std::uint64_t key;
  static constexpr Entity agent(AgentId a) { return {static_cast<std::uint32_t>(a)}; }
  static constexpr Entity link(AgentId from, AgentId to) {
    return {(std::uint64_t{static_cast<std::uint32_t>(from)} << 32) |
            static_cast<std::uint32_t>(to)};
  }
  static constexpr Entity sensor(AgentId a, std::uint32_t n) {
    return {(std::uint64_t{n} << 32) | static_cast<std::uint32_t>(a)};
  }
};

/// A sequence of draws. Copyable; a copy goes on from where the original stood. An argument out of
/// its range is a BrokenInvariant.
class Stream {
 public:
  /// The sequence named (seed, purpose, entity), from its start.
  Stream(std::uint64_t seed, Purpose purpose, Entity entity);

  /// The short sequence that belongs to the `count`-th thing of that name (the n-th packet on a
  /// link, the n-th measurement of a sensor): at most 131,072 words of it may be drawn, and
  /// `count` < 2^48 (else BrokenInvariant).
  static Stream at(std::uint64_t seed, Purpose purpose, Entity entity, std::uint64_t count);

  /// at(seed, purpose, entity, count).uniform(): the cheapest way to a single draw.
  static double uniform_at(std::uint64_t seed, Purpose purpose, Entity entity, std::uint64_t count);

  /// 64 random bits.
  std::uint64_t bits();
  /// Uniform on [0, 1), a multiple of 2^-53.
  double uniform();
  /// Uniform on [low, high), low ≤ high, both finite.
  double uniform(double low, double high);
  /// Uniform on {0, …, n − 1} without bias (rejection); n ≥ 1.
  std::uint64_t below(std::uint64_t n);
  /// Normal with mean 0 and variance 1 (Box–Muller, both halves used).
  double normal();
  /// Normal; sigma ≥ 0.
  double normal(double mean, double sigma) { return mean + sigma * normal(); }
  /// Exponential with the given rate > 0 (mean 1/rate).
  double exponential(double rate);
  /// True with probability p in [0, 1]. Consumes one uniform whatever p.
  bool bernoulli(double p) { return uniform() < p; }
  /// Poisson; 0 ≤ mean ≤ 1e9. Sequential inversion below 10, Hörmann's PTRS (1993) above.
  std::uint64_t poisson(double mean);

 private:
  Stream(std::uint64_t seed, Purpose purpose, Entity entity, std::uint64_t first_block);

  std::uint64_t key_[2];
  std::uint64_t entity_;
  std::uint64_t block_;
  std::uint64_t spare_bits_ = 0;
  double spare_normal_ = 0.0;
  bool has_spare_bits_ = false;
  bool has_spare_normal_ = false;
};

}  // namespace hearsay
