#include "filters/grid/fusion.hpp"

#include <cmath>
#include <cstddef>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::grid {
namespace {

struct Limits {
  float least, greatest;
  float operator()(float x) const {
    const float low = x < least ? least : x;
    return low > greatest ? greatest : low;
  }
};

/// own[i] = limits(f(own[i], received[i])). Plain loops, which compilers vectorise.
template <typename F>
void each(std::span<float> own, std::span<const float> received, const Limits& limits, F f) {
  float* const o = own.data();
  const float* const r = received.data();
  const std::size_t n = own.size();
  for (std::size_t i = 0; i < n; ++i) o[i] = limits(f(o[i], r[i]));
}

void add(std::span<float> own, const Heard& heard, const Limits& limits) {
  each(own, heard.received, limits, [](float a, float b) { return a + b; });
}

void add_less_common(std::span<float> own, const Heard& heard, const Limits& limits) {
  float* const o = own.data();
  const float* const r = heard.received.data();
  const float* const c = heard.common.data();
  const std::size_t n = own.size();
  for (std::size_t i = 0; i < n; ++i) o[i] = limits((o[i] + r[i]) - c[i]);
}

void larger(std::span<float> own, const Heard& heard, const Limits& limits) {
  each(own, heard.received, limits, [](float a, float b) { return b > a ? b : a; });
}

/// In double, so that equal numbers stay as they are for any ω.
void weighted(std::span<float> own, const Heard& heard, const Limits& limits, double omega) {
  each(own, heard.received, limits, [omega](float a, float b) {
    return static_cast<float>(omega * static_cast<double>(a) +
                              (1.0 - omega) * static_cast<double>(b));
  });
}

/// The one farther from −`offset`, the larger of two equally far.
void farther(std::span<float> own, const Heard& heard, const Limits& limits, double offset) {
  each(own, heard.received, limits, [offset](float a, float b) {
    const double l = std::fabs(static_cast<double>(a) + offset);
    const double m = std::fabs(static_cast<double>(b) + offset);
    return m > l || (m == l && b > a) ? b : a;
  });
}

void pool_linearly(std::span<float> own, const Heard& heard, const Limits& limits, double prior,
                   double omega) {
  each(own, heard.received, limits, [prior, omega](float a, float b) {
    if (a == b) return a;
    const double l = prior + static_cast<double>(a), m = prior + static_cast<double>(b);
    const double p = omega * probability_of(l) + (1.0 - omega) * probability_of(m);
    const double q = omega * probability_of(-l) + (1.0 - omega) * probability_of(-m);
    return static_cast<float>(math::log(p) - math::log(q) - prior);
  });
}

/// Should b be believed rather than a? No Beta at all is as good as no belief.
bool more_certain(const Beta& b, const Beta& a) {
  if (!b.exists() || !a.exists()) return b.exists();
  const double h_b = entropy(b), h_a = entropy(a);
  if (h_b != h_a) return h_b < h_a;
  return b.alpha > a.alpha || (b.alpha == a.alpha && b.beta > a.beta);
}

void dictate(std::span<float> own, const Heard& heard, const Limits& limits, const Beta& prior) {
  for (std::size_t i = 0; i + 1 < own.size(); i += BetaGrid::layers) {
    const float m = limits(heard.received[i]), n = limits(heard.received[i + 1]);
    if (m == own[i] && n == own[i + 1]) continue;
    const Beta a{prior.alpha + static_cast<double>(own[i]),
                 prior.beta + static_cast<double>(own[i + 1])};
    const Beta b{prior.alpha + static_cast<double>(m), prior.beta + static_cast<double>(n)};
    if (!more_certain(b, a)) continue;
    own[i] = m;
    own[i + 1] = n;
  }
}

/// The range of `own` that was heard.
template <typename Grid>
std::span<float> range(Rule rule, Grid& own, const Heard& heard, double omega) {
  const std::size_t size = heard.received.size();
  const auto first = Grid::layers * static_cast<std::size_t>(heard.first_cell);
  const std::span<float> all = own.evidence_mutable();
  require(heard.first_cell >= 0 && first <= all.size() && size <= all.size() - first &&
              size % Grid::layers == 0,
          "fuse: a range of cells that is not in the grid");
  require(info(rule).memory == Memory::nothing || heard.common.size() == size,
          "fuse: this rule needs what is common, for the cells heard");
  require(omega >= 0.0 && omega <= 1.0, "fuse: a weight is in [0, 1]");
  return all.subspan(first, size);
}

/// The rules that treat each number alike, whatever it is. False if `rule` is none of them.
bool fuse_numbers(Rule rule, std::span<float> own, const Heard& heard, const Limits& limits,
                  double omega) {
  switch (rule) {
    case Rule::none:
      return true;
    case Rule::naive:
      add(own, heard, limits);
      return true;
    case Rule::channel:
    case Rule::channel_robust:
      add_less_common(own, heard, limits);
      return true;
    case Rule::maximum:
    case Rule::elementwise_maximum:
      larger(own, heard, limits);
      return true;
    case Rule::geometric_mean:
    case Rule::averaged_parameters:
      weighted(own, heard, limits, omega);
      return true;
    case Rule::strongest:
    case Rule::dictatorship:
    case Rule::linear_pool:
      break;
  }
  return false;
}

}  // namespace

void fuse(Rule rule, BernoulliGrid& own, const Heard& heard, double omega) {
  require(info(rule).bernoulli, "fuse: a rule that is not for Bernoulli grids");
  const std::span<float> cells = range(rule, own, heard, omega);
  const Limits limits{own.least(), own.greatest()};
  if (fuse_numbers(rule, cells, heard, limits, omega)) return;
  if (rule == Rule::linear_pool) {
    pool_linearly(cells, heard, limits, own.prior_log_odds(), omega);
  } else {
    farther(cells, heard, limits, rule == Rule::dictatorship ? own.prior_log_odds() : 0.0);
  }
}

void fuse(Rule rule, BetaGrid& own, const Heard& heard, double omega) {
  require(info(rule).beta, "fuse: a rule that is not for Beta grids");
  const std::span<float> cells = range(rule, own, heard, omega);
  const Limits limits{own.least(), own.greatest()};
  if (!fuse_numbers(rule, cells, heard, limits, omega)) dictate(cells, heard, limits, own.prior());
}

void less_heard(std::span<const float> own, std::span<const float> heard, std::span<float> out) {
  require(own.size() == heard.size() && own.size() == out.size(),
          "less_heard: evidence of different lengths");
  for (std::size_t i = 0; i < own.size(); ++i) out[i] = own[i] - heard[i];
}

}  // namespace hearsay::grid
