// Fleets of agents that look and talk: which rules count what how often.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "filters/grid/fusion.hpp"
#include "tests/filters/grid/samples.hpp"

namespace hearsay::grid {
namespace {

// Look k adds 3^k to one cell, so that the digits of what an agent holds, to the base of 3, tell
// how often it counts each look. (2^-19 a unit for log-odds, which keeps floats exact and
// below 64.)
constexpr double unit = 0x1p-19;
void add_look(BernoulliGrid& grid, double number) { grid.add(0, number * unit); }
void add_look(BetaGrid& grid, double number) { grid.add(0, number, 0.0); }
double number_in(const BernoulliGrid& grid) {
  return static_cast<double>(grid.evidence()[0]) / unit;
}
double number_in(const BetaGrid& grid) { return static_cast<double>(grid.evidence()[0]); }

int most_often(double number) {
  int most = 0;
  for (auto left = static_cast<long>(number); left > 0; left /= 3) {
    most = std::max(most, static_cast<int>(left % 3));
  }
  return most;
}

/// How often the agents that count a look most often do so, when five of them look and talk at
/// random, everyone to everyone.
template <typename Grid>
int most_often_in_gossip(Rule rule, const Grid& prior) {
  Stream random = stream("gossip");
  std::vector<Grid> agents(5, prior);
  double look = 1.0;
  int most = 0;
  for (int step = 0; step < 200; ++step) {
    if (step % 14 == 0 && step < 14 * 14) {
      add_look(agents[random.below(5)], look);
      look *= 3.0;
    }
    const std::size_t i = random.below(5), j = (i + 1 + random.below(4)) % 5;
    const std::vector<float> heard = copy_of(agents[i]);
    fuse(rule, agents[j], {.received = heard});
    for (const Grid& agent : agents) most = std::max(most, most_often(number_in(agent)));
  }
  return most;
}

TEST(GridGossip, ChoosingRulesCountNoLookTwiceInAnyGossip) {
  const BernoulliGrid bernoulli(square(1), {.limit = 64.0});
  for (const Rule rule : {Rule::maximum, Rule::strongest, Rule::dictatorship}) {
    EXPECT_EQ(most_often_in_gossip(rule, bernoulli), 1) << info(rule).name;
  }
  EXPECT_EQ(most_often_in_gossip(Rule::naive, bernoulli), 2);
  const BetaGrid beta(square(1), {.limit = BetaGrid::limit_max});
  for (const Rule rule : {Rule::dictatorship, Rule::elementwise_maximum}) {
    EXPECT_EQ(most_often_in_gossip(rule, beta), 1) << info(rule).name;
  }
  EXPECT_EQ(most_often_in_gossip(Rule::naive, beta), 2);
}

// Five agents on a line; looks are whole numbers, so that floats add exactly.
template <typename Grid>
class Line {
 public:
  Line() : agents_(5, Grid(square(3))), central_(square(3)) {
    heard_.assign(5, std::vector<std::vector<float>>(5, empty()));
  }
  void look(Stream& random) {
    const auto who = random.below(5);
    const auto cell = static_cast<int>(random.below(9));
    add(agents_[who], cell, random);
  }
  /// channel-robust: i to its neighbour j, unless the message is lost.
  void send(std::size_t i, std::size_t j, bool lost) {
    std::vector<float> message = empty();
    less_heard(agents_[i].evidence(), heard_[i][j], message);
    if (lost) return;
    fuse(Rule::channel_robust, agents_[j], {.received = message, .common = heard_[j][i]});
    heard_[j][i] = message;
  }
  const Grid& agent(std::size_t i) const { return agents_[i]; }
  const Grid& central() const { return central_; }

 private:
  std::vector<float> empty() const { return std::vector<float>(Grid::layers * 9, 0.0F); }
  void add(BernoulliGrid& grid, int cell, Stream& random) {
    const double look = random.bernoulli(0.5) ? 1.0 : -1.0;
    grid.add(cell, look);
    central_.add(cell, look);
  }
  void add(BetaGrid& grid, int cell, Stream& random) {
    const double m = random.bernoulli(0.5) ? 1.0 : 0.0;
    grid.add(cell, m, 1.0 - m);
    central_.add(cell, m, 1.0 - m);
  }
  std::vector<Grid> agents_;
  Grid central_;
  std::vector<std::vector<std::vector<float>>> heard_;
};

template <typename Grid>
void expect_tree_equals_central() {
  Stream random = stream("tree");
  Line<Grid> line;
  for (int step = 0; step < 400; ++step) {
    if (step < 60) line.look(random);
    const std::size_t i = random.below(4);
    const bool lost = random.bernoulli(0.3);
    random.bernoulli(0.5) ? line.send(i, i + 1, lost) : line.send(i + 1, i, lost);
  }
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(copy_of(line.agent(i)), copy_of(line.central())) << i;
  }
  EXPECT_NE(copy_of(line.central()), copy_of(Grid(square(3))));
}

TEST(GridGossip, ChannelRobustOnALossyTreeEndsAsTheCentralGrid) {
  expect_tree_equals_central<BernoulliGrid>();
  expect_tree_equals_central<BetaGrid>();
}

TEST(GridGossip, ChannelOnAReliableTreeEndsAsTheCentralGrid) {
  // Algorithm 4.3 on a line of three, one message at a time; naive counts more.
  BernoulliGrid a(square(1)), b(square(1)), c(square(1)), central(square(1)), naive(square(1));
  std::vector<float> ab{0.0F}, bc{0.0F};
  const auto tell = [](const BernoulliGrid& from, BernoulliGrid& to, std::vector<float>& common) {
    fuse(Rule::channel, to, {.received = from.evidence(), .common = common});
    common[0] = from.evidence()[0];
  };
  for (int round = 0; round < 4; ++round) {
    a.add(0, 1.0);
    c.add(0, 0.5);
    central.add(0, 1.5);
    tell(a, b, ab);
    tell(b, c, bc);
    tell(c, b, bc);
    tell(b, a, ab);
    fuse(Rule::naive, naive, {.received = a.evidence()});
  }
  for (const BernoulliGrid* grid : {&a, &b, &c}) EXPECT_EQ(grid->evidence()[0], 6.0F);
  EXPECT_EQ(central.evidence()[0], 6.0F);
  EXPECT_GT(naive.evidence()[0], 6.0F);
}

}  // namespace
}  // namespace hearsay::grid
