// Trajectories against a dense batch least-squares solution, which knows nothing of blocks, and
// against a Kalman filter with a smoother, which knows nothing of information.
#include "filters/gaussian/trajectory.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <numeric>

#include "dense_trajectory.hpp"
#include "filters/gaussian/trajectory_factor.hpp"
#include "samples.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

using Dense = Eigen::MatrixXd;

struct Sighting {
  int step;
  Matrix M, S;
  Vector z;
  Belief information() const { return measurement_information(M, S, z); }
};

/// A problem with all that a filter needs, and as many sightings as make it regular.
struct Problem {
  int n;
  std::vector<Transition> motion;  // from step k to k + 1
  std::vector<Sighting> sightings;
  int steps() const { return static_cast<int>(motion.size()) + 1; }
};

Problem random_problem(Stream& random, int axes, int steps) {
  Problem p{2 * axes, {}, {}};
  for (int k = 0; k + 1 < steps; ++k) {
    p.motion.push_back(white_noise_acceleration(axes, random.uniform(0.3, 2.0), 0.2));
  }
  Matrix M = Matrix::Zero(axes, p.n);
  M.leftCols(axes).setIdentity();
  for (int k = 0; k < steps; ++k) {
    if (k > 1 && random.bernoulli(0.4)) continue;
    p.sightings.push_back(
        {k, M, random_information(random, axes, 1.0), 10.0 * random_vector(random, axes)});
  }
  return p;
}

Trajectory filtered(const Problem& p) {
  Trajectory t(p.n, 0);
  for (int k = 0; k < p.steps(); ++k) {
    if (k > 0) t.augment(k, p.motion[static_cast<std::size_t>(k - 1)]);
    for (const Sighting& s : p.sightings) {
      if (s.step == k) t.update(k, s.information());
    }
  }
  return t;
}

/// Minimises the sum of squares of all whitened residuals by orthogonal factorisation.
struct LeastSquares {
  Dense rows;
  Eigen::VectorXd right;

  explicit LeastSquares(const Problem& p) {
    const int columns = p.n * p.steps();
    const auto add = [&](const Dense& covariance, const Dense& row, const Eigen::VectorXd& value) {
      const Dense half = Eigen::LLT<Dense>(covariance).matrixL();
      const Dense white = half.partialPivLu().solve(row);
      const Eigen::VectorXd w = half.partialPivLu().solve(value);
      rows.conservativeResize(rows.rows() + white.rows(), columns);
      right.conservativeResize(rows.rows());
      rows.bottomRows(white.rows()) = white;
      right.tail(w.size()) = w;
    };
    for (int k = 0; k + 1 < p.steps(); ++k) {
      const Transition& t = p.motion[static_cast<std::size_t>(k)];
      Dense row = Dense::Zero(p.n, columns);
      row.middleCols(p.n * k, p.n) = -t.A;
      row.middleCols(p.n * (k + 1), p.n).setIdentity();
      add(t.R, row, Eigen::VectorXd::Zero(p.n));
    }
    for (const Sighting& s : p.sightings) {
      Dense row = Dense::Zero(s.M.rows(), columns);
      row.middleCols(p.n * s.step, p.n) = s.M;
      add(s.S, row, s.z);
    }
  }
  Eigen::VectorXd mean() const { return rows.householderQr().solve(right); }
  Dense information() const { return rows.transpose() * rows; }
  Dense covariance() const { return information().inverse(); }
};

Eigen::VectorXd stacked(const std::vector<Vector>& parts) {
  Eigen::VectorXd v(0);
  for (const Vector& part : parts) {
    v.conservativeResize(v.size() + part.size());
    v.tail(part.size()) = part;
  }
  return v;
}

double log_determinant(const Dense& m) {
  return 2.0 * Dense(Eigen::LLT<Dense>(m).matrixL()).diagonal().array().log().sum();
}

void expect_says(const Trajectory& t, const Eigen::VectorXd& mean, const Dense& covariance,
                 double within) {
  TrajectoryFactor factor;
  ASSERT_EQ(factor.factor(t), Definiteness::positive);
  EXPECT_LE((stacked(factor.means()) - mean).norm(), within * mean.norm());
  for (int k = 0; k < t.steps(); ++k) {
    const int n = t.dimension();
    EXPECT_LE(relative(factor.covariances()[static_cast<std::size_t>(k)],
                       covariance.block(n * k, n * k, n, n)),
              within);
  }
}

TEST(Trajectory, IsTheBatchLeastSquaresSolution) {
  Stream random = stream("batch");
  for (int trial = 0; trial < 30; ++trial) {
    const Problem p = random_problem(random, 1 + trial % 3, 2 + trial % 9);
    const LeastSquares batch(p);
    const Trajectory t = filtered(p);
    EXPECT_LE(relative(dense(t), batch.information()), 1e-12);
    expect_says(t, batch.mean(), batch.covariance(), 1e-9);
  }
}

TEST(Trajectory, IsTheKalmanFilterAndItsSmoother) {
  Stream random = stream("smoother");
  const Problem p = random_problem(random, 2, 12);
  // Mean and covariance alone, forward and back.
  struct Moments {
    Eigen::VectorXd x;
    Dense P;
  };
  const Dense prior = 100.0 * Dense::Identity(p.n, p.n);
  std::vector<Moments> before, after;
  for (int k = 0; k < p.steps(); ++k) {
    Moments m{Eigen::VectorXd::Zero(p.n), prior};
    if (k > 0) {
      const Transition& t = p.motion[static_cast<std::size_t>(k - 1)];
      m = {t.A * after.back().x, t.A * after.back().P * t.A.transpose() + Dense(t.R)};
    }
    before.push_back(m);
    for (const Sighting& s : p.sightings) {
      if (s.step != k) continue;
      const Dense K = m.P * s.M.transpose() * Dense(s.M * m.P * s.M.transpose() + s.S).inverse();
      m.x += K * (s.z - s.M * m.x);
      m.P = (Dense::Identity(p.n, p.n) - K * s.M) * m.P;
    }
    after.push_back(m);
  }
  for (int k = p.steps() - 2; k >= 0; --k) {
    const auto i = static_cast<std::size_t>(k);
    const Dense G = after[i].P * Dense(p.motion[i].A).transpose() * before[i + 1].P.inverse();
    after[i].x += G * (after[i + 1].x - before[i + 1].x);
    after[i].P += G * (after[i + 1].P - before[i + 1].P) * G.transpose();
  }
  Trajectory t = filtered(p);
  t.update(0, Belief::from_moments(Vector::Zero(p.n), prior));
  TrajectoryFactor factor;
  ASSERT_EQ(factor.factor(t), Definiteness::positive);
  for (int k = 0; k < p.steps(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    EXPECT_LE(relative(factor.means()[i], after[i].x), 1e-9);
    EXPECT_LE(relative(factor.covariances()[i], after[i].P), 1e-9);
  }
}

TEST(Trajectory, TakesMeasurementsInAnyOrder) {
  Stream random = stream("late");
  const Problem p = random_problem(random, 2, 10);
  const Trajectory in_time = filtered(p);
  Trajectory late(p.n, 0);
  for (int k = 1; k < p.steps(); ++k) late.augment(k, p.motion[static_cast<std::size_t>(k - 1)]);
  for (auto s = p.sightings.rbegin(); s != p.sightings.rend(); ++s) {
    late.update(s->step, s->information());
  }
  EXPECT_LE(relative(dense(late), dense(in_time)), 1e-14);
  EXPECT_LE(relative(dense_vector(late), dense_vector(in_time)), 1e-14);
  for (const Sighting& s : p.sightings) late.take_out(s.step, s.information());
  EXPECT_LE(dense_vector(late).norm(), 1e-12);
}

TEST(Trajectory, AStepThatIsTakenOutLeavesTheOthersAsTheyWere) {
  Stream random = stream("marginal");
  for (int trial = 0; trial < 40; ++trial) {
    const Problem p = random_problem(random, 1 + trial % 3, 3 + trial % 6);
    const LeastSquares batch(p);
    Trajectory t = filtered(p);
    std::vector<int> left(static_cast<std::size_t>(p.steps()));
    std::iota(left.begin(), left.end(), 0);
    while (left.size() > 1) {
      const auto out = static_cast<int>(random.below(left.size()));
      ASSERT_TRUE(t.marginalise(out));
      left.erase(left.begin() + out);
      std::vector<int> kept;
      for (const int k : left) {
        for (int i = 0; i < p.n; ++i) kept.push_back(p.n * k + i);
      }
      ASSERT_TRUE(std::equal(t.stamps().begin(), t.stamps().end(), left.begin(), left.end()));
      const Dense all = batch.covariance();
      const Eigen::VectorXd mean = batch.mean();
      expect_says(t, mean(kept), all(kept, kept), 1e-7);
    }
    EXPECT_FALSE(t.marginalise(0));
  }
}

TEST(Trajectory, OfWhichTheFirstIsTakenOutGoesOnAsThePredictionDoes) {
  Stream random = stream("filter only");
  Problem p = random_problem(random, 2, 6);
  Belief belief = Belief::unknown(p.n);
  Trajectory t(p.n, 0);
  for (int k = 0; k < p.steps(); ++k) {
    if (k > 0) {
      belief = predict(belief, p.motion[static_cast<std::size_t>(k - 1)]);
      t.augment(k, p.motion[static_cast<std::size_t>(k - 1)]);
      ASSERT_TRUE(t.marginalise(0));
    }
    for (const Sighting& s : p.sightings) {
      if (s.step != k) continue;
      belief += s.information();
      t.update(0, s.information());
    }
    EXPECT_LE((t.omega(0) - belief.omega).norm(), 1e-9 * (1.0 + belief.omega.norm()));
    EXPECT_LE((t.xi(0) - belief.xi).norm(), 1e-9 * (1.0 + belief.xi.norm()));
  }
}

TEST(Trajectory, IsSingularUntilTwoPositionsAreKnown) {
  TrajectoryFactor factor;
  Trajectory t(4, 0);
  EXPECT_EQ(factor.factor(t), Definiteness::singular);
  const Transition second = white_noise_acceleration(2, 1.0, 0.1);
  t.augment(1, second);
  t.augment(2, second);
  EXPECT_EQ(factor.factor(t), Definiteness::singular);
  const Belief seen = measurement_information(matrix({{1, 0, 0, 0}, {0, 1, 0, 0}}),
                                              diagonal({1.0, 1.0}), vector({3.0, 4.0}));
  t.update(1, seen);
  EXPECT_EQ(factor.factor(t), Definiteness::singular);
  t.update(2, seen);
  EXPECT_EQ(factor.factor(t), Definiteness::positive);
  t.take_out(2, seen);
  t.take_out(2, seen);
  EXPECT_EQ(factor.factor(t), Definiteness::indefinite);
  t.update(0, Belief{Matrix::Constant(4, 4, INFINITY), Vector::Zero(4)});
  EXPECT_EQ(factor.factor(t), Definiteness::overflow);
  EXPECT_FALSE(t.marginalise(0));
}

TEST(Trajectory, HasTheDeterminantDivergenceAndErrorOfTheDenseMatrix) {
  Stream random = stream("measures");
  for (int trial = 0; trial < 20; ++trial) {
    Problem p = random_problem(random, 1 + trial % 3, 2 + trial % 7);
    const Trajectory a = filtered(p);
    for (Sighting& s : p.sightings) {
      s.z += random_vector(random, static_cast<int>(s.z.size()));
      s.S *= random.uniform(0.3, 3.0);
    }
    const Trajectory b = filtered(p);
    TrajectoryFactor factor;
    ASSERT_EQ(factor.factor(a), Definiteness::positive);
    const Dense A = dense(a), B = dense(b);
    EXPECT_NEAR(factor.log_determinant(), log_determinant(A),
                1e-10 * (1.0 + std::fabs(log_determinant(A))));
    const Eigen::VectorXd difference =
        A.llt().solve(dense_vector(a)) - B.llt().solve(dense_vector(b));
    const double kl = 0.5 * ((B * A.inverse()).trace() - A.rows() + difference.dot(B * difference) +
                             log_determinant(A) - log_determinant(B));
    EXPECT_NEAR(kl_divergence_nats(a, b).value(), kl, 1e-7 * kl);
    EXPECT_NEAR(kl_divergence_nats(a, a).value(), 0.0, 1e-8);

    std::vector<Vector> truth;
    for (int k = 0; k < a.steps(); ++k) truth.push_back(random_vector(random, p.n));
    const Eigen::VectorXd e = A.llt().solve(dense_vector(a)) - stacked(truth);
    EXPECT_NEAR(nees(a, truth).value(), e.dot(A * e), 1e-7 * e.dot(A * e));
  }
}

TEST(Trajectory, FusedWithAnotherIsTheSumOfBoth) {
  Stream random = stream("sum");
  const Problem p = random_problem(random, 2, 8);
  const Trajectory t = filtered(p);
  Trajectory sum = t;
  sum += t;
  EXPECT_LE(relative(dense(sum), 2.0 * dense(t)), 1e-15);
  sum -= t;
  EXPECT_LE(relative(dense_vector(sum), dense_vector(t)), 1e-14);
  sum *= 3.0;
  EXPECT_LE(relative(dense(sum), 3.0 * dense(t)), 1e-14);
  sum.intersect(0.25, t);
  EXPECT_LE(relative(dense(sum), 1.5 * dense(t)), 1e-14);
}

TEST(TrajectoryIntersection, FindsTheLargestDeterminantOfTheDenseMatrix) {
  Stream random = stream("intersection");
  int inside = 0;
  for (int trial = 0; trial < 40; ++trial) {
    Problem p = random_problem(random, 1 + trial % 3, 2 + trial % 6);
    const Trajectory a = filtered(p);
    for (Sighting& s : p.sightings) s.S = random_information(random, s.S.rows(), 2.0);
    const Trajectory b = filtered(p);
    const Dense A = dense(a), B = dense(b);
    const auto slope = [&](double omega) {
      return Dense(omega * A + (1.0 - omega) * B).llt().solve(A - B).trace();
    };
    const double expected = zero_of_falling(slope);
    EXPECT_NEAR(intersect_det(a, b).value(), expected, 1e-8);
    EXPECT_NEAR(intersect_det(b, a).value(), 1.0 - expected, 1e-8);
    inside += expected > 0.0 && expected < 1.0;
  }
  EXPECT_GT(inside, 10);
}

TEST(TrajectoryIntersection, TakesTheBetterOfTwoAndTheMiddleOfEquals) {
  Stream random = stream("better");
  const Problem p = random_problem(random, 2, 6);
  const Trajectory t = filtered(p);
  Trajectory better = t;
  better.update(3, random_belief(random, 4));
  EXPECT_EQ(intersect_det(better, t).value(), 1.0);
  EXPECT_EQ(intersect_det(t, better).value(), 0.0);
  EXPECT_EQ(intersect_det(t, t).value(), 0.5);
}

TEST(TrajectoryIntersection, OfOneThatKnowsNothingTakesTheOther) {
  Stream random = stream("blank");
  const Problem p = random_problem(random, 2, 6);
  Problem blank = p;
  blank.sightings.clear();
  const Trajectory known = filtered(p), unknown = filtered(blank);
  EXPECT_EQ(intersect_det(known, unknown).value(), 1.0);
  EXPECT_EQ(intersect_det(unknown, known).value(), 0.0);
  EXPECT_FALSE(intersect_det(unknown, unknown).has_value());
}

TEST(TrajectoryIntersection, OfTwoThatKnowDifferentStepsKeepsWhatEachKnows) {
  const Transition second = white_noise_acceleration(1, 1.0, 0.1);
  Trajectory a(2, 0), b(2, 0);
  for (const Stamp stamp : {1, 2, 3}) {
    a.augment(stamp, second);
    b.augment(stamp, second);
  }
  const Belief seen = measurement_information(matrix({{1, 0}}), diagonal({1.0}), vector({2.0}));
  a.update(0, seen);  // each alone is singular
  b.update(3, seen);
  TrajectoryFactor factor;
  ASSERT_EQ(factor.factor(a), Definiteness::singular);
  ASSERT_EQ(factor.factor(b), Definiteness::singular);
  EXPECT_NEAR(intersect_det(a, b).value(), 0.5, 1e-9);  // as time runs back and forth alike
}

TEST(Trajectory, DoesNotDependOnUnits) {
  Stream random = stream("units");
  const Problem p = random_problem(random, 2, 7);
  const Trajectory t = filtered(p);
  // Kilometres or picometres: powers of two, so that the bits are the same.
  for (const double unit : {std::ldexp(1.0, 40), std::ldexp(1.0, -40)}) {
    Problem scaled = p;
    for (Transition& motion : scaled.motion) motion.R *= unit * unit;
    for (Sighting& s : scaled.sightings) {
      s.S *= unit * unit;
      s.z *= unit;
    }
    const Trajectory u = filtered(scaled);
    TrajectoryFactor one, other;
    ASSERT_EQ(one.factor(t), Definiteness::positive);
    ASSERT_EQ(other.factor(u), Definiteness::positive);
    EXPECT_LE(relative(stacked(other.means()), unit * stacked(one.means())), 1e-14);
  }
}

TEST(Trajectory, RefusesWhatDoesNotFit) {
  EXPECT_THROW(Trajectory(0, 0), BrokenInvariant);
  EXPECT_THROW(Trajectory(dimension_max + 1, 0), BrokenInvariant);
  Trajectory t(4, 5);
  const Transition second = white_noise_acceleration(2, 1.0, 0.1);
  EXPECT_THROW(t.augment(5, second), BrokenInvariant);
  EXPECT_THROW(t.augment(6, white_noise_acceleration(3, 1.0, 0.1)), BrokenInvariant);
  EXPECT_THROW(t.augment(6, (Transition{Matrix::Identity(4, 4), Matrix::Zero(4, 4)})),
               BrokenInvariant);
  EXPECT_THROW(t.update(1, Belief::unknown(4)), BrokenInvariant);
  EXPECT_THROW(t.update(0, Belief::unknown(3)), BrokenInvariant);
  Trajectory other(4, 6);
  EXPECT_THROW(t += other, BrokenInvariant);
  EXPECT_THROW(intersect_det(t, other), BrokenInvariant);
  EXPECT_EQ(t.find(5), 0);
  EXPECT_FALSE(t.find(6).has_value());
}

}  // namespace
}  // namespace hearsay::gaussian
