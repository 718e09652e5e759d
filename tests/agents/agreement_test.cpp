#include "agents/agreement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "agents/estimators/gaussian.hpp"
#include "agents/witness.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

using gaussian::Vector;
using testing::DoubleEq;
using testing::ElementsAre;

constexpr double infinity = std::numeric_limits<double>::infinity();

Vector at(double x, double y) {
  Vector v(2);
  v << x, y;
  return v;
}

Time second(int t) { return Time::at(Duration::seconds(t)); }

TEST(Spread, MeasuresAnAxisAtATimeToTheFarthestOther) {
  Spread spread(2);
  for (const Vector& place : {at(0, 0), at(3, 1), at(1, -4)}) spread.add(place);
  EXPECT_EQ(spread.farthest(at(0, 0)), 4.0);   // y: from 0 to -4
  EXPECT_EQ(spread.farthest(at(3, 1)), 5.0);   // y: from 1 to -4
  EXPECT_EQ(spread.farthest(at(1, -4)), 5.0);  // the same pair
  EXPECT_EQ(spread.width(), 5.0);
  spread.clear();
  spread.add(at(7, 7));
  spread.add(at(7, 9));
  EXPECT_EQ(spread.width(), 2.0);
}

TEST(Spread, IsTheLargestDistanceOfAllPairs) {
  Stream draws(3, Purpose("test"), Entity::agent(0));
  std::vector<Vector> places;
  Spread spread(2);
  for (int i = 0; i < 20; ++i) {
    places.push_back(at(draws.normal(), 5.0 * draws.normal()));
    spread.add(places.back());
  }
  double widest = 0.0;
  for (const Vector& one : places) {
    double farthest = 0.0;
    for (const Vector& other : places) {
      farthest = std::max(farthest, (one - other).cwiseAbs().maxCoeff());
    }
    EXPECT_EQ(spread.farthest(one), farthest);
    widest = std::max(widest, farthest);
  }
  EXPECT_EQ(spread.width(), widest);
}

TEST(Spread, OneAloneDisagreesWithNobody) {
  Spread spread(2);
  EXPECT_FALSE(spread.width());
  spread.add(at(1, 2));
  spread.add(std::nullopt);
  spread.add(at(std::nan(""), 0));
  EXPECT_FALSE(spread.width());
  EXPECT_FALSE(spread.farthest(at(1, 2)));
  EXPECT_EQ(spread.without_estimate(), 2);
}

TEST(Agreement, NeedsEverybodysEstimateAndTwoAtLeast) {
  const Agreement agreement({.from = Time(), .within_m = 2.0, .period = Duration::seconds(1)});
  Spread spread(2);
  spread.add(at(0, 0));
  EXPECT_FALSE(agreement.holds(spread));
  spread.add(at(2, -1));  // as far as is allowed
  EXPECT_TRUE(agreement.holds(spread));
  spread.add(std::nullopt);
  EXPECT_FALSE(agreement.holds(spread));
}

double agree_again_s(const std::vector<bool>& samples) {
  Agreement agreement({.from = second(10), .within_m = 1.0, .period = Duration::seconds(1)});
  for (std::size_t i = 0; i < samples.size(); ++i) {
    agreement.sample(second(10 + static_cast<int>(i)), samples[i]);
  }
  return agreement.agree_again_s();
}

TEST(Agreement, CountsFromTheFirstSampleFromWhichOnItHolds) {
  EXPECT_EQ(agree_again_s({true, true, true}), 0.0);
  EXPECT_EQ(agree_again_s({false, true, false, true, true}), 3.0);
  EXPECT_EQ(agree_again_s({true, true, false}), infinity);
  EXPECT_EQ(agree_again_s({}), infinity);
}

// Three agents that never talk about a state on a line. Agent 0 believes 0, agent 1 believes 1 and
// from 4 s on 0.5 (a second measurement of 0), agent 2 knows nothing until 6 s, when it measures 8.
// It is down from 8 s on.
class Company {
 public:
  explicit Company(int asked_from_s = 1)
      : simulation_({.seed = 1, .end = second(10)}),
        witness_(simulation_, {.subjects = {{.name = "target", .truth = {0.0}}},
                               .series = {Metric::disagreement_m},
                               .series_period = Duration::seconds(2),
                               .agreement = Agreement::Options{.from = second(asked_from_s),
                                                               .within_m = 0.75,
                                                               .period = Duration::seconds(1)},
                               .up = [this](AgentId agent) {
                                 return agent != 2 || simulation_.now() < second(8);
                               }}) {
    for (int i = 0; i < 3; ++i) {
      agents_.emplace_back(
          GaussianEstimator::Options{.dimension = 1, .ledgers = witness_.ledgers()},
          std::vector<AgentId>{});
    }
    for (AgentId id = 0; id < 3; ++id) witness_.watch(id, agents_[static_cast<std::size_t>(id)]);
    looks(0, 0, 0.0);
    looks(0, 1, 1.0);
    looks(4, 1, 0.0);
    looks(6, 2, 8.0);
    witness_.start();
    EXPECT_TRUE(simulation_.run().ok());
    witness_.finish();
  }

  /// Disagreement over 0, 2, 4, 6, 8, 10 s; −1 where it is missing.
  std::vector<double> of(AgentId agent) {
    std::vector<double> found;
    for (const SeriesRow& row : simulation_.record().series()) {
      if (row.agent == agent) found.push_back(std::isnan(row.value) ? -1.0 : row.value);
    }
    return found;
  }
  double scalar(AgentId agent, std::string_view name) {
    for (const ScalarRow& row : simulation_.record().scalars()) {
      if (row.agent == agent && simulation_.record().text(row.name) == name) return row.value;
    }
    return std::nan("");
  }

 private:
  void looks(int t, std::size_t agent, double value) {
    simulation_.schedule(second(t), Phase::measure, [this, agent, value] {
      gaussian::Belief information = gaussian::Belief::unknown(1);
      information.omega(0, 0) = 1.0;
      information.xi(0) = value;
      agents_[agent].measured(0, information, witness_.measured(0, information));
    });
  }

  Simulation simulation_;
  Witness witness_;
  std::vector<GaussianEstimator> agents_;
};

TEST(Witness, TellsHowFarEachIsFromTheFarthestOther) {
  Company company;
  const auto half = DoubleEq(0.5);
  EXPECT_THAT(company.of(0), ElementsAre(1.0, 1.0, half, DoubleEq(8.0), half, half));
  EXPECT_THAT(company.of(1), ElementsAre(1.0, 1.0, half, DoubleEq(7.5), half, half));
  EXPECT_THAT(company.of(2), ElementsAre(-1.0, -1.0, -1.0, DoubleEq(8.0), -1.0, -1.0));
  EXPECT_THAT(company.of(central_agent), ElementsAre(1.0, 1.0, half, DoubleEq(8.0), half, half));
}

TEST(Witness, TellsWhenThoseWhoAreUpAgree) {
  // At 4 and 5 s the two that have an estimate are near, but the third has none; then it is far
  // away, until it is down at 8 s: 7 s after the first sample.
  Company company;
  EXPECT_EQ(company.scalar(central_agent, "agree_again_s"), 7.0);
  EXPECT_TRUE(std::isnan(company.scalar(0, "agree_again_s")));
  Company of_late(20);  // the run is over before anybody asks
  EXPECT_EQ(of_late.scalar(central_agent, "agree_again_s"), infinity);
}

}  // namespace
}  // namespace hearsay
