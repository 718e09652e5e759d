// Tracks with trails as messages, and what a tracker makes of them.
#include "agents/trail_message.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

using gaussian::Belief;
using gaussian::Matrix;
using gaussian::Stamp;
using gaussian::TrajectoryMessage;
using gaussian::Vector;

Belief belief(Stream& random) {
  Vector mean(4);
  for (double& value : mean) value = random.normal();
  return Belief::from_moments(mean, random.uniform(1, 2) * Matrix::Identity(4, 4));
}

/// One track with a trail at 3, 4 and 6, one without, at present 7.
std::vector<tracking::Report> reports() {
  Stream random(1, Purpose("trails"), Entity::agent(0));
  gaussian::Trajectory trail(4, 3);
  trail.update(0, belief(random));
  for (const Stamp stamp : {4, 6}) {
    trail.augment(stamp, gaussian::white_noise_acceleration(2, 1.0, 0.1));
    trail.update(trail.steps() - 1, belief(random));
  }
  return {{8, belief(random), trail}, {9, belief(random), std::nullopt}};
}

TrajectoryMessage message() {
  TrajectoryMessage m;
  put_tracks(reports(), 7, m);
  return m;
}

void expect_same(const Belief& a, const Belief& b) {
  EXPECT_EQ(a.omega, b.omega);
  EXPECT_EQ(a.xi, b.xi);
}

TEST(TrailMessage, ComesBackAsItWas) {
  std::vector<std::byte> bytes;
  gaussian::encode(message(), bytes);
  TrajectoryMessage decoded;
  ASSERT_TRUE(gaussian::decode(bytes, decoded));
  std::vector<tracking::Report> back(5);
  ASSERT_EQ(take_tracks(decoded, back), 7);
  const auto said = reports();
  ASSERT_EQ(back.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back[i].label, said[i].label);
    expect_same(back[i].belief, said[i].belief);
  }
  EXPECT_FALSE(back[1].trail);
  ASSERT_TRUE(back[0].trail);
  const gaussian::Trajectory &a = *back[0].trail, &b = *said[0].trail;
  ASSERT_TRUE(std::ranges::equal(a.stamps(), b.stamps()));
  for (int k = 0; k < 3; ++k) {
    expect_same({a.omega(k), a.xi(k)}, {b.omega(k), b.xi(k)});
    if (k < 2) {
      EXPECT_EQ(a.omega_next(k), b.omega_next(k));
    }
  }
}

TEST(TrailMessage, IsRefusedIfItIsNone) {
  std::vector<tracking::Report> out;
  const auto accepted = [&](const std::function<void(TrajectoryMessage&)>& change) {
    TrajectoryMessage m = message();
    change(m);
    return take_tracks(m, out).has_value();
  };
  EXPECT_TRUE(accepted([](auto&) {}));
  EXPECT_FALSE(accepted([](auto& m) { m.trajectories.clear(); }));
  EXPECT_FALSE(accepted([](auto& m) { m.trajectories[1].steps.clear(); }));
  EXPECT_FALSE(accepted([](auto& m) { m.trajectories[1].steps.back().stamp = 8; }));
  EXPECT_FALSE(accepted([](auto& m) { m.trajectories[0].steps[1].stamp = 3; }));
  EXPECT_FALSE(accepted([](auto& m) { m.trajectories[0].steps[2].stamp = 8; }));
  EXPECT_FALSE(accepted([](auto& m) { m.trajectories[0].steps[0].next = Matrix(); }));
  EXPECT_FALSE(accepted([](auto& m) { m.trajectories[0].steps[2].next = Matrix::Zero(4, 4); }));
  EXPECT_FALSE(accepted([](auto& m) { m.trajectories[0].steps[3].next = Matrix::Zero(4, 4); }));
  EXPECT_FALSE(
      accepted([](auto& m) { m.trajectories[0].steps[1].information = Belief::unknown(2); }));
}

}  // namespace
}  // namespace hearsay
