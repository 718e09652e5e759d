// A robot whose floor is in another process: its body and the account of its trips where it lives,
// and who answers for it in the world.
#pragma once

#include <span>

#include "agents/remote/distant_world.hpp"
#include "agents/robots/robot_body.hpp"
#include "agents/trails/trail_account.hpp"

namespace hearsay::remote {

class RemoteBody final : public RobotBody {
 public:
  /// `asker` outlives this. Asks where it is.
  explicit RemoteBody(Asker& asker);

  const drive::Pose& pose() const override { return pose_; }
  void scan(std::span<double> distances_m) override;
  plan::RobotFloor::Step drive(const drive::Command& wanted, double dt_s) override;
  bool happens(trails::EventId event) override;
  bool put_back(std::uint64_t count) override;
  std::optional<plan::Path> way(trails::EventId event) override;

 private:
  Asking asking_;
  drive::Pose pose_;  // nobody else moves it
};

/// Of one robot; numbers of robots that it is told do not matter.
class RemoteAccount final : public TrailAccount {
 public:
  /// `asker` outlives this.
  explicit RemoteAccount(Asker& asker) : asking_(asker) {}

  void sets_off(int robot) override;
  void drove(int robot, double length_m, bool blocked, Doing doing, double dt_s) override;
  bool arrived(int robot, trails::EventId event) override;
  void dropped(int robot) override;
  void told(int robot, std::span<const trails::Crumb> crumbs) override;
  void gave_up(int robot) override;
  void learned(int robot, trails::RobotId from, std::span<const trails::Identity> crumbs) override;
  bool all_arrived() override;

 private:
  void note(Question question);
  Asking asking_;
};

/// Tells what a robot knows of trails.
class TrailReporter final : public Reporter {
 public:
  /// `mind` outlives this.
  explicit TrailReporter(const TrailMind& mind) : mind_(mind) {}
  void report(Packer& out) override;

 private:
  const TrailMind& mind_;
};

/// In the world: answers for a robot, and knows what it reports.
class RobotDesk final : public Desk, public TrailMind {
 public:
  /// `rays`: of its scanner. Both outlive this.
  RobotDesk(RobotBody& body, TrailAccount& account, int robot, std::size_t rays);
  void answer(Question question, Unpacker& in, Packer& out) override;
  bool is_sound(std::span<const std::byte> report) const override;

  std::size_t crumbs_known() const override;
  trails::TrailCounts crumbs_counted() const override;
  void each_crumb(const std::function<void(const trails::Crumb&)>& look) const override;
  drive::Pose believed_pose() const override;

 private:
  bool answer_of_body(Question question, Unpacker& in, Packer& out);
  bool take_account(Question question, Unpacker& in, Packer& out);
  /// What it knows, but for the crumbs.
  struct Head {
    drive::Pose believed;
    trails::TrailCounts counts;
    std::size_t crumbs = 0;
  };
  Head take_head(Unpacker& in) const;

  RobotBody& body_;
  TrailAccount& account_;
  int robot_;
  std::vector<double> scan_m_;
  std::vector<trails::Crumb> crumbs_;
  std::vector<trails::Identity> identities_;
};

}  // namespace hearsay::remote
