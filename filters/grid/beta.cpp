#include "filters/grid/beta.hpp"

#include <algorithm>
#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::grid {
namespace {

void require_beta(const Beta& b) {
  require(b.exists() && std::isfinite(b.alpha) && std::isfinite(b.beta), "Beta: α and β are > 0");
}

double log_beta_function(const Beta& b) {
  return math::lgamma(b.alpha) + math::lgamma(b.beta) - math::lgamma(b.alpha + b.beta);
}

}  // namespace

double mean(const Beta& b) {
  require_beta(b);
  return b.alpha / (b.alpha + b.beta);
}

double variance(const Beta& b) {
  require_beta(b);
  const double sum = b.alpha + b.beta;
  return b.alpha / sum * (b.beta / sum) / (sum + 1.0);
}

double entropy(const Beta& b) {
  require_beta(b);
  return log_beta_function(b) - (b.alpha - 1.0) * math::digamma(b.alpha) -
         (b.beta - 1.0) * math::digamma(b.beta) +
         (b.alpha + b.beta - 2.0) * math::digamma(b.alpha + b.beta);
}

double divergence(const Beta& p, const Beta& q) {
  require_beta(p);
  require_beta(q);
  const double d_alpha = p.alpha - q.alpha, d_beta = p.beta - q.beta;
  const double d = log_beta_function(q) - log_beta_function(p) + d_alpha * math::digamma(p.alpha) +
                   d_beta * math::digamma(p.beta) -
                   (d_alpha + d_beta) * math::digamma(p.alpha + p.beta);
  return d > 0.0 ? d : 0.0;
}

BetaGrid::BetaGrid(const Area& area, const Options& options)
    : area_(area),
      prior_(options.prior),
      limit_(static_cast<float>(options.limit)),
      evidence_(layers * static_cast<std::size_t>(area.cells()), 0.0F) {
  require_beta(options.prior);
  require(options.limit > 0.0 && options.limit <= limit_max,
          "BetaGrid: the limit of counts is in (0, 2^24]");
}

void BetaGrid::add(int number, double m, double n) {
  require(area_.has(number), "BetaGrid: no cell of this number");
  require(m >= 0.0 && n >= 0.0 && std::isfinite(m) && std::isfinite(n),
          "BetaGrid: counts of a look are finite and not negative");
  float* e = evidence_.data() + layers * static_cast<std::size_t>(number);
  const auto limit = static_cast<double>(limit_);
  e[0] = static_cast<float>(std::min(static_cast<double>(e[0]) + m, limit));
  e[1] = static_cast<float>(std::min(static_cast<double>(e[1]) + n, limit));
}

void BetaGrid::clear() { std::fill(evidence_.begin(), evidence_.end(), 0.0F); }

Beta BetaGrid::at(int number) const {
  require(area_.has(number), "BetaGrid: no cell of this number");
  const float* e = evidence_.data() + layers * static_cast<std::size_t>(number);
  return {prior_.alpha + static_cast<double>(e[0]), prior_.beta + static_cast<double>(e[1])};
}

std::optional<double> BetaGrid::mean(int number) const {
  const Beta b = at(number);
  return b.exists() ? std::optional(grid::mean(b)) : std::nullopt;
}

std::optional<double> BetaGrid::entropy(int number) const {
  const Beta b = at(number);
  return b.exists() ? std::optional(grid::entropy(b)) : std::nullopt;
}

int BetaGrid::lawless() const {
  int count = 0;
  for (int i = 0; i < area_.cells(); ++i) count += at(i).exists() ? 0 : 1;
  return count;
}

std::optional<double> BetaGrid::total_entropy() const {
  double sum = 0.0;
  for (int i = 0; i < area_.cells(); ++i) {
    const auto h = entropy(i);
    if (!h) return std::nullopt;
    sum += *h;
  }
  return sum;
}

std::optional<double> BetaGrid::divergence(const BetaGrid& other) const {
  require(area_ == other.area_, "BetaGrid: grids over different areas");
  double sum = 0.0;
  for (int i = 0; i < area_.cells(); ++i) {
    const Beta p = at(i), q = other.at(i);
    if (!p.exists() || !q.exists()) return std::nullopt;
    if (p.alpha != q.alpha || p.beta != q.beta) sum += grid::divergence(p, q);
  }
  return sum;
}

int BetaGrid::mark_above(double threshold, std::vector<unsigned char>& marks) const {
  require(threshold >= 0.0 && threshold <= 1.0, "BetaGrid: a threshold is in [0, 1]");
  marks.resize(static_cast<std::size_t>(area_.cells()));
  int count = 0;
  for (int i = 0; i < area_.cells(); ++i) {
    const Beta b = at(i);
    const bool above = b.exists() && grid::mean(b) > threshold;
    marks[static_cast<std::size_t>(i)] = above ? 1 : 0;
    count += above ? 1 : 0;
  }
  return count;
}

void convert(const BetaGrid& from, BernoulliGrid& out) {
  require(from.area() == out.area(), "convert: grids over different areas");
  out.clear();
  for (int i = 0; i < from.area().cells(); ++i) {
    const Beta b = from.at(i);
    if (b.exists()) out.add(i, math::log(b.alpha) - math::log(b.beta) - out.prior_log_odds());
  }
}

void convert(const BernoulliGrid& from, double strength, BetaGrid& out) {
  require(from.area() == out.area(), "convert: grids over different areas");
  require(strength >= 0.0 && std::isfinite(strength), "convert: a strength is not negative");
  const double s = strength + out.prior().alpha + out.prior().beta;
  const std::span<float> counts = out.evidence_mutable();
  const auto bounded = [&](double count) {
    return static_cast<float>(
        std::clamp(count, static_cast<double>(out.least()), static_cast<double>(out.greatest())));
  };
  for (int i = 0; i < from.area().cells(); ++i) {
    const double l = from.log_odds(i);
    const auto at = BetaGrid::layers * static_cast<std::size_t>(i);
    counts[at] = bounded(s * probability_of(l) - out.prior().alpha);
    counts[at + 1] = bounded(s * probability_of(-l) - out.prior().beta);
  }
}

}  // namespace hearsay::grid
