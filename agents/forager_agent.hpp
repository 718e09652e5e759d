// The forager: a robot that drives to and fro between places of which it knows nothing but what its
// own and its companions' trails say. Vaughan et al. 2002 (LOST), Shamshirdar 2019, chapter 4.
//
// Ten times a second, usually: it looks, learns whether the event it is after happens here, decides
// where to head (trail, exploration, the search at the end of a trail), drives, drops a crumb when
// it is time, and tells its companions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "agents/agent.hpp"
#include "agents/behaviours/pilot.hpp"
#include "agents/robots/robot_body.hpp"
#include "agents/talk/periodic.hpp"
#include "agents/trails/trail_account.hpp"
#include "agents/trails/trail_estimator.hpp"
#include "agents/trails/trail_follower.hpp"

namespace hearsay {

class ForagerAgent final : public Agent, public TrailMind {
 public:
  enum class Navigation {
    trails,
    explore,  ///< baseline: it never follows a trail
    map,      ///< upper bound: it is told its true pose and the shortest way
  };
  enum class Telling {
    never,     ///< a robot alone
    at_once,   ///< whenever it has laid a crumb
    at_event,  ///< whenever it has come to an event
    periodic,  ///< at the ticks of its talk
  };
  struct Options {
    int robot = 0;                                         ///< its number on the floor
    Duration period = Duration::nanoseconds(100'000'000);  ///< of control, > 0
    std::shared_ptr<const plan::Fan> fan;                  ///< of its scanner
    bool shared_frame = false;          ///< its odometry begins with the true pose, else at 0
    drive::Odometer::Options odometry;  ///< all but the start
    double clock_offset_s = 0.0;        ///< what its clock is ahead
    std::vector<trails::EventId> task;  ///< after each of them in turn, over and over; ≥ 1
    bool respawn = false;               ///< an event over, it is put back to its start
    bool wait_for_all = false;          ///< its first trip is without trails; then it waits for all
    Navigation navigation = Navigation::trails;
    Pilot::Options pilot;
    TrailFollower::Options follower;
    double search_radius_m = 2.0;  ///< of the search at the end of a trail, > 0
    TrailEstimator::Options estimator;
    trails::Distance distance = trails::Distance::time;
    Telling telling = Telling::at_once;
    std::optional<PeriodicTalk> talk;  ///< of Telling::periodic
  };
  /// Packets are numbered by the step of control in which they are sent, and in it: a run has at
  /// most 2^28 steps, and a step not so many packets.
  static constexpr std::uint64_t packets_a_step_max = std::uint64_t{1} << 20;

  /// All outlive the agent.
  ForagerAgent(Context& context, RobotBody& body, TrailAccount& account, const Options& options);

  void start() override;
  void on_packet(const Packet& packet) override;
  /// A dead robot stands where it is, in everybody's way.
  void on_down() override;
  void on_up(bool forgets) override;
  /// Leaves what it counted.
  void finish() override;

  std::size_t crumbs_known() const override { return estimator_.store().size(); }
  trails::TrailCounts crumbs_counted() const override { return estimator_.store().counts(); }
  void each_crumb(const std::function<void(const trails::Crumb&)>& look) const override {
    estimator_.store().for_each(look);
  }
  drive::Pose believed_pose() const override { return odometer_.pose(); }

 private:
  using Doing = TrailAccount::Doing;
  struct Decision {
    drive::Command command;
    Doing doing = Doing::exploring;
  };
  Process control();
  Process talk();
  void step();
  void arrive();
  /// Puts it back to its start; false if there is no room yet.
  bool put_back();
  void set_off();
  Decision decide();
  Decision by_trails(const Pilot::Senses& senses);
  Decision by_map();
  void drive(const Decision& decision);
  void lay(const drive::Command& done);
  /// The radio goes where the robot goes.
  void carry_radio();
  void tell();

  double dt_s() const { return options_.period.seconds(); }
  /// By its own clock.
  double now_s() const { return (context().now() - Time()).seconds() + options_.clock_offset_s; }
  double way() const { return options_.distance == trails::Distance::time ? now_s() : way_s_; }
  trails::EventId goal() const { return options_.task[aim_]; }
  trails::Point believed() const {
    return trails::point(odometer_.pose().x_m, odometer_.pose().y_m);
  }

  RobotBody& body_;
  TrailAccount& account_;
  Options options_;
  TrailEstimator estimator_;
  TrailFollower follower_;
  Pilot pilot_;
  drive::Pose frame_;  ///< the true pose at which its odometry has its origin
  drive::Odometer odometer_;
  Stream draws_;
  NameId message_kind_;
  std::vector<double> scan_m_;
  std::size_t aim_ = 0;
  double way_s_ = 0.0;  ///< driven without turning
  bool has_made_trip_ = false, waits_ = false, to_put_back_ = false, radio_moves_ = false;
  std::uint64_t told_step_ = 0, parts_ = 0, times_put_back_ = 0, not_sent_ = 0;
  plan::Path map_way_;
  std::size_t map_next_ = 0;
  std::optional<Time> map_made_;
};

}  // namespace hearsay
