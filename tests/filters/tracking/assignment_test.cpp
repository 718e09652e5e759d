// Assignments against all permutations.
#include "filters/tracking/assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::tracking {
namespace {

using gaussian::stream;

Table random_table(Stream& random, int rows, int columns, bool with_ties) {
  Table table(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      table(i, j) = with_ties ? static_cast<double>(random.below(4)) : random.normal();
    }
  }
  return table;
}

/// Calls `look` with the costs of every complete assignment of the shorter side.
template <typename Look>
void every_assignment(const Table& table, const Look& look) {
  const bool wide = table.rows() <= table.columns();
  const int few = std::min(table.rows(), table.columns());
  std::vector<int> order(static_cast<std::size_t>(std::max(table.rows(), table.columns())));
  std::iota(order.begin(), order.end(), 0);
  do {
    std::vector<double> costs;
    for (int i = 0; i < few; ++i) {
      const int other = order[static_cast<std::size_t>(i)];
      costs.push_back(wide ? table(i, other) : table(other, i));
    }
    look(costs);
  } while (std::next_permutation(order.begin(), order.end()));
}

double total(const Table& table, const std::vector<int>& column_of) {
  double sum = 0.0;
  for (int i = 0; i < table.rows(); ++i) {
    const int j = column_of[static_cast<std::size_t>(i)];
    if (j != unassigned) sum += table(i, j);
  }
  return sum;
}

void expect_complete(const Table& table, const std::vector<int>& column_of) {
  ASSERT_EQ(column_of.size(), static_cast<std::size_t>(table.rows()));
  std::set<int> columns;
  for (const int j : column_of) {
    if (j == unassigned) continue;
    EXPECT_GE(j, 0);
    EXPECT_LT(j, table.columns());
    EXPECT_TRUE(columns.insert(j).second) << "column " << j << " twice";
  }
  EXPECT_EQ(static_cast<int>(columns.size()), std::min(table.rows(), table.columns()));
}

TEST(Assignment, CostsTheLeastOfAllPermutations) {
  Stream random = stream("assignment");
  for (int trial = 0; trial < 400; ++trial) {
    const int rows = 1 + static_cast<int>(random.below(6));
    const int columns = 1 + static_cast<int>(random.below(6));
    const Table table = random_table(random, rows, columns, trial % 2 == 0);
    double best = std::numeric_limits<double>::infinity();
    every_assignment(table, [&](const std::vector<double>& costs) {
      best = std::min(best, std::accumulate(costs.begin(), costs.end(), 0.0));
    });
    const auto column_of = assign(table);
    expect_complete(table, column_of);
    EXPECT_NEAR(total(table, column_of), best, 1e-12) << rows << " × " << columns;
  }
}

// Prices of rows and columns and a slack that is zero on one hidden permutation only: no assignment
// can cost less than the prices, and that one costs no more.
TEST(Assignment, FindsAHiddenPermutationOfALargeTable) {
  Stream random = stream("hidden");
  const int n = 90;
  std::vector<int> hidden(n);
  std::iota(hidden.begin(), hidden.end(), 0);
  for (int i = n - 1; i > 0; --i) {
    std::swap(hidden[static_cast<std::size_t>(i)],
              hidden[random.below(static_cast<std::uint64_t>(i + 1))]);
  }
  std::vector<double> row_price, column_price;
  for (int i = 0; i < n; ++i) {
    row_price.push_back(random.normal(0, 100));
    column_price.push_back(random.normal(0, 100));
  }
  Table table(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double slack = hidden[static_cast<std::size_t>(i)] == j ? 0 : random.uniform(0.01, 1);
      table(i, j) = row_price[static_cast<std::size_t>(i)] +
                    column_price[static_cast<std::size_t>(j)] + slack;
    }
  }
  EXPECT_EQ(assign(table), hidden);
}

TEST(Assignment, OfAnEmptyTableIsEmpty) {
  EXPECT_TRUE(assign(Table(0, 3)).empty());
  EXPECT_EQ(assign(Table(2, 0)), (std::vector<int>{unassigned, unassigned}));
}

TEST(Assignment, RefusesWhatIsNotFinite) {
  EXPECT_THROW(assign(Table(1, 1, std::numeric_limits<double>::infinity())), BrokenInvariant);
  EXPECT_THROW(assign(Table(2, 2, std::nan(""))), BrokenInvariant);
  EXPECT_THROW(Table(-1, 2), BrokenInvariant);
  EXPECT_THROW(bottleneck(Table(1, 2)), BrokenInvariant);
}

TEST(Bottleneck, IsTheLeastLargestCostOfAllPermutations) {
  Stream random = stream("bottleneck");
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + static_cast<int>(random.below(6));
    const Table table = random_table(random, n, n, trial % 2 == 0);
    double best = std::numeric_limits<double>::infinity();
    every_assignment(table, [&](const std::vector<double>& costs) {
      best = std::min(best, *std::max_element(costs.begin(), costs.end()));
    });
    EXPECT_EQ(bottleneck(table), best);
  }
}

}  // namespace
}  // namespace hearsay::tracking
