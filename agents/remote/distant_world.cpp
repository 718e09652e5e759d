#include "agents/remote/distant_world.hpp"

#include "agents/remote/stand_in.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::remote {

Unpacker Desk::state() const {
  return Unpacker(agent_ ? agent_->state() : std::span<const std::byte>());
}

void require_whole(const Unpacker& in) {
  require(in.done(), "what an agent and its world tell each other is malformed");
}

void put(Packer& out, const Leg& leg) {
  out.i64(leg.begin.nanoseconds());
  out.i64(leg.end.nanoseconds());
  for (const double x : leg.from_m) out.f64(x);
  for (const double v : leg.velocity_m_per_s) out.f64(v);
}

Leg take_leg(Unpacker& in) {
  Leg leg;
  leg.begin = Time::nanoseconds(in.i64());
  leg.end = Time::nanoseconds(in.i64());
  for (double& x : leg.from_m) x = in.f64();
  for (double& v : leg.velocity_m_per_s) v = in.f64();
  return leg;
}

}  // namespace hearsay::remote
