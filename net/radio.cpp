#include "net/radio.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr std::uint64_t ticks_max = std::uint64_t{1} << 48;
constexpr std::size_t fetch_from = 2048;  // fewer radios are in the cache anyway

const RadioOptions& checked(const RadioOptions& options) {
  check(options);
  return options;
}

}  // namespace

Radio::Radio(Simulation& simulation, Reach reach, const RadioOptions& options)
    : simulation_(simulation),
      options_(checked(options)),
      channel_(simulation, std::move(reach), options_),
      traffic_(simulation.record(), channel_.agents(), options_.count_links),
      receivers_(static_cast<std::size_t>(channel_.agents()), nullptr),
      stations_(static_cast<std::size_t>(channel_.agents())),
      access_(make_access(options_.access, simulation, channel_.agents(), *this)) {
  if (!access_ && !options_.half_duplex) return;
  receptions_ =
      std::make_unique<Receptions>(channel_.agents(),
                                   Receptions::Options{.half_duplex = options_.half_duplex,
                                                       .collisions = access_ != nullptr,
                                                       .capture_db = options_.capture_db},
                                   access_ ? access_->listener() : nullptr);
}

Radio::~Radio() {
  for (const std::uint32_t slot : slots_.under_way()) simulation_.cancel(slots_[slot].event);
  for (const Station& station : stations_) simulation_.cancel(station.next);
}

void Radio::refuse(AgentId agent, const char* role) const {
  throw BrokenInvariant("radio: " + std::string(role) + " " + std::to_string(agent) +
                        " is not there (agents are 0 … " + std::to_string(channel_.agents() - 1) +
                        ")");
}

void Radio::attach(AgentId agent, Receiver& receiver) {
  receivers_[index(agent, "receiver")] = &receiver;
}

std::uint32_t Radio::frames_of(std::uint64_t bytes) const {
  if (!options_.mtu_bytes || bytes == 0) return 1;
  return static_cast<std::uint32_t>((bytes - 1) / *options_.mtu_bytes + 1);
}

std::uint64_t Radio::air_bytes(std::uint64_t bytes) const {
  return bytes + std::uint64_t{frames_of(bytes)} * options_.header_bytes;
}

// Of many packets in a row it is the same. What takes longer than 9e9 s takes 9e9 s.
Duration Radio::air_time(std::uint64_t bytes) {
  if (bytes != air_bytes_) {
    air_bytes_ = bytes;
    const double s = static_cast<double>(bytes) * 8.0 / options_.rate_bps;
    air_time_ = Duration::seconds(std::min(s, 9e9));
  }
  return air_time_;
}

void Radio::require_sound(AgentId sender, const Outgoing& packet) const {
  index(sender, "sender");
  if (packet.receiver != no_agent) index(packet.receiver, "receiver");
  require(!packet.tick || *packet.tick < ticks_max, "radio: a tick must be below 2^48");
  require(packet.bytes.size() <= std::numeric_limits<std::uint32_t>::max(),
          "radio: a packet must be below 4 GiB");
  require(!packet.acknowledged || packet.receiver != no_agent,
          "radio: a broadcast cannot be acknowledged");
  require(frames_of(packet.bytes.size()) <= frames_max, "radio: too many frames");
  if (!options_.queue.bytes_max) return;
  const std::uint64_t bytes = air_bytes(packet.bytes.size());
  if (bytes > *options_.queue.bytes_max) {
    throw InputError("radio: a packet of " + std::to_string(bytes) +
                     " bytes with headers does not fit into a queue of queue_bytes_max = " +
                     std::to_string(*options_.queue.bytes_max));
  }
}

// In the slotted ways a frame must fit into its slot.
void Radio::require_fits_slot(std::uint64_t bytes) {
  const Sharing sharing = options_.access.sharing;
  if (sharing != Sharing::slotted_aloha && sharing != Sharing::tdma) return;
  if (options_.mtu_bytes) bytes = std::min<std::uint64_t>(bytes, *options_.mtu_bytes);
  bytes += options_.header_bytes;
  const Duration takes = air_time(bytes);
  if (takes <= options_.access.slot) return;
  std::ostringstream text;
  text << "radio: a frame of " << bytes << " bytes with its header takes " << takes.seconds()
       << " s, longer than slot_s = " << options_.access.slot.seconds();
  throw InputError(text.str());
}

std::uint32_t Radio::take(AgentId sender, const Outgoing& packet) {
  const std::uint32_t slot = slots_.take();
  Transmission& t = slots_[slot];
  slots_.fill(t, packet.bytes);
  t.sender = sender;
  t.receiver = packet.receiver;
  t.rider = packet.rider;
  t.kind = packet.kind;
  t.subject = packet.subject;
  t.has_tick = packet.tick.has_value();
  t.index = packet.tick.value_or(0);
  t.acknowledged = packet.acknowledged;
  t.frames = frames_of(packet.bytes.size());
  t.sent = simulation_.now();
  return slot;
}

void Radio::aim(Transmission& t, bool draws) {
  channel_.aim(t, draws);
  traffic_.sender(t.sender).expected += t.route.size;
  // Who will soon be called: in a large crowd each is far from the one before.
  if (receivers_.size() < fetch_from) return;
  const Route route = t.route;
  for (std::size_t i = 0; i < route.size; ++i) {
    __builtin_prefetch(receivers_[static_cast<std::size_t>(route.hearer(i))]);
    if (receptions_) receptions_->expect(route.hearer(i));
  }
}

bool Radio::send(AgentId sender, const Outgoing& packet) {
  require_sound(sender, packet);
  require_fits_slot(packet.bytes.size());
  Station& from = station(sender);
  ++traffic_.sender(sender).packets;
  const std::uint32_t slot = take(sender, packet);
  if (!from.up) {
    settle_rest(slot, Fate::sender_down);
    return false;
  }
  if (!access_ && from.waiting.empty() && !busy(sender, simulation_.now())) {
    begin(slot);
    return true;
  }
  if (!admit(sender, slot)) {
    settle_rest(slot, Fate::queue_full);
    return false;
  }
  wake(sender);
  return true;
}

// Puts the packet into the queue, if there is room or the policy makes some.
bool Radio::admit(AgentId sender, std::uint32_t slot) {
  Station& from = station(sender);
  const QueueOptions& queue = options_.queue;
  const std::uint64_t bytes = air_bytes(slots_[slot].bytes.size());
  if (channel_.foreseen()) aim(slots_[slot], true);
  drop_expired(sender);
  if (queue.policy == QueuePolicy::replace && replace_waiting(sender, slot)) return true;
  const bool sends = from.sends(simulation_.now());
  const std::uint64_t sending_bytes = sends ? air_bytes(slots_[from.on_air].bytes.size()) : 0;
  const auto full = [&] {
    return from.waiting.size() + (sends ? 1 : 0) >= queue.packets_max ||
           (queue.bytes_max && from.waiting.bytes() + sending_bytes + bytes > *queue.bytes_max);
  };
  while (queue.policy == QueuePolicy::drop_oldest && full() && !from.waiting.empty()) {
    settle_rest(from.waiting.pop(), Fate::queue_full);
  }
  if (full()) return false;
  from.waiting.push(slot, bytes);
  return true;
}

bool Radio::replace_waiting(AgentId sender, std::uint32_t slot) {
  SendQueue& waiting = station(sender).waiting;
  const Transmission& news = slots_[slot];
  for (std::size_t i = 0; i < waiting.size(); ++i) {
    const std::uint32_t old = waiting[i];
    const Transmission& t = slots_[old];
    if (t.kind != news.kind || t.receiver != news.receiver || t.subject != news.subject) continue;
    waiting.replace(i, slot, air_bytes(news.bytes.size()));
    settle_rest(old, Fate::replaced);
    return true;
  }
  return false;
}

// Gives the packet this fate wherever it has none, and lets go of it.
void Radio::settle_rest(std::uint32_t slot, Fate fate) {
  Transmission& t = slots_[slot];
  if (!t.aimed) aim(t, false);
  MessageRow row = t.row(simulation_.now());
  for (; !t.done(); ++t.settled) {
    traffic_.settle(row, t.route.ear(t.settled), fate);
  }
  slots_.release(slot);
}

// The next arrival, unless it is later than any event can be.
void Radio::schedule(std::uint32_t slot) {
  Transmission& t = slots_[slot];
  t.event = EventId();
  const Time next = t.next();
  if (next == Time::never()) return;
  t.event = simulation_.schedule(next, Phase::update, [this, slot] { arrive(slot); });
}

// What else becomes of a packet at a hearer whom it reaches now.
Fate Radio::fate_on_arrival(const Transmission& t, std::size_t i) const {
  Fate fate = t.fates[i];
  worsen(fate, channel_.fate_on_arrival(t, i));
  if (!up_throughout(t.route.hearer(i), t.start)) worsen(fate, Fate::receiver_down);
  return fate;
}

void Radio::deliver(const Packet& packet) {
  Receiver* const receiver = receivers_[static_cast<std::size_t>(packet.receiver)];
  if (!receiver) return;
  simulation_.acting_for(packet.receiver);
  receiver->on_packet(packet);
}

// Goes from hearer to hearer, as far as nothing else comes between.
void Radio::arrive(std::uint32_t slot) {
  Transmission& t = slots_[slot];
  if (t.acknowledged) return arrive_acknowledged(slot);
  const Route route = t.route;  // it does not change any more
  MessageRow row = t.row(simulation_.now());
  Packet packet = t.packet(no_agent);
  while (t.settled < route.size) {
    const Ear ear = route.ear(t.settled);
    const Time time = later(t.arrives, ear.delay);
    if (time > row.arrived) {
      if (!simulation_.go_on(time, Phase::update)) return schedule(slot);
      row.arrived = time;
    }
    const Fate fate = fate_now(t, t.settled++);
    traffic_.settle(row, ear, fate);
    packet.receiver = ear.agent;
    if (fate == Fate::delivered) deliver(packet);
  }
  slots_.release(slot);
}

void Radio::set_up(AgentId agent, bool up) {
  Station& s = stations_[index(agent, "agent")];
  if (s.up == up) return;
  up_since_.resize(stations_.size());
  s.up = up;
  up_since_[static_cast<std::size_t>(agent)] = simulation_.now();
  if (up) return;
  if (access_) access_->withdraw(agent);
  while (!s.waiting.empty()) settle_rest(s.waiting.pop(), Fate::sender_down);
  cut_off(agent);
}

void Radio::finish() {
  const Time now = simulation_.now();
  for (const std::uint32_t slot : slots_.under_way()) {
    Transmission& t = slots_[slot];
    simulation_.cancel(t.event);
    if (t.end > now) traffic_.sender(t.sender).air_time -= t.end - now;
    if (t.answering) traffic_.sender(t.receiver).air_time -= t.answer_end - now;
    settle_rest(slot, Fate::in_flight_at_end);
  }
  for (AgentId agent = 0; agent < channel_.agents(); ++agent) {
    Station& s = station(agent);
    simulation_.cancel(s.next);
    s.next = EventId();
    s.held = s.asked = false;
    if (access_) access_->withdraw(agent);
    while (!s.waiting.empty()) s.waiting.pop();
  }
  if (receptions_) receptions_->clear();
  for (AgentId sender = 0; sender < channel_.agents(); ++sender) {
    require_balance(sender, counts(sender));
  }
}

}  // namespace hearsay
