#include "filters/grid/fusion.hpp"

#include <algorithm>
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

bool is_larger(float b, float a) { return b > a; }

void larger(std::span<float> own, const Heard& heard, const Limits& limits) {
  each(own, heard.received, limits, [](float a, float b) { return is_larger(b, a) ? b : a; });
}

/// In double, so that equal numbers stay as they are for any ω.
void weighted(std::span<float> own, const Heard& heard, const Limits& limits, double omega) {
  each(own, heard.received, limits, [omega](float a, float b) {
    return static_cast<float>(omega * static_cast<double>(a) +
                              (1.0 - omega) * static_cast<double>(b));
  });
}

/// Is b farther from −`offset` than a, or the larger of two equally far?
bool is_farther(float b, float a, double offset) {
  const double l = std::fabs(static_cast<double>(a) + offset);
  const double m = std::fabs(static_cast<double>(b) + offset);
  return m > l || (m == l && b > a);
}

void farther(std::span<float> own, const Heard& heard, const Limits& limits, double offset) {
  each(own, heard.received, limits,
       [offset](float a, float b) { return is_farther(b, a, offset) ? b : a; });
}

/// The evidence of ω·p_own + (1−ω)·p_received.
double pooled(float a, float b, double prior, double omega) {
  const double l = prior + static_cast<double>(a), m = prior + static_cast<double>(b);
  const double p = omega * probability_of(l) + (1.0 - omega) * probability_of(m);
  const double q = omega * probability_of(-l) + (1.0 - omega) * probability_of(-m);
  return math::log(p) - math::log(q) - prior;
}

void pool_linearly(std::span<float> own, const Heard& heard, const Limits& limits, double prior,
                   double omega) {
  each(own, heard.received, limits, [prior, omega](float a, float b) {
    return a == b ? a : static_cast<float>(pooled(a, b, prior, omega));
  });
}

/// Should b be believed rather than a? No Beta at all is as good as no belief.
bool more_certain(const Beta& b, const Beta& a) {
  if (!b.exists() || !a.exists()) return b.exists();
  const double h_b = entropy(b), h_a = entropy(a);
  if (h_b != h_a) return h_b < h_a;
  return b.alpha > a.alpha || (b.alpha == a.alpha && b.beta > a.beta);
}

/// Do the counts b (m, n) dictate to the counts a?
bool dictates(const float* b, const float* a, const Beta& prior) {
  if (b[0] == a[0] && b[1] == a[1]) return false;
  return more_certain(
      {prior.alpha + static_cast<double>(b[0]), prior.beta + static_cast<double>(b[1])},
      {prior.alpha + static_cast<double>(a[0]), prior.beta + static_cast<double>(a[1])});
}

void dictate(std::span<float> own, const Heard& heard, const Limits& limits, const Beta& prior) {
  for (std::size_t i = 0; i + 1 < own.size(); i += BetaGrid::layers) {
    const float b[] = {limits(heard.received[i]), limits(heard.received[i + 1])};
    if (!dictates(b, &own[i], prior)) continue;
    own[i] = b[0];
    own[i + 1] = b[1];
  }
}

/// The range that was heard, of `all` numbers of one's own grid.
template <typename Number>
std::span<Number> range(Rule rule, std::span<Number> all, std::size_t layers, const Heard& heard,
                        double omega) {
  const std::size_t size = heard.received.size();
  const auto first = layers * static_cast<std::size_t>(heard.first_cell);
  require(heard.first_cell >= 0 && first <= all.size() && size <= all.size() - first &&
              size % layers == 0,
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

/// out[i] = all of one side's number: received[i] where received_wins(i), else own[i].
template <typename F>
void share_by_choice(std::span<Shares> out, F received_wins) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = received_wins(i) ? Shares{0.0, 1.0, 0.0} : Shares{1.0, 0.0, 0.0};
  }
}

/// As fuse_numbers().
bool share_numbers(Rule rule, std::span<const float> own, const Heard& heard, double omega,
                   std::span<Shares> out) {
  switch (rule) {
    case Rule::none:
      std::fill(out.begin(), out.end(), Shares{1.0, 0.0, 0.0});
      return true;
    case Rule::naive:
      std::fill(out.begin(), out.end(), Shares{1.0, 1.0, 0.0});
      return true;
    case Rule::channel:
    case Rule::channel_robust:
      std::fill(out.begin(), out.end(), Shares{1.0, 1.0, 1.0});
      return true;
    case Rule::maximum:
    case Rule::elementwise_maximum:
      share_by_choice(out, [&](std::size_t i) { return is_larger(heard.received[i], own[i]); });
      return true;
    case Rule::geometric_mean:
    case Rule::averaged_parameters:
      std::fill(out.begin(), out.end(), Shares{omega, 1.0 - omega, 0.0});
      return true;
    case Rule::strongest:
    case Rule::dictatorship:
    case Rule::linear_pool:
      break;
  }
  return false;
}

/// λ = (e − b)/(a − b): the result e of linear-pool lies between a and b, so 0 ≤ λ ≤ 1.
Shares shares_of_pool(float a, float b, double prior, double omega) {
  if (a == b) return {omega, 1.0 - omega, 0.0};
  const double from_b = pooled(a, b, prior, omega) - static_cast<double>(b);
  const double all = static_cast<double>(a) - static_cast<double>(b);
  const double lambda = std::clamp(from_b / all, 0.0, 1.0);  // rounding may lead just outside
  return {lambda, 1.0 - lambda, 0.0};
}

}  // namespace

void fuse(Rule rule, BernoulliGrid& own, const Heard& heard, double omega) {
  require(info(rule).bernoulli, "fuse: a rule that is not for Bernoulli grids");
  const auto cells = range(rule, own.evidence_mutable(), BernoulliGrid::layers, heard, omega);
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
  const auto cells = range(rule, own.evidence_mutable(), BetaGrid::layers, heard, omega);
  const Limits limits{own.least(), own.greatest()};
  if (!fuse_numbers(rule, cells, heard, limits, omega)) dictate(cells, heard, limits, own.prior());
}

void shares(Rule rule, const BernoulliGrid& own, const Heard& heard, double omega,
            std::span<Shares> out) {
  require(info(rule).bernoulli, "shares: a rule that is not for Bernoulli grids");
  const auto cells = range(rule, own.evidence(), BernoulliGrid::layers, heard, omega);
  require(out.size() == cells.size(), "shares: not as many as there are numbers");
  if (share_numbers(rule, cells, heard, omega, out)) return;
  const double prior = own.prior_log_odds();
  if (rule == Rule::linear_pool) {
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = shares_of_pool(cells[i], heard.received[i], prior, omega);
    }
    return;
  }
  const double offset = rule == Rule::dictatorship ? prior : 0.0;
  share_by_choice(out,
                  [&](std::size_t i) { return is_farther(heard.received[i], cells[i], offset); });
}

void shares(Rule rule, const BetaGrid& own, const Heard& heard, double omega,
            std::span<Shares> out) {
  require(info(rule).beta, "shares: a rule that is not for Beta grids");
  const auto cells = range(rule, own.evidence(), BetaGrid::layers, heard, omega);
  require(out.size() == cells.size(), "shares: not as many as there are numbers");
  if (share_numbers(rule, cells, heard, omega, out)) return;
  const Limits limits{own.least(), own.greatest()};
  for (std::size_t i = 0; i + 1 < out.size(); i += BetaGrid::layers) {
    const float b[] = {limits(heard.received[i]), limits(heard.received[i + 1])};
    const bool received_wins = dictates(b, &cells[i], own.prior());
    share_by_choice(out.subspan(i, BetaGrid::layers), [&](std::size_t) { return received_wins; });
  }
}

void less_heard(std::span<const float> own, std::span<const float> heard, std::span<float> out) {
  require(own.size() == heard.size() && own.size() == out.size(),
          "less_heard: evidence of different lengths");
  for (std::size_t i = 0; i < own.size(); ++i) out[i] = own[i] - heard[i];
}

}  // namespace hearsay::grid
