#include "filters/grid/bernoulli.hpp"

#include <algorithm>
#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::grid {
namespace {

/// log(1 + exp(x)) for x ≤ 0 and beyond, without overflow.
double soft_plus(double x) {
  return x > 0.0 ? x + math::log1p(math::exp(-x)) : math::log1p(math::exp(x));
}

/// The greatest float not above x.
float rounded_down(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafterf(f, -HUGE_VALF) : f;
}

}  // namespace

double probability_of(double log_odds) {
  const double small = math::exp(-std::fabs(log_odds));
  return (log_odds < 0.0 ? small : 1.0) / (1.0 + small);
}

double log_odds_of(double probability) {
  require(probability >= 0.0 && probability <= 1.0, "log-odds: a probability is in [0, 1]");
  if (probability == 0.0) return -HUGE_VAL;
  if (probability == 1.0) return HUGE_VAL;
  return math::log(probability) - math::log1p(-probability);
}

double bernoulli_entropy(double log_odds) {
  const double a = std::fabs(log_odds);
  const double small = math::exp(-a);
  if (small == 0.0) return 0.0;
  return math::log1p(small) + a * small / (1.0 + small);
}

double bernoulli_divergence(double log_odds_p, double log_odds_q) {
  // D is the same for the complements: with p ≤ ½ nothing cancels that matters.
  const double sign = log_odds_p > 0.0 ? -1.0 : 1.0;
  const double l = sign * log_odds_p, m = sign * log_odds_q;
  const double d = probability_of(l) * (l - m) + (soft_plus(m) - soft_plus(l));
  return d > 0.0 ? d : 0.0;
}

BernoulliGrid::BernoulliGrid(const Area& area, const Options& options)
    : area_(area), evidence_(static_cast<std::size_t>(area.cells()), 0.0F) {
  require(options.prior > 0.0 && options.prior < 1.0, "BernoulliGrid: the prior is in (0, 1)");
  require(options.limit > 0.0 && options.limit <= limit_max,
          "BernoulliGrid: the limit of log-odds is in (0, 64]");
  prior_ = log_odds_of(options.prior);
  require(std::fabs(prior_) <= options.limit, "BernoulliGrid: the prior is beyond the limit");
  least_ = -rounded_down(options.limit + prior_);
  greatest_ = rounded_down(options.limit - prior_);
}

void BernoulliGrid::add(int number, double log_likelihood_ratio) {
  require(area_.has(number), "BernoulliGrid: no cell of this number");
  require(!std::isnan(log_likelihood_ratio), "BernoulliGrid: a log-likelihood ratio is a number");
  float& e = evidence_[static_cast<std::size_t>(number)];
  const double sum = static_cast<double>(e) + log_likelihood_ratio;
  e = static_cast<float>(
      std::clamp(sum, static_cast<double>(least_), static_cast<double>(greatest_)));
}

void BernoulliGrid::clear() { std::fill(evidence_.begin(), evidence_.end(), 0.0F); }

double BernoulliGrid::log_odds(int number) const {
  require(area_.has(number), "BernoulliGrid: no cell of this number");
  return prior_ + static_cast<double>(evidence_[static_cast<std::size_t>(number)]);
}

double BernoulliGrid::total_entropy() const {
  double sum = 0.0;
  for (const float e : evidence_) sum += bernoulli_entropy(prior_ + static_cast<double>(e));
  return sum;
}

double BernoulliGrid::divergence(const BernoulliGrid& other) const {
  require(area_ == other.area_, "BernoulliGrid: grids over different areas");
  double sum = 0.0;
  for (std::size_t i = 0; i < evidence_.size(); ++i) {
    const double l = prior_ + static_cast<double>(evidence_[i]);
    const double m = other.prior_ + static_cast<double>(other.evidence_[i]);
    if (l != m) sum += bernoulli_divergence(l, m);
  }
  return sum;
}

int BernoulliGrid::mark_above(double threshold, std::vector<unsigned char>& marks) const {
  const double level = log_odds_of(threshold) - prior_;
  marks.resize(evidence_.size());
  int count = 0;
  for (std::size_t i = 0; i < evidence_.size(); ++i) {
    const bool above = static_cast<double>(evidence_[i]) > level;
    marks[i] = above ? 1 : 0;
    count += marks[i];
  }
  return count;
}

}  // namespace hearsay::grid
