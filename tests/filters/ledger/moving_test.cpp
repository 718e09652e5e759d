// The ledger of states that move, against the joint covariance of all estimates, propagated
// densely.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <vector>

#include "filters/gaussian/fusion.hpp"
#include "filters/gaussian/transition.hpp"
#include "filters/ledger/ledger.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay {
namespace {

using namespace gaussian;

// Two agents that filter the position and velocity of one target along a line.
class Pair {
 public:
  explicit Pair(const Transition& step) : step_(step), book_(2) { book_.set_motion(step.R); }

  // Measures all of the state, with covariance S.
  void measured(int who, const Matrix& S) {
    const Belief information = measurement_information(Matrix::Identity(2, 2), S, vector({0, 0}));
    const Matrix before = beliefs_[who].omega;
    beliefs_[who] += information;
    ledgers_[who].measured(book_.add(information));
    const Matrix P = beliefs_[who].omega.inverse();
    const Matrix keep = P * before, gain = P * information.omega;
    // e ← keep·e + gain·v.
    Dense T = Dense::Identity(4, 4);
    T.block(2 * who, 2 * who, 2, 2) = keep;
    joint_ = T * joint_ * T.transpose();
    joint_.block(2 * who, 2 * who, 2, 2) += gain * S * gain.transpose();
  }

  void moves(std::size_t step) {
    for (int who = 0; who < 2; ++who) {
      const Prediction p = predict_with_gain(beliefs_[who], step_);
      beliefs_[who] = p.belief;
      ledgers_[who].predict(p.F, p.belief.omega, step);
    }
    // e ← Ae − w, the same w for both.
    Dense T = Dense::Zero(4, 4), W = Dense::Zero(4, 2);
    for (int who = 0; who < 2; ++who) {
      T.block(2 * who, 2 * who, 2, 2) = step_.A;
      W.block(2 * who, 0, 2, 2) = Dense::Identity(2, 2);
    }
    joint_ = T * joint_ * T.transpose() + W * step_.R * W.transpose();
  }

  void hears(int who, Rule rule) {
    const int other = 1 - who;
    Matrix own, received;
    Belief fused;
    if (info(rule).fuses == Fuses::by_direction) {
      const DirectionalFusion f = fuse_by_direction(rule, beliefs_[who], beliefs_[other]);
      own = f.own;
      received = f.received;
      fused = f.belief;
      ledgers_[who].combine(own, received, ledgers_[other]);
    } else {
      const Coefficients k = coefficients(rule, beliefs_[who], beliefs_[other]);
      own = k.own * Matrix::Identity(2, 2);
      received = k.received * Matrix::Identity(2, 2);
      fused.omega = k.own * beliefs_[who].omega + k.received * beliefs_[other].omega;
      fused.xi = k.own * beliefs_[who].xi + k.received * beliefs_[other].xi;
      ledgers_[who].combine(k.own, k.received, ledgers_[other], 0.0, nullptr);
    }
    const Matrix P = fused.omega.inverse();
    Dense T = Dense::Identity(4, 4);
    T.block(2 * who, 2 * who, 2, 2) = P * own * beliefs_[who].omega;
    T.block(2 * who, 2 * other, 2, 2) = P * received * beliefs_[other].omega;
    joint_ = T * joint_ * T.transpose();
    beliefs_[who] = fused;
  }

  void expect_equal(const char* rule) const {
    for (int who = 0; who < 2; ++who) {
      const auto P = true_covariance(beliefs_[who].omega, ledgers_[who], book_);
      ASSERT_TRUE(P);
      const Dense expected = joint_.block(2 * who, 2 * who, 2, 2);
      EXPECT_LT((*P - expected).norm(), 1e-10 * expected.norm()) << rule;
    }
  }
  double overconfidence(int who) const {
    return (beliefs_[who].omega * joint_.block(2 * who, 2 * who, 2, 2)).trace() / 2;
  }

 private:
  using Dense = Eigen::MatrixXd;
  Transition step_;
  MeasurementBook book_;
  Belief beliefs_[2] = {Belief::unknown(2), Belief::unknown(2)};
  Ledger ledgers_[2] = {Ledger::moving(2), Ledger::moving(2)};
  Dense joint_ = Dense::Zero(4, 4);
};

TEST(MovingLedger, IsTheJointCovarianceUnderEveryRuleWithoutMemory) {
  for (const Rule rule :
       {Rule::naive, Rule::ci_det, Rule::ci_trace, Rule::ci_half, Rule::ci_niehsen,
        Rule::most_certain, Rule::inverse_ci, Rule::ellipsoidal}) {
    Pair pair(white_noise_acceleration(1, 1.0, 0.3));
    pair.measured(0, diagonal({4.0, 1.0}));
    pair.measured(1, diagonal({1.0, 9.0}));
    for (std::size_t step = 0; step < 12; ++step) {
      pair.moves(step);
      pair.measured(static_cast<int>(step % 2), matrix({{2.0, 0.5}, {0.5, 3.0}}));
      if (step % 3 == 0) pair.hears(static_cast<int>(step / 3 % 2), rule);
    }
    pair.expect_equal(info(rule).name.data());
  }
}

// Two who never measure the same thing are wrong together nevertheless: the target turned for both.
TEST(MovingLedger, SeesThatTheMotionIsCommonToAll) {
  Pair pair(white_noise_acceleration(1, 1.0, 5.0));
  for (int who = 0; who < 2; ++who) pair.measured(who, diagonal({1.0, 1.0}));
  for (std::size_t step = 0; step < 5; ++step) pair.moves(step);
  pair.expect_equal("none");
  EXPECT_NEAR(pair.overconfidence(0), 1.0, 1e-12);
  pair.hears(0, Rule::naive);
  pair.expect_equal("naive");
  EXPECT_GT(pair.overconfidence(0), 1.5);
}

TEST(MovingLedger, CountsMeasurementsAsTheRulesDo) {
  Ledger a = Ledger::moving(2), b = Ledger::moving(2);
  a.measured(0);
  b.measured(1);
  a.predict(0.5 * Matrix::Identity(2, 2), Matrix::Identity(2, 2), 0);
  a.combine(1.0, 2.0, b, 0.0, nullptr);
  EXPECT_EQ(std::vector<double>(a.weights().begin(), a.weights().end()),
            (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(a.matrices()[0], 0.5);
  EXPECT_EQ(a.matrices()[4], 2.0);
  EXPECT_EQ(a.drift()[0], -1.0);
  a.clear();
  EXPECT_TRUE(a.moves());
  EXPECT_TRUE(a.drift().empty());
}

}  // namespace
}  // namespace hearsay
