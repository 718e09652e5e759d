#include "sim/kernel/random.hpp"

#include <Random123/threefry.h>

#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {

namespace {

using Threefry = r123::Threefry2x64_R<13>;

// Of a count: its own blocks, 2^16 of them.
constexpr int blocks_bits = 16;

// Mean from which on a Poisson draw is by rejection.
constexpr double poisson_inversion_below = 10.0;

// A block of a stream: two words.
[[gnu::always_inline]] inline Threefry::ctr_type block(std::uint64_t seed, std::uint64_t purpose,
                                                       std::uint64_t number, std::uint64_t entity) {
  const Threefry::ctr_type counter = {{number, entity}};
  const Threefry::key_type key = {{seed, purpose}};
  return Threefry()(counter, key);
}

double to_uniform(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

void check_count(std::uint64_t count) {
  require(count < (std::uint64_t{1} << 48), "a stream was asked for a count of 2^48 or more");
}

std::uint64_t poisson_by_inversion(double mean, double u) {
  double probability = math::exp(-mean);
  double below = probability;
  std::uint64_t k = 0;
  // Rounding may keep the sum below the largest u; nothing as likely as 2^-53 lies past 100.
  while (u >= below && k < 100) {
    ++k;
    probability *= mean / static_cast<double>(k);
    below += probability;
  }
  return k;
}

}  // namespace

Stream::Stream(std::uint64_t seed, Purpose purpose, Entity entity)
    : Stream(seed, purpose, entity, 0) {}

Stream::Stream(std::uint64_t seed, Purpose purpose, Entity entity, std::uint64_t first_block)
    : key_{seed, purpose.hash()}, entity_(entity.key), block_(first_block) {}

Stream Stream::at(std::uint64_t seed, Purpose purpose, Entity entity, std::uint64_t count) {
  check_count(count);
  return Stream(seed, purpose, entity, count << blocks_bits);
}

double Stream::uniform_at(std::uint64_t seed, Purpose purpose, Entity entity, std::uint64_t count) {
  check_count(count);
  return to_uniform(block(seed, purpose.hash(), count << blocks_bits, entity.key)[0]);
}

std::uint64_t Stream::bits() {
  if (has_spare_bits_) {
    has_spare_bits_ = false;
    return spare_bits_;
  }
  const Threefry::ctr_type words = block(key_[0], key_[1], block_++, entity_);
  spare_bits_ = words[1];
  has_spare_bits_ = true;
  return words[0];
}

double Stream::uniform() { return to_uniform(bits()); }

double Stream::uniform(double low, double high) {
  const double width = high - low;
  require(low <= high && std::isfinite(width), "uniform(low, high) needs finite low <= high");
  const double value = low + width * uniform();
  // The sum may round up to `high`, which is not in the interval.
  return value < high || low == high ? value : std::nextafter(high, low);
}

std::uint64_t Stream::below(std::uint64_t n) {
  require(n >= 1, "below(n) needs n >= 1");
  const std::uint64_t rejected = (0 - n) % n;  // 2^64 mod n: what is left over of whole rounds
  std::uint64_t word = bits();
  while (word < rejected) word = bits();
  return word % n;
}

double Stream::normal() {
  if (has_spare_normal_) {
    has_spare_normal_ = false;
    return spare_normal_;
  }
  const double radius = std::sqrt(-2.0 * math::log(1.0 - uniform()));
  const double angle = 2.0 * math::pi * uniform();
  spare_normal_ = radius * math::sin(angle);
  has_spare_normal_ = true;
  return radius * math::cos(angle);
}

double Stream::exponential(double rate) {
  require(rate > 0.0, "exponential(rate) needs a rate above 0");
  return -math::log(1.0 - uniform()) / rate;
}

std::uint64_t Stream::poisson(double mean) {
  require(mean >= 0.0 && mean <= 1e9, "poisson(mean) needs a mean in [0, 1e9]");
  if (mean < poisson_inversion_below) return poisson_by_inversion(mean, uniform());
  // W. Hörmann, The transformed rejection method for generating Poisson random variables,
  // Insurance: Mathematics and Economics 12 (1993), algorithm PTRS; symbols as there.
  const double b = 0.931 + 2.53 * std::sqrt(mean);
  const double a = -0.059 + 0.02483 * b;
  const double v_r = 0.9277 - 3.6224 / (b - 2.0);
  const double inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
  const double log_mean = math::log(mean);
  for (;;) {
    const double u = uniform() - 0.5;
    const double v = 1.0 - uniform();
    const double us = 0.5 - std::fabs(u);
    const double k = std::floor((2.0 * a / us + b) * u + mean + 0.43);
    if (us >= 0.07 && v <= v_r) return static_cast<std::uint64_t>(k);
    if (k < 0.0 || (us < 0.013 && v > us)) continue;
    if (math::log(v * inverse_alpha / (a / (us * us) + b)) <=
        k * log_mean - mean - math::lgamma(k + 1.0)) {
      return static_cast<std::uint64_t>(k);
    }
  }
}

}  // namespace hearsay
