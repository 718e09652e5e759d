#include "agents/remote/remote_body.hpp"

#include <cmath>

#include "sim/kernel/error.hpp"

namespace hearsay::remote {
namespace {

// Bytes of an identity and of a crumb.
constexpr std::size_t identity_bytes = 12, crumb_bytes = 40;

void put(Packer& out, const drive::Pose& pose) {
  out.f64(pose.x_m);
  out.f64(pose.y_m);
  out.f64(pose.heading_rad);
}

drive::Pose take_pose(Unpacker& in) {
  drive::Pose pose;
  pose.x_m = in.f64();
  pose.y_m = in.f64();
  pose.heading_rad = in.f64();
  return pose;
}

void put(Packer& out, const drive::Command& command) {
  out.f64(command.forward_m_per_s);
  out.f64(command.turn_rad_per_s);
}

drive::Command take_command(Unpacker& in) {
  drive::Command command;
  command.forward_m_per_s = in.f64();
  command.turn_rad_per_s = in.f64();
  return command;
}

void put(Packer& out, const trails::Identity& identity) {
  out.u32(identity.robot);
  out.u32(identity.incarnation);
  out.u32(identity.number);
}

trails::Identity take_identity(Unpacker& in) {
  trails::Identity identity;
  identity.robot = in.u32();
  identity.incarnation = in.u32();
  identity.number = in.u32();
  return identity;
}

void put(Packer& out, const trails::Crumb& crumb) {
  out.u32(crumb.event);
  out.u32(crumb.goal);
  out.f32(crumb.position.x_m);
  out.f32(crumb.position.y_m);
  out.f32(crumb.distance_s);
  out.f64(crumb.created_s);
  put(out, crumb.identity);
}

trails::Crumb take_crumb(Unpacker& in) {
  trails::Crumb crumb;
  crumb.event = in.u32();
  crumb.goal = in.u32();
  crumb.position.x_m = in.f32();
  crumb.position.y_m = in.f32();
  crumb.distance_s = in.f32();
  crumb.created_s = in.f64();
  crumb.identity = take_identity(in);
  return crumb;
}

void put(Packer& out, const std::optional<plan::Path>& path) {
  out.flag(path.has_value());
  if (!path) return;
  out.f64(path->length_m);
  out.count(path->points.size());
  for (const plan::Point& point : path->points) {
    out.f64(point.x_m);
    out.f64(point.y_m);
  }
}

bool take_only_flag(Unpacker in) {
  const bool flag = in.flag();
  require_whole(in);
  return flag;
}

}  // namespace

RemoteBody::RemoteBody(Asker& asker) : asking_(asker) {
  asking_.begin(Question::pose);
  Unpacker in = asking_.ask();
  pose_ = take_pose(in);
  require_whole(in);
}

void RemoteBody::scan(std::span<double> distances_m) {
  asking_.begin(Question::scan);
  Unpacker in = asking_.ask();
  for (double& distance_m : distances_m) distance_m = in.f64();
  require_whole(in);
}

plan::RobotFloor::Step RemoteBody::drive(const drive::Command& wanted, double dt_s) {
  Packer out = asking_.begin(Question::drive);
  put(out, wanted);
  out.f64(dt_s);
  Unpacker in = asking_.ask();
  plan::RobotFloor::Step step;
  step.done = take_command(in);
  step.blocked = in.flag();
  const drive::Pose pose = take_pose(in);
  require_whole(in);
  pose_ = pose;
  return step;
}

bool RemoteBody::happens(trails::EventId event) {
  asking_.begin(Question::happens).u32(event);
  return take_only_flag(asking_.ask());
}

bool RemoteBody::put_back(std::uint64_t count) {
  asking_.begin(Question::put_back).u64(count);
  Unpacker in = asking_.ask();
  const bool done = in.flag();
  const drive::Pose pose = take_pose(in);
  require_whole(in);
  pose_ = pose;
  return done;
}

std::optional<plan::Path> RemoteBody::way(trails::EventId event) {
  asking_.begin(Question::way).u32(event);
  Unpacker in = asking_.ask();
  if (!in.flag()) {
    require_whole(in);
    return std::nullopt;
  }
  plan::Path path;
  path.length_m = in.f64();
  path.points.resize(in.count(16));
  for (plan::Point& point : path.points) {
    point.x_m = in.f64();
    point.y_m = in.f64();
  }
  require_whole(in);
  return path;
}

void RemoteAccount::note(Question question) {
  asking_.begin(question);
  asking_.note();
}

void RemoteAccount::sets_off(int) { note(Question::sets_off); }
void RemoteAccount::dropped(int) { note(Question::dropped); }
void RemoteAccount::gave_up(int) { note(Question::gave_up); }

void RemoteAccount::drove(int, double length_m, bool blocked, Doing doing, double dt_s) {
  Packer out = asking_.begin(Question::drove);
  out.f64(length_m);
  out.flag(blocked);
  out.u8(static_cast<std::uint8_t>(doing));
  out.f64(dt_s);
  asking_.note();
}

bool RemoteAccount::arrived(int, trails::EventId event) {
  asking_.begin(Question::arrived).u32(event);
  return take_only_flag(asking_.ask());
}

void RemoteAccount::told(int, std::span<const trails::Crumb> crumbs) {
  Packer out = asking_.begin(Question::told);
  out.count(crumbs.size());
  for (const trails::Crumb& crumb : crumbs) put(out, crumb);
  asking_.note();
}

void RemoteAccount::learned(int, trails::RobotId from, std::span<const trails::Identity> crumbs) {
  Packer out = asking_.begin(Question::learned);
  out.u32(from);
  out.count(crumbs.size());
  for (const trails::Identity& crumb : crumbs) put(out, crumb);
  asking_.note();
}

bool RemoteAccount::all_arrived() {
  asking_.begin(Question::all_arrived);
  return take_only_flag(asking_.ask());
}

void TrailReporter::report(Packer& out) {
  put(out, mind_.believed_pose());
  const trails::TrailCounts counts = mind_.crumbs_counted();
  for (const std::uint64_t count : {counts.taken, counts.known, counts.late, counts.no_room,
                                    counts.refused, counts.vanished, counts.dropped}) {
    out.u64(count);
  }
  out.count(mind_.crumbs_known());
  mind_.each_crumb([&out](const trails::Crumb& crumb) { put(out, crumb); });
}

RobotDesk::RobotDesk(RobotBody& body, TrailAccount& account, int robot, std::size_t rays)
    : body_(body), account_(account), robot_(robot), scan_m_(rays) {}

void RobotDesk::answer(Question question, Unpacker& in, Packer& out) {
  if (answer_of_body(question, in, out) || take_account(question, in, out)) return;
  throw BrokenInvariant("a robot elsewhere asks for what no robot has");
}

bool RobotDesk::answer_of_body(Question question, Unpacker& in, Packer& out) {
  switch (question) {
    case Question::pose:
      require_whole(in);
      put(out, body_.pose());
      return true;
    case Question::scan:
      require_whole(in);
      body_.scan(scan_m_);
      for (const double distance_m : scan_m_) out.f64(distance_m);
      return true;
    case Question::drive: {
      const drive::Command wanted = take_command(in);
      const double dt_s = in.f64();
      require_whole(in);
      const plan::RobotFloor::Step step = body_.drive(wanted, dt_s);
      put(out, step.done);
      out.flag(step.blocked);
      put(out, body_.pose());
      return true;
    }
    case Question::happens: {
      const trails::EventId event = in.u32();
      require_whole(in);
      out.flag(body_.happens(event));
      return true;
    }
    case Question::put_back: {
      const std::uint64_t count = in.u64();
      require_whole(in);
      out.flag(body_.put_back(count));
      put(out, body_.pose());
      return true;
    }
    case Question::way: {
      const trails::EventId event = in.u32();
      require_whole(in);
      put(out, body_.way(event));
      return true;
    }
    default:
      return false;
  }
}

bool RobotDesk::take_account(Question question, Unpacker& in, Packer& out) {
  switch (question) {
    case Question::sets_off:
      require_whole(in);
      account_.sets_off(robot_);
      return true;
    case Question::drove: {
      const double length_m = in.f64();
      const bool blocked = in.flag();
      const std::uint8_t doing = in.u8();
      const double dt_s = in.f64();
      require_whole(in);
      require(doing < TrailAccount::doings, "a robot elsewhere does what no robot does");
      account_.drove(robot_, length_m, blocked, static_cast<TrailAccount::Doing>(doing), dt_s);
      return true;
    }
    case Question::arrived: {
      const trails::EventId event = in.u32();
      require_whole(in);
      out.flag(account_.arrived(robot_, event));
      return true;
    }
    case Question::dropped:
      require_whole(in);
      account_.dropped(robot_);
      return true;
    case Question::told:
      crumbs_.resize(in.count(crumb_bytes));
      for (trails::Crumb& crumb : crumbs_) crumb = take_crumb(in);
      require_whole(in);
      account_.told(robot_, crumbs_);
      return true;
    case Question::gave_up:
      require_whole(in);
      account_.gave_up(robot_);
      return true;
    case Question::learned: {
      const trails::RobotId from = in.u32();
      identities_.resize(in.count(identity_bytes));
      for (trails::Identity& identity : identities_) identity = take_identity(in);
      require_whole(in);
      account_.learned(robot_, from, identities_);
      return true;
    }
    case Question::all_arrived:
      require_whole(in);
      out.flag(account_.all_arrived());
      return true;
    default:
      return false;
  }
}

bool RobotDesk::is_sound(std::span<const std::byte> report) const {
  Unpacker in(report);
  const Head head = take_head(in);
  for (std::size_t left = head.crumbs; left > 0; --left) take_crumb(in);
  const drive::Pose& pose = head.believed;
  return in.done() && std::isfinite(pose.x_m) && std::isfinite(pose.y_m) &&
         std::isfinite(pose.heading_rad);
}

RobotDesk::Head RobotDesk::take_head(Unpacker& in) const {
  Head head;
  head.believed = take_pose(in);
  for (std::uint64_t* const count :
       {&head.counts.taken, &head.counts.known, &head.counts.late, &head.counts.no_room,
        &head.counts.refused, &head.counts.vanished, &head.counts.dropped}) {
    *count = in.u64();
  }
  head.crumbs = in.count(crumb_bytes);
  return head;
}

std::size_t RobotDesk::crumbs_known() const {
  Unpacker in = state();
  return take_head(in).crumbs;
}

trails::TrailCounts RobotDesk::crumbs_counted() const {
  Unpacker in = state();
  return take_head(in).counts;
}

void RobotDesk::each_crumb(const std::function<void(const trails::Crumb&)>& look) const {
  Unpacker in = state();
  for (std::size_t left = take_head(in).crumbs; left > 0; --left) look(take_crumb(in));
}

drive::Pose RobotDesk::believed_pose() const {
  Unpacker in = state();
  return take_head(in).believed;
}

}  // namespace hearsay::remote
