#include "agents/forager_agent.hpp"

#include <cmath>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

// A waypoint of the map is passed at this distance.
constexpr double waypoint_m = 0.3;
// A map is asked anew so often: barriers and sources change, and robots leave their way.
constexpr double map_again_s = 10.0;
// More turning than this, and less way, is a step of turning (Shamshirdar's program counts steps
// that are no turns).
constexpr double turning_rad_per_s = 0.3;

drive::Odometer::Options odometry_of(const ForagerAgent::Options& options,
                                     const drive::Pose& pose) {
  drive::Odometer::Options odometry = options.odometry;
  odometry.start = options.shared_frame ? pose : drive::Pose{};
  return odometry;
}

}  // namespace

ForagerAgent::ForagerAgent(Context& context, RobotBody& body, TrailAccount& account,
                           const Options& options)
    : Agent(context),
      body_(body),
      account_(account),
      options_(options),
      estimator_(options.estimator),
      follower_(options.follower),
      pilot_(options.pilot, *options.fan),
      frame_(options.shared_frame ? drive::Pose{} : body.pose()),
      odometer_(odometry_of(options, body.pose()), context.simulation().seed(), context.id()),
      draws_(context.stream("forager")),
      message_kind_(context.simulation().record().name("trail")),
      scan_m_(options.fan->directions().size()) {
  require(!options_.task.empty(), "forager: a robot is after something");
  require(context.steered(), "forager: its radio goes where it goes");
}

void ForagerAgent::start() {
  if (options_.respawn) set_off();
  spawn(control());
  if (options_.telling == Telling::periodic) spawn(talk());
}

Process ForagerAgent::control() {
  for (std::uint64_t k = instants_before(context().now(), Time(), options_.period);; ++k) {
    co_await context().sleep_until(Time::at(options_.period * static_cast<std::int64_t>(k)));
    if (context().up()) {
      step();
    } else {
      estimator_.store().advance(now_s());  // crumbs grow old in whoever holds them
    }
  }
}

Process ForagerAgent::talk() {
  for (std::uint64_t tick = options_.talk->next_tick(context().now());; ++tick) {
    co_await context().sleep_until(options_.talk->tick(tick));
    if (context().up()) tell();
  }
}

void ForagerAgent::step() {
  if (to_put_back_ && !put_back()) return;
  if (waits_) {
    account_.drove(options_.robot, 0.0, false, Doing::waiting, dt_s());
    if (!account_.all_arrived()) return;
    waits_ = false;
    set_off();
  }
  if (body_.happens(goal())) arrive();
  if (to_put_back_ || waits_) return;
  body_.scan(scan_m_);
  Decision decision = decide();
  if (pilot_.panicking()) decision.doing = Doing::panicking;
  drive(decision);
}

void ForagerAgent::arrive() {
  const bool ends_trip = account_.arrived(options_.robot, goal());
  const bool first = ends_trip && !std::exchange(has_made_trip_, true);
  account_.told(options_.robot, estimator_.visit(goal(), believed(), now_s(), way()));
  follower_.arrived(draws_);
  pilot_.reset();
  aim_ = (aim_ + 1) % options_.task.size();
  if (options_.telling == Telling::at_once || options_.telling == Telling::at_event) tell();
  waits_ = options_.wait_for_all && first;
  to_put_back_ = options_.respawn && !put_back();
  map_made_.reset();
  if (!waits_ && !to_put_back_) set_off();
}

bool ForagerAgent::put_back() {
  to_put_back_ = true;
  if (!body_.put_back(times_put_back_++)) return false;
  to_put_back_ = false;
  estimator_.carried();
  // Who carries it tells it where it is.
  odometer_.set(drive::relative_to(frame_, body_.pose()));
  carry_radio();
  pilot_.reset();
  follower_.reset();
  if (!waits_) set_off();
  return true;
}

void ForagerAgent::set_off() {
  estimator_.set_off_anew();
  account_.gave_up(options_.robot);
  account_.sets_off(options_.robot);
}

ForagerAgent::Decision ForagerAgent::decide() {
  if (options_.navigation == Navigation::map) return by_map();
  const Pilot::Senses senses{now_s(), scan_m_, odometer_.pose()};
  // Tasks that begin together: until all have come by a way of their own, none follows another's.
  const bool alone = options_.wait_for_all && !account_.all_arrived();
  if (options_.navigation == Navigation::trails && !alone) return by_trails(senses);
  return {pilot_.explore(senses, draws_), Doing::exploring};
}

ForagerAgent::Decision ForagerAgent::by_trails(const Pilot::Senses& senses) {
  const double free_left_m =
      std::max(0.0, pilot_.free_m(senses, 0.5 * math::pi) - options_.pilot.radius_m);
  const TrailFollower::Choice choice =
      follower_.choose(estimator_.store(), goal(), odometer_.pose(), now_s(), free_left_m, draws_);
  const plan::Point target{choice.target.x_m, choice.target.y_m};
  // Who does not know what to do at the end of a trail is at home there.
  const bool stays = options_.follower.trail_end == TrailFollower::TrailEnd::none;
  Decision decision;
  switch (choice.way) {
    case TrailFollower::Way::explore:
      decision = {pilot_.explore(senses, draws_), Doing::exploring};
      break;
    case TrailFollower::Way::follow:
      decision = {
          stays ? pilot_.towards(senses, target, draws_) : pilot_.through(senses, target, draws_),
          Doing::following};
      break;
    case TrailFollower::Way::search:
      decision = {pilot_.search(senses, target, options_.search_radius_m, draws_),
                  Doing::searching};
      break;
  }
  return decision;
}

ForagerAgent::Decision ForagerAgent::by_map() {
  const drive::Pose& here = body_.pose();
  const Pilot::Senses senses{now_s(), scan_m_, here};
  const bool old = map_made_ && (context().now() - *map_made_).seconds() >= map_again_s;
  if (!map_made_ || old) {
    map_made_ = context().now();
    map_next_ = 0;
    const auto way = body_.way(goal());
    map_way_ = way ? *way : plan::Path{};
  }
  const auto near = [&](const plan::Point& p) {
    const double dx = p.x_m - here.x_m, dy = p.y_m - here.y_m;
    return dx * dx + dy * dy < waypoint_m * waypoint_m;
  };
  while (map_next_ + 1 < map_way_.points.size() && near(map_way_.points[map_next_])) ++map_next_;
  if (map_next_ >= map_way_.points.size()) {
    return {pilot_.explore(senses, draws_), Doing::exploring};
  }
  return {pilot_.through(senses, map_way_.points[map_next_], draws_), Doing::following};
}

void ForagerAgent::drive(const Decision& decision) {
  const drive::Pose before = body_.pose();
  const auto step = body_.drive(decision.command, dt_s());
  odometer_.drove(step.done, dt_s());
  const double length_m = std::fabs(step.done.forward_m_per_s) * dt_s();
  account_.drove(options_.robot, length_m, step.blocked, decision.doing, dt_s());
  const drive::Pose& after = body_.pose();
  const bool moved = before.x_m != after.x_m || before.y_m != after.y_m;
  if (moved || radio_moves_) carry_radio();
  radio_moves_ = moved;
  if (moved) lay(step.done);
}

void ForagerAgent::lay(const drive::Command& done) {
  if (options_.navigation != Navigation::trails) return;
  if (std::fabs(done.turn_rad_per_s) < turning_rad_per_s) way_s_ += dt_s();
  const trails::Laid laid = estimator_.lay(now_s(), believed(), way(), goal());
  if (laid == trails::Laid::crumb) account_.dropped(options_.robot);
  if (laid == trails::Laid::abandoned) {
    account_.gave_up(options_.robot);
    if (options_.respawn) put_back();
  }
  const bool told_at_once = options_.estimator.laying == trails::Laying::at_once;
  if (laid != trails::Laid::crumb || !told_at_once) return;
  account_.told(options_.robot, std::span(&estimator_.laid(), 1));
  if (options_.telling == Telling::at_once) tell();
}

void ForagerAgent::carry_radio() {
  const drive::Pose& pose = body_.pose();
  const Point here = context().position();
  const double dx = pose.x_m - here[0], dy = pose.y_m - here[1];
  const double length_m = std::sqrt(dx * dx + dy * dy);
  if (length_m == 0.0) {
    context().stay();
  } else {
    context().go_to({pose.x_m, pose.y_m}, length_m / dt_s());
  }
}

void ForagerAgent::tell() {
  const auto step = static_cast<std::uint64_t>((context().now() - Time()) / options_.period);
  if (step != told_step_) parts_ = 0;
  told_step_ = step;
  for (const auto& bytes : estimator_.speech(now_s())) {
    Outgoing packet;
    packet.kind = message_kind_;
    packet.bytes = bytes;
    // Channel draws go by the time of talking: what else was said shifts none. Each packet has its
    // own, and takes no other's place in a queue.
    packet.tick = step * packets_a_step_max + parts_++;
    packet.subject = *packet.tick;
    if (!context().send(packet)) ++not_sent_;
  }
}

void ForagerAgent::on_packet(const Packet& packet) {
  if (packet.kind != message_kind_) return;
  const auto crumbs = estimator_.heard(packet.bytes, now_s());
  if (!crumbs.empty()) account_.learned(options_.robot, estimator_.heard_from(), crumbs);
}

void ForagerAgent::on_down() {
  if (radio_moves_) context().stay();
  radio_moves_ = false;
}

void ForagerAgent::on_up(bool forgets) {
  pilot_.reset();
  follower_.reset();
  map_made_.reset();
  if (!forgets) return;
  estimator_.forget();
  account_.gave_up(options_.robot);
}

void ForagerAgent::finish() {
  const TrailEstimator::Counts& counts = estimator_.counts();
  const auto leave = [&](const char* name, std::uint64_t value) {
    context().record_final(name, static_cast<double>(value));
  };
  leave("crumbs_laid", counts.laid);
  leave("crumbs_heard", counts.heard);
  leave("messages_refused", counts.refused);
  leave("messages_no_frame", counts.no_frame);
  leave("messages_not_sent", not_sent_);
  leave("trails_abandoned", counts.abandoned);
}

}  // namespace hearsay
