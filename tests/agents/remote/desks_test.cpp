// What an agent elsewhere asks of its world, and what the world answers: the same as if both were
// one; and questions that are none do no harm.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "agents/remote/remote_agent.hpp"
#include "agents/remote/remote_body.hpp"
#include "agents/remote/remote_eyes.hpp"
#include "net/radio.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::remote {
namespace {

using Bytes = std::vector<std::byte>;

/// A robot that does what it is told, and an account of what it is told.
class Robot final : public RobotBody, public TrailAccount {
 public:
  const drive::Pose& pose() const override { return pose_; }
  void scan(std::span<double> distances_m) override {
    for (std::size_t i = 0; i < distances_m.size(); ++i) distances_m[i] = 0.1 * double(i) + 1.0;
  }
  plan::RobotFloor::Step drive(const drive::Command& wanted, double dt_s) override {
    ++acts_;
    pose_ = drive::driven(pose_, wanted, dt_s);
    return {wanted, true};
  }
  bool happens(trails::EventId event) override { return ++acts_, event == 3; }
  bool put_back(std::uint64_t count) override {
    ++acts_;
    pose_ = {-1.0, -2.0, 0.5};
    return count == 7;
  }
  std::optional<plan::Path> way(trails::EventId event) override {
    if (event != 3) return std::nullopt;
    return plan::Path{{{1.0, 2.0}, {3.0, 4.5}}, 3.2};
  }
  void sets_off(int robot) override { tell("off", robot); }
  void drove(int robot, double length_m, bool blocked, Doing doing, double dt_s) override {
    tell("drove", robot, length_m, blocked, static_cast<int>(doing), dt_s);
  }
  bool arrived(int robot, trails::EventId event) override {
    tell("arrived", robot, event);
    return event == 1;
  }
  void dropped(int robot) override { tell("dropped", robot); }
  void told(int robot, std::span<const trails::Crumb> crumbs) override {
    tell("told", robot);
    told_.assign(crumbs.begin(), crumbs.end());
  }
  void gave_up(int robot) override { tell("gave up", robot); }
  void learned(int robot, trails::RobotId from, std::span<const trails::Identity> crumbs) override {
    tell("learned", robot, from);
    learned_.assign(crumbs.begin(), crumbs.end());
  }
  bool all_arrived() override { return true; }

  template <class... T>
  void tell(const char* what, T... values) {
    ++acts_;
    heard_ += what;
    ((heard_ += ' ' + std::to_string(values)), ...);
    heard_ += '\n';
  }
  std::size_t acts_ = 0;
  drive::Pose pose_{1.0, 2.0, 3.0};
  std::string heard_;
  std::vector<trails::Crumb> told_;
  std::vector<trails::Identity> learned_;
};

/// Both ends in one place.
class Desks : public testing::Test, public Asker {
 protected:
  Desks()
      : simulation_({.end = Time::at(10_s)}),
        radio_(simulation_, Topology::full(2), {}),
        context_(simulation_, radio_, {.id = 0, .name = "a", .kind = "k"}) {}
  std::span<const std::byte> ask(std::span<const std::byte> question) override {
    last_.assign(question.begin(), question.end());
    serve(last_, context_, desk_, answer_);
    return answer_;
  }
  void note(std::span<const std::byte> note) override {
    Bytes notes;
    Packer(notes).bytes(note);
    Packer(notes).bytes(note);  // one after another: here twice the same
    last_.assign(note.begin(), note.end());
    take_notes(notes, context_, desk_, answer_);
  }
  void expect_refused(const Bytes& question) {
    EXPECT_THROW(serve(question, context_, desk_, answer_), BrokenInvariant);
  }
  /// All that is cut off or longer is refused; whatever else is damaged does no harm.
  /// `acts`: how often anything was done.
  void expect_last_is_guarded(const std::function<std::size_t()>& acts) {
    const Bytes whole = last_;
    const std::size_t before = acts();
    for (std::size_t size = 0; size < whole.size(); ++size) {
      expect_refused(Bytes(whole.begin(), whole.begin() + std::ptrdiff_t(size)));
    }
    Bytes longer = whole;
    longer.push_back(std::byte{0});
    expect_refused(longer);
    EXPECT_EQ(acts(), before);
    Stream draws(1, Purpose("damage"), Entity{whole.size()});
    for (int round = 0; round < 500; ++round) {
      Bytes bytes = whole;
      for (std::uint64_t n = 1 + draws.below(4); n > 0; --n) {
        bytes[draws.below(bytes.size())] = static_cast<std::byte>(draws.bits());
      }
      try {
        serve(bytes, context_, desk_, answer_);
      } catch (const BrokenInvariant&) {
      }
    }
  }

  Simulation simulation_;
  Radio radio_;
  Context context_;
  Desk* desk_ = nullptr;
  Bytes last_, answer_;
};

TEST_F(Desks, ARobotElsewhereHasTheBodyThatItHasHere) {
  Robot here, there;
  RobotDesk desk(there, there, 5, 4);
  desk_ = &desk;
  RemoteBody body(*this);
  const auto expect_same_pose = [&] {
    EXPECT_EQ(body.pose().x_m, here.pose().x_m);
    EXPECT_EQ(body.pose().y_m, here.pose().y_m);
    EXPECT_EQ(body.pose().heading_rad, here.pose().heading_rad);
  };
  expect_same_pose();
  std::vector<double> scan(4), scan_here(4);
  body.scan(scan);
  here.scan(scan_here);
  EXPECT_EQ(scan, scan_here);
  const auto step = body.drive({0.5, -0.25}, 0.1);
  here.drive({0.5, -0.25}, 0.1);
  EXPECT_EQ(step.done.forward_m_per_s, 0.5);
  EXPECT_EQ(step.done.turn_rad_per_s, -0.25);
  EXPECT_TRUE(step.blocked);
  expect_same_pose();
  const auto acts = [&there] { return there.acts_; };
  EXPECT_TRUE(body.happens(3));
  EXPECT_FALSE(body.happens(2));
  expect_last_is_guarded(acts);
  EXPECT_FALSE(body.way(2));
  const auto way = body.way(3);
  ASSERT_TRUE(way);
  EXPECT_EQ(way->length_m, 3.2);
  EXPECT_EQ(way->points, here.way(3)->points);
  EXPECT_FALSE(body.put_back(1));
  EXPECT_TRUE(body.put_back(7));
  here.put_back(7);
  expect_same_pose();
  expect_last_is_guarded(acts);
  body.drive({0.5, -0.25}, 0.1);
  expect_last_is_guarded(acts);
  // A scanner of another number of rays than the world's is no scanner of this robot.
  std::vector<double> other(5);
  EXPECT_THROW(body.scan(other), BrokenInvariant);
}

TEST_F(Desks, WhatARobotElsewhereTellsIsKeptUnderItsNumber) {
  Robot robot;
  RobotDesk desk(robot, robot, 5, 4);
  desk_ = &desk;
  RemoteAccount account(*this);
  const auto acts = [&robot] { return robot.acts_; };
  account.drove(99, 0.25, true, TrailAccount::Doing::searching, 0.1);
  EXPECT_EQ(robot.heard_, "drove 5 0.250000 1 2 0.100000\ndrove 5 0.250000 1 2 0.100000\n");
  expect_last_is_guarded(acts);
  robot.heard_.clear();
  account.sets_off(99);
  account.dropped(99);
  account.gave_up(99);
  EXPECT_TRUE(account.arrived(99, 1));
  EXPECT_FALSE(account.arrived(99, 2));
  EXPECT_TRUE(account.all_arrived());
  EXPECT_EQ(robot.heard_,
            "off 5\noff 5\ndropped 5\ndropped 5\ngave up 5\ngave up 5\narrived 5 1\narrived 5 2\n");
  const trails::Crumb crumb{.event = 1,
                            .goal = 2,
                            .position = {1.5F, -2.5F},
                            .distance_s = 7.25F,
                            .created_s = 1e5 + 0.1,
                            .identity = {3, 4, 5}};
  account.told(99, {&crumb, 1});
  ASSERT_EQ(robot.told_.size(), 1U);
  EXPECT_EQ(robot.told_[0], crumb);
  expect_last_is_guarded(acts);
  robot.heard_.clear();
  account.learned(99, 8, {&crumb.identity, 1});
  ASSERT_EQ(robot.learned_.size(), 1U);
  EXPECT_EQ(robot.learned_[0], crumb.identity);
  EXPECT_EQ(robot.heard_, "learned 5 8\nlearned 5 8\n");
  expect_last_is_guarded(acts);
}

TEST_F(Desks, TrackersLocalizersAndExplorersSeeWhatTheyWouldSeeHere) {
  struct Source final : PlotSource, LookSource {
    void scan(std::uint64_t count, Plots& out) override {
      ++acts;
      out = {};
      if (count == 1) return;
      out.coverage.centre = gaussian::Vector::Constant(2, 4.0);
      out.coverage.range = 50.0;
      for (int i = 0; i < 3; ++i) {
        out.plots.push_back({gaussian::Vector::Constant(2, i), gaussian::Matrix::Identity(2, 2)});
      }
      out.plots[1].S(0, 1) = 0.5;
    }
    Looks look(double heading_rad, std::uint64_t count) override {
      ++acts;
      looks = {{int(count), heading_rad, 1.0, 2.0}, {9, -0.5, 0.0, 3.0}};
      if (count > 0) indices = {7, 4};
      return {looks, indices};
    }
    std::vector<grid::CellLook> looks;
    std::vector<std::uint32_t> indices;
    std::size_t acts = 0;
  } source;
  const auto acts = [&source] { return source.acts; };
  TrackDesk track_desk(&source, 10);
  desk_ = &track_desk;
  RemotePlots remote_plots(*this);
  Plots plots;
  remote_plots.scan(0, plots);
  EXPECT_EQ(plots.coverage.centre, gaussian::Vector::Constant(2, 4.0));
  EXPECT_EQ(plots.coverage.range, 50.0);
  ASSERT_EQ(plots.plots.size(), 3U);
  EXPECT_EQ(plots.plots[2].z, gaussian::Vector::Constant(2, 2.0));
  EXPECT_EQ(plots.plots[1].S(0, 1), 0.5);
  EXPECT_EQ(plots.plots[1].S(1, 0), 0.0);
  remote_plots.scan(1, plots);
  EXPECT_TRUE(plots.plots.empty());
  EXPECT_EQ(plots.coverage.centre.size(), 0);
  EXPECT_EQ(plots.coverage.range, std::numeric_limits<double>::infinity());
  expect_last_is_guarded(acts);

  const grid::Area area({.columns = 4, .rows = 4, .cell_m = 10.0});
  GridDesk grid_desk(&source, area, grid::BernoulliGrid::Options());
  desk_ = &grid_desk;
  RemoteLooks remote_looks(*this);
  EXPECT_TRUE(remote_looks.look(0.5, 0).indices.empty());  // ledgers are off
  const Looks seen = remote_looks.look(0.75, 6);
  EXPECT_TRUE(std::ranges::equal(seen.indices, source.indices));
  ASSERT_EQ(seen.looks.size(), 2U);
  EXPECT_EQ(seen.looks[0].cell, 6);
  EXPECT_EQ(seen.looks[0].ratio, 0.75);
  EXPECT_EQ(seen.looks[1].n, 3.0);
  expect_last_is_guarded(acts);
  EXPECT_EQ(grid_desk.belief().probability(3), 0.5);  // nobody has told

  struct Account final : SightingAccount {
    void saw_place(AgentId agent, const Eigen::Vector2d& place_m,
                   const localization::RelativeSighting& seen) override {
      heard.push_back(agent + place_m.x() + place_m.y() + seen.range_m + seen.sigma_bearing_rad);
    }
    void saw_robot(AgentId agent, AgentId other,
                   const localization::RelativeSighting& seen) override {
      heard.push_back(agent + 100 * other + seen.bearing_rad);
    }
    std::vector<double> heard;
  } account;
  PoseDesk pose_desk(account, 1, 3);
  desk_ = &pose_desk;
  RemoteSightings sightings(*this);
  sightings.saw_place(9, {10.0, 20.0}, {0.5, 0.25, 0.125, 0.0625});
  expect_last_is_guarded([&account] { return account.heard.size(); });
  EXPECT_EQ(account.heard.front(), 31.5625);
  account.heard.clear();
  sightings.saw_robot(9, 2, {0.5, 0.25, 0.125, 0.0625});
  EXPECT_EQ(account.heard, std::vector<double>(2, 201.25));
  EXPECT_THROW(sightings.saw_robot(9, 3, {0.5, 0.25, 0.125, 0.0625}), BrokenInvariant);
  EXPECT_FALSE(pose_desk.own_pose());  // nobody has told
}

TEST_F(Desks, WhoHasNoDeskCannotAsk) {
  const Bytes question(1, static_cast<std::byte>(Question::pose));
  expect_refused(question);
  expect_refused({});
  expect_refused(Bytes(1, static_cast<std::byte>(static_cast<int>(question_last) + 1)));
  TrackDesk blind(nullptr, 10);
  desk_ = &blind;
  RemotePlots plots(*this);
  Plots out;
  EXPECT_THROW(plots.scan(0, out), BrokenInvariant);
  EXPECT_THROW(take_notes(Bytes(3, std::byte{1}), context_, desk_, answer_), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::remote
