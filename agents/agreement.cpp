#include "agents/agreement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hearsay {

Spread::Spread(int dimension) : low_(dimension), high_(dimension) {}

void Spread::clear() { count_ = without_ = 0; }

void Spread::add(const std::optional<gaussian::Vector>& estimate) {
  if (!estimate || !estimate->allFinite()) {
    ++without_;
    return;
  }
  if (count_++ == 0) {
    low_ = high_ = *estimate;
    return;
  }
  for (Eigen::Index axis = 0; axis < low_.size(); ++axis) {
    low_(axis) = std::min(low_(axis), (*estimate)(axis));
    high_(axis) = std::max(high_(axis), (*estimate)(axis));
  }
}

std::optional<double> Spread::farthest(const gaussian::Vector& estimate) const {
  if (count_ < 2) return std::nullopt;
  double distance = 0.0;
  for (Eigen::Index axis = 0; axis < low_.size(); ++axis) {
    distance = std::max({distance, estimate(axis) - low_(axis), high_(axis) - estimate(axis)});
  }
  return distance;
}

std::optional<double> Spread::width() const {
  return count_ < 2 ? std::nullopt : std::optional((high_ - low_).maxCoeff());
}

bool Agreement::holds(const Spread& spread) const {
  const std::optional<double> width = spread.width();
  return spread.without_estimate() == 0 && width && *width <= options_.within_m;
}

void Agreement::sample(Time now, bool agreed) {
  last_ = now;
  if (!agreed) {
    since_.reset();
  } else if (!since_) {
    since_ = now;
  }
}

double Agreement::agree_again_s() const {
  if (!since_) return std::numeric_limits<double>::infinity();
  return (*since_ - options_.from).seconds();
}

}  // namespace hearsay
