#include "filters/tracking/ospa.hpp"

#include <algorithm>
#include <cmath>

#include "sim/math/functions.hpp"

namespace hearsay::tracking {
namespace {

double power(double x, double p) {
  if (p == 1.0) return x;
  if (p == 2.0) return x * x;
  return x > 0.0 ? math::pow(x, p) : 0.0;
}

double root(double x, double p) {
  if (p == 1.0) return x;
  if (p == 2.0) return std::sqrt(x);
  return x > 0.0 ? math::pow(x, 1.0 / p) : 0.0;
}

/// min(d, c)^p of each.
Table costs_of(const Table& distances, double p, double c) {
  Table costs(distances.rows(), distances.columns());
  for (int i = 0; i < distances.rows(); ++i) {
    for (int j = 0; j < distances.columns(); ++j) {
      require(distances(i, j) >= 0.0, "OSPA: a distance is negative or no number");
      costs(i, j) = power(std::min(distances(i, j), c), p);
    }
  }
  return costs;
}

void require_parameters(double p, double c) {
  require(p >= 1.0, "OSPA: the order must be at least 1");
  require(c > 0.0 && std::isfinite(c), "OSPA: the cut-off must be positive");
}

/// Of as many rows as have a column.
double cost_of(const Table& costs, const std::vector<int>& column_of) {
  double sum = 0.0;
  for (std::size_t i = 0; i < column_of.size(); ++i) {
    if (column_of[i] != unassigned) sum += costs(static_cast<int>(i), column_of[i]);
  }
  return sum;
}

}  // namespace

Table distances(std::span<const gaussian::Vector> estimates,
                std::span<const gaussian::Vector> truths) {
  Table table(static_cast<int>(estimates.size()), static_cast<int>(truths.size()));
  for (int i = 0; i < table.rows(); ++i) {
    for (int j = 0; j < table.columns(); ++j) {
      const gaussian::Vector& a = estimates[static_cast<std::size_t>(i)];
      const gaussian::Vector& b = truths[static_cast<std::size_t>(j)];
      require(a.size() == b.size(), "distances: dimensions differ");
      double squares = 0.0;
      for (Eigen::Index k = 0; k < a.size(); ++k) squares += (a(k) - b(k)) * (a(k) - b(k));
      table(i, j) = std::sqrt(squares);
    }
  }
  return table;
}

Ospa ospa(const Table& distances, double p, double c) {
  require_parameters(p, c);
  const int m = std::min(distances.rows(), distances.columns());
  const int n = std::max(distances.rows(), distances.columns());
  if (n == 0) return {};
  if (std::isinf(p)) {
    if (m != n) return {c, 0.0, c};
    const double largest = bottleneck(costs_of(distances, 1.0, c));
    return {largest, largest, 0.0};
  }
  const Table costs = costs_of(distances, p, c);
  const double place = cost_of(costs, assign(costs)) / n;
  const double number = power(c, p) * (n - m) / n;
  return {root(place + number, p), root(place, p), root(number, p)};
}

Gospa gospa(const Table& distances, double p, double c) {
  require_parameters(p, c);
  require(std::isfinite(p), "GOSPA: the order must be finite");
  Gospa out;
  // A pair at the cut-off or beyond costs as much as one missed and one false.
  const Table costs = costs_of(distances, p, c);
  out.truth_of = assign(costs);
  int pairs = 0;
  for (std::size_t i = 0; i < out.truth_of.size(); ++i) {
    int& truth = out.truth_of[i];
    if (truth == unassigned) continue;
    if (distances(static_cast<int>(i), truth) < c) {
      out.localisation += costs(static_cast<int>(i), truth);
      ++pairs;
    } else {
      truth = unassigned;
    }
  }
  out.missed_count = distances.columns() - pairs;
  out.false_count = distances.rows() - pairs;
  const double half = 0.5 * power(c, p);
  out.missed = half * out.missed_count;
  out.false_ones = half * out.false_count;
  out.distance = root(out.localisation + out.missed + out.false_ones, p);
  return out;
}

}  // namespace hearsay::tracking
