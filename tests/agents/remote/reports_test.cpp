// What an agent elsewhere tells of itself is known in its world, number by number; and reports that
// are none, and ledgers that are none, are found out.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "agents/remote/remote_body.hpp"
#include "agents/remote/remote_eyes.hpp"
#include "agents/remote/riders.hpp"
#include "agents/remote/stand_in.hpp"
#include "net/radio.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::remote {
namespace {

using Bytes = std::vector<std::byte>;

class Reports : public testing::Test {
 protected:
  Simulation simulation_{{.end = Time::at(10_s)}};
  Radio radio_{simulation_, Topology::full(2), {}};
  Context context_{simulation_, radio_, {.id = 0, .name = "a", .kind = "k"}};
};

/// A body and an account that are asked for nothing.
class Robot final : public RobotBody, public TrailAccount {
 public:
  const drive::Pose& pose() const override { return pose_; }
  void scan(std::span<double>) override {}
  plan::RobotFloor::Step drive(const drive::Command&, double) override { return {}; }
  bool happens(trails::EventId) override { return false; }
  bool put_back(std::uint64_t) override { return false; }
  std::optional<plan::Path> way(trails::EventId) override { return std::nullopt; }
  void sets_off(int) override {}
  void drove(int, double, bool, Doing, double) override {}
  bool arrived(int, trails::EventId) override { return false; }
  void dropped(int) override {}
  void told(int, std::span<const trails::Crumb>) override {}
  void gave_up(int) override {}
  void learned(int, trails::RobotId, std::span<const trails::Identity>) override {}
  bool all_arrived() override { return false; }

 private:
  drive::Pose pose_;
};

/// What an agent tells of itself, as it stands in its world.
class Told final : public StandIn {
 public:
  Told(Context& context, Reporter& reporter) : StandIn(context), reporter_(reporter) {}
  void start() override {}
  void on_measurement(const Measurement&) override {}
  Believer& believer() override { throw BrokenInvariant("it has none"); }
  std::span<const std::byte> state() override { return bytes_; }
  const Bytes& tell() {
    bytes_.clear();
    Packer out(bytes_);
    reporter_.report(out);
    return bytes_;
  }

 private:
  Reporter& reporter_;
  Bytes bytes_;
};

/// Cut off or longer no report is sound; damaged otherwise it may be, and does no harm.
void expect_judged(const Desk& desk, const Bytes& whole) {
  EXPECT_TRUE(desk.is_sound(whole));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(desk.is_sound(std::span(whole).first(size))) << size;
  }
  Bytes longer = whole;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(desk.is_sound(longer));
  Stream draws(2, Purpose("damage"), Entity{whole.size()});
  for (int round = 0; round < 500; ++round) {
    Bytes bytes = whole;
    bytes[draws.below(bytes.size())] = static_cast<std::byte>(draws.bits());
    desk.is_sound(bytes);
  }
}

void put_nan(Bytes& bytes, std::size_t at) {
  for (std::size_t k = 0; k < 8; ++k) bytes[at + k] = std::byte{0xff};
}

TEST_F(Reports, WhatARobotKnowsOfTrailsIsKnownInItsWorld) {
  struct Mind final : TrailMind {
    std::size_t crumbs_known() const override { return crumbs.size(); }
    trails::TrailCounts crumbs_counted() const override { return {.taken = 7, .dropped = 3}; }
    void each_crumb(const std::function<void(const trails::Crumb&)>& look) const override {
      for (const trails::Crumb& crumb : crumbs) look(crumb);
    }
    drive::Pose believed_pose() const override { return {1.0, -2.0, 0.25}; }
    std::vector<trails::Crumb> crumbs;
  } mind;
  for (std::uint32_t n = 0; n < 3; ++n) mind.crumbs.push_back({.event = n, .identity = {1, 2, n}});
  TrailReporter reporter(mind);
  Told told(context_, reporter);
  Robot robot;
  RobotDesk desk(robot, robot, 5, 4);
  EXPECT_EQ(desk.crumbs_known(), 0U);
  desk.attach(told);
  EXPECT_EQ(desk.crumbs_known(), 0U);
  Bytes bytes = told.tell();
  EXPECT_EQ(desk.crumbs_known(), 3U);
  EXPECT_EQ(desk.crumbs_counted().taken, 7U);
  EXPECT_EQ(desk.crumbs_counted().dropped, 3U);
  EXPECT_EQ(desk.believed_pose().y_m, -2.0);
  std::vector<trails::Crumb> seen;
  desk.each_crumb([&](const trails::Crumb& crumb) { seen.push_back(crumb); });
  EXPECT_EQ(seen, mind.crumbs);
  expect_judged(desk, bytes);
  put_nan(bytes, 0);
  EXPECT_FALSE(desk.is_sound(bytes));
}

/// Of everything something.
struct ManyMinds final : TrackMind, PoseMind, GridMind {
  gaussian::Stamp track_stamp() const override { return 55; }
  std::vector<tracking::Report> confirmed_tracks() const override {
    tracking::Report report{9, gaussian::Belief::unknown(4), std::nullopt};
    report.belief.xi(3) = 2.5;
    return std::vector<tracking::Report>(tracks, report);
  }
  std::optional<PoseBelief> own_pose() override {
    Eigen::Matrix3d P;
    P << 2.0, 0.5, 0.1, 0.5, 3.0, 0.2, 0.1, 0.2, variance;
    return PoseBelief{{4.0, 5.0, 0.5}, P};
  }
  const GridBelief& belief() const override { return grid; }
  const grid::LookLedger& ledger() const override { return looks; }
  std::size_t tracks = 2;
  double variance = 1.0;
  GridBelief grid{grid::Area({.columns = 2, .rows = 2, .cell_m = 1.0}),
                  grid::BernoulliGrid::Options()};
  grid::LookLedger looks{{.cells = 4, .layers = 1}};
};

TEST_F(Reports, TracksAreKnownInTheWorld) {
  ManyMinds mind;
  TrackReporter reporter(mind);
  Told tracker(context_, reporter);
  TrackDesk desk(nullptr, 2);
  desk.attach(tracker);
  EXPECT_TRUE(desk.confirmed_tracks().empty());
  expect_judged(desk, tracker.tell());
  EXPECT_EQ(desk.track_stamp(), 55);
  ASSERT_EQ(desk.confirmed_tracks().size(), 2U);
  EXPECT_EQ(desk.confirmed_tracks()[1].label, 9U);
  EXPECT_EQ(desk.confirmed_tracks()[1].belief.xi(3), 2.5);
  mind.tracks = 3;  // more than it can have
  EXPECT_FALSE(desk.is_sound(tracker.tell()));
}

TEST_F(Reports, PosesAreKnownInTheWorld) {
  struct Account final : SightingAccount {
    void saw_place(AgentId, const Eigen::Vector2d&,
                   const localization::RelativeSighting&) override {}
    void saw_robot(AgentId, AgentId, const localization::RelativeSighting&) override {}
  } account;
  ManyMinds mind;
  PoseReporter reporter(mind);
  Told localizer(context_, reporter);
  PoseDesk desk(account, 1, 3);
  desk.attach(localizer);
  Bytes bytes = localizer.tell();
  expect_judged(desk, bytes);
  ASSERT_TRUE(desk.own_pose());
  EXPECT_EQ(desk.own_pose()->pose.heading_rad, 0.5);
  EXPECT_EQ(desk.own_pose()->covariance, mind.own_pose()->covariance);
  put_nan(bytes, 8);
  EXPECT_FALSE(desk.is_sound(bytes));
  mind.variance = -1.0;
  EXPECT_FALSE(desk.is_sound(localizer.tell()));
}

TEST_F(Reports, GridsAreKnownInTheWorld) {
  const std::vector<float> evidence{0.5F, 0.0F, -1.0F, 2.0F};
  ManyMinds mind;
  mind.grid.assign(evidence);
  mind.looks.looked(2, 1);
  GridReporter reporter(mind);
  Told explorer(context_, reporter);
  GridDesk desk(nullptr, mind.grid.area(), grid::BernoulliGrid::Options());
  desk.attach(explorer);
  Bytes bytes = explorer.tell();
  expect_judged(desk, bytes);
  EXPECT_TRUE(std::ranges::equal(desk.belief().evidence(), evidence));
  EXPECT_TRUE(std::ranges::equal(desk.ledger().weights(2), mind.looks.weights(2)));
  EXPECT_TRUE(desk.ledger().weights(3).empty());
  put_nan(bytes, 0);
  EXPECT_FALSE(desk.is_sound(bytes));
}

TEST(Riders, LedgersOfGridsComeBackNumberByNumber) {
  const grid::Shape shape{.cells = 5, .layers = 2};
  RiderPool<GridRider> here, there;
  GridRiders from(here, shape), to(there, shape);
  GridRider* rider = nullptr;
  const RiderPtr holds = here.make(rider);
  rider->ledger = grid::LookLedger(shape);
  rider->ledger.looked(1, 0);
  rider->ledger.looked(1, 2);
  const std::vector<float> odd{0.5F, -2.0F};
  rider->ledger.assign(9, odd);
  Bytes bytes;
  from.write(*rider, bytes);
  const auto weights_of = [&](const RiderPtr& read, std::size_t number) {
    const auto weights = dynamic_cast<const GridRider&>(*read.get()).ledger.weights(number);
    return std::vector<float>(weights.begin(), weights.end());
  };
  for (int again = 0; again < 2; ++again) {  // the second time in room that was used before
    const RiderPtr read = to.read(bytes);
    for (std::size_t number = 0; number < 10; ++number) {
      EXPECT_EQ(weights_of(read, number), weights_of(holds, number)) << number;
    }
    EXPECT_EQ(weights_of(read, 3), (std::vector<float>{1.0F, 0.0F, 1.0F}));
    EXPECT_EQ(weights_of(read, 9), odd);
  }
  GridRiders other(there, {.cells = 4, .layers = 2});
  EXPECT_THROW(other.read(bytes), BrokenInvariant);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(to.read(std::span(bytes).first(size)), BrokenInvariant) << size;
  }
  Stream draws(1, Purpose("damage"), Entity{0});
  for (int round = 0; round < 2000; ++round) {
    Bytes damaged = bytes;
    damaged[draws.below(damaged.size())] = static_cast<std::byte>(draws.bits());
    try {
      to.read(damaged);
    } catch (const BrokenInvariant&) {
    }
  }
}

TEST(Riders, OfAnotherKindNothingIsSaid) {
  LedgerPool ledgers;
  RiderPool<GridRider> grids;
  LedgerRider* ledger = nullptr;
  const RiderPtr holds = ledgers.make(ledger);
  Bytes bytes(3);
  GridRiders(grids, {.cells = 5, .layers = 1}).write(*ledger, bytes);
  EXPECT_TRUE(bytes.empty());
  GridRider* grid = nullptr;
  const RiderPtr holds_grid = grids.make(grid);
  bytes.resize(3);
  LedgerRiders(ledgers).write(*grid, bytes);
  EXPECT_TRUE(bytes.empty());
}

}  // namespace
}  // namespace hearsay::remote
