#include "agents/context.hpp"

#include <cmath>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/world/motion.hpp"

namespace hearsay {

Context::Context(Simulation& simulation, RadioPort& radio, Identity identity, Service service)
    : simulation_(simulation), radio_(radio), identity_(std::move(identity)), service_(service) {}

double Context::parameter(const std::string& name, double otherwise) const {
  const auto found = identity_.parameters.find(name);
  return found == identity_.parameters.end() ? otherwise : found->second;
}

Stream Context::stream(std::string_view purpose) const {
  return simulation_.stream(Purpose(purpose), Entity::agent(id()));
}

Stream Context::stream_at(std::string_view purpose, std::uint64_t count) const {
  return simulation_.stream_at(Purpose(purpose), Entity::agent(id()), count);
}

Time Context::go_to(const std::array<double, 2>& place_m, double speed_m_per_s) {
  require(steered(), "an agent that is not steered cannot go anywhere");
  const Point here = position();
  if (here[0] == place_m[0] && here[1] == place_m[1]) {
    stay();
    return now();
  }
  const Leg leg = motion::leg_to(now(), here, {place_m[0], place_m[1], here[2]}, speed_m_per_s);
  steer(leg);
  return leg.end;
}

void Context::stay() { steer({.begin = now(), .from_m = position()}); }

void Context::steer(const Leg& leg) {
  require(steered(), "an agent that is not steered can neither go nor stay");
  service_.steers->steer(id(), leg);
}

bool Context::send(const Outgoing& packet) {
  if (packet.acknowledged) return radio_.send(id(), packet);
  if (service_.gossip) return service_.gossip->write(packet);
  if (!service_.acknowledged) return radio_.send(id(), packet);
  Outgoing safe = packet;
  safe.acknowledged = true;
  return packet.receiver == no_agent ? send_to_each(std::move(safe)) : radio_.send(id(), safe);
}

// Neighbours are copied first: sending may ask for them, too.
bool Context::send_to_each(Outgoing packet) {
  const std::span<const AgentId> now = neighbours();
  listeners_.assign(now.begin(), now.end());
  bool any = false;
  for (const AgentId neighbour : listeners_) {
    packet.receiver = neighbour;
    any |= radio_.send(id(), packet);
  }
  return any;
}

bool Context::broadcast(std::string_view kind, std::span<const std::byte> bytes) {
  Outgoing packet;
  packet.kind = simulation_.record().name(kind);
  packet.bytes = bytes;
  return send(packet);
}

void Context::record(std::string_view name, double value) {
  Record& record = simulation_.record();
  record.series(now(), id(), record.name(""), record.name(name), value);
}

void Context::record_final(std::string_view name, double value) {
  Record& record = simulation_.record();
  record.scalar(id(), record.name(name), value);
}

void Context::record_event(std::string_view kind, std::string_view detail) {
  simulation_.record().event(now(), id(), kind, detail);
}

}  // namespace hearsay
