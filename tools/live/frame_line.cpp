#include "tools/live/frame_line.hpp"

#include <utility>

namespace hearsay::fleet {
namespace {

using namespace std::chrono_literals;

/// How often it is looked whether the other end is alive while nothing comes.
constexpr auto patience = 100ms;

}  // namespace

FrameLine::FrameLine(Member& member, Reactor& reactor, AgentId id)
    : member_(member), reactor_(reactor) {
  out_.agent = static_cast<std::uint32_t>(id);
}

bool FrameLine::write(const remote::Order& order) {
  ++out_.number;
  remote::pack(order, out_.content);
  live::encode(out_, bytes_);
  // Where a process was killed, DDS waits a while for it, though another has taken its place.
  while (!member_.orders.write(bytes_)) {
    reactor_.wait(WallClock::now());
    if (reactor_.stopped() || presence_.gone(member_.answers.writers_alive() > 0)) return false;
  }
  return true;
}

bool FrameLine::exchange(const remote::Order& order, remote::Answer& answer) {
  if (!write(order)) return false;
  for (;;) {
    while (member_.answers.take(bytes_)) {
      // Of a process that was here before, or of a call that nobody waits for any more.
      if (!live::decode(bytes_, in_) || in_.number != out_.number) continue;
      return remote::unpack(in_.content, answer);
    }
    if (reactor_.stopped() || presence_.gone(member_.answers.writers_alive() > 0)) return false;
    reactor_.wait(WallClock::now() + patience);
  }
}

FrameSuperior::FrameSuperior(live::Reader& orders, live::Writer& answers, Reactor& reactor,
                             AgentId id, std::function<void(const remote::Order&)> progress)
    : orders_(orders), answers_(answers), reactor_(reactor), progress_(std::move(progress)) {
  out_.agent = static_cast<std::uint32_t>(id);
}

bool FrameSuperior::wait(remote::Order& order) {
  for (;;) {
    while (orders_.take(bytes_)) {
      if (!live::decode(bytes_, in_) || !remote::unpack(in_.content, order)) continue;
      out_.number = in_.number;
      if (progress_) progress_(order);
      return true;
    }
    if (reactor_.stopped() || presence_.gone(orders_.writers_alive() > 0)) return false;
    reactor_.wait(WallClock::now() + patience);
  }
}

bool FrameSuperior::exchange(const remote::Answer& answer, remote::Order& order) {
  remote::pack(answer, out_.content);
  live::encode(out_, bytes_);
  return answers_.write(bytes_) && wait(order);
}

}  // namespace hearsay::fleet
