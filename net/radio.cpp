#include "net/radio.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

// Two purposes, so that the n-th packet without a tick does not share the draw of tick n.
constexpr Purpose loss_of_tick("loss of a tick");
constexpr Purpose loss_of_packet("loss of a packet");
constexpr std::uint64_t ticks_max = std::uint64_t{1} << 48;

void check(const RadioOptions& options) {
  const auto refuse = [](const char* name, const char* allowed, auto found) {
    std::ostringstream text;
    text << "radio: " << name << " must be " << allowed << ", not " << found;
    throw InputError(text.str());
  };
  if (!(options.rate_bps > 0.0) || !std::isfinite(options.rate_bps)) {
    refuse("rate_bps", "positive and finite", options.rate_bps);
  }
  if (options.queue_packets_max < 1) {
    refuse("queue_packets_max", "at least 1", options.queue_packets_max);
  }
  if (options.latency < Duration()) {
    refuse("latency_s", "at least 0", options.latency.seconds());
  }
  if (!(options.loss_probability >= 0.0 && options.loss_probability <= 1.0)) {
    refuse("loss_probability", "in [0, 1]", options.loss_probability);
  }
}

// An absurdly slow radio must not overflow the clock: what takes longer than 9e9 s takes 9e9 s, and
// what would end after the last instant ends never.
Duration air_time(std::uint64_t bytes, double rate_bps) {
  return Duration::seconds(std::min(static_cast<double>(bytes) * 8.0 / rate_bps, 9e9));
}
Time later(Time time, Duration span) {
  return span < Time::never() - time ? time + span : Time::never();
}

}  // namespace

// A packet from its hand-over to the last of its fates.
struct Radio::Transmission {
  std::vector<std::byte> bytes;    // keeps its capacity for the slot's next packet
  std::vector<std::uint8_t> lost;  // a flag a hearer, drawn at hand-over
  RiderPtr rider;
  EventId arrival;
  Time sent, start, end;  // handed over; first and last bit
  std::uint64_t serial = 0;
  std::size_t settled = 0;  // hearers whose fate is known
  AgentId sender = no_agent;
  AgentId receiver = no_agent;  // no_agent: a broadcast
  NameId kind = 0;
  bool reaches = true;  // false: addressed to somebody out of range
  bool under_way = false;
};

struct Radio::Transmitter {
  SenderCounts counts;
  Time free_at;  // end of the last packet's sending

  // Number of packets that wait or are being sent at `now`.
  std::size_t occupancy(Time now) {
    while (size > 0 && ends[head] <= now) {
      head = head + 1 == ends.size() ? 0 : head + 1;
      --size;
    }
    return size;
  }

  void enqueue(Time end) {
    if (size == ends.size()) grow();
    const std::size_t tail = head + size;
    ends[tail < ends.size() ? tail : tail - ends.size()] = end;
    ++size;
    free_at = end;
  }

 private:
  void grow() {
    std::rotate(ends.begin(), ends.begin() + static_cast<std::ptrdiff_t>(head), ends.end());
    head = 0;
    ends.resize(std::max<std::size_t>(4, 2 * ends.size()));
  }

  // Ends of sending, ascending: a ring from `head`. Those that have passed are dropped when
  // somebody looks, so a queue costs no event of its own.
  std::vector<Time> ends;
  std::size_t head = 0;
  std::size_t size = 0;
};

Radio::Radio(Simulation& simulation, Topology topology, const RadioOptions& options)
    : simulation_(simulation), topology_(std::move(topology)), options_(options) {
  check(options_);
  const auto agents = static_cast<std::size_t>(topology_.agents());
  receivers_.resize(agents, nullptr);
  transmitters_.resize(agents);
  link_packets_.resize(topology_.links(), 0);
  for (AgentId a = 0; a < topology_.agents(); ++a) {
    hearers_max_ = std::max(hearers_max_, topology_.neighbours(a).size());
  }
  for (int fate = 0; fate < fate_count; ++fate) {
    fate_names_[static_cast<std::size_t>(fate)] =
        simulation_.record().name(to_string(static_cast<Fate>(fate)));
  }
}

Radio::~Radio() {
  for (const auto& t : slots_) {
    if (t->under_way) simulation_.cancel(t->arrival);
  }
}

std::size_t Radio::index(AgentId agent, const char* role) const {
  if (agent < 0 || agent >= topology_.agents()) {
    throw BrokenInvariant("radio: " + std::string(role) + " " + std::to_string(agent) +
                          " is not there (agents are 0 … " +
                          std::to_string(topology_.agents() - 1) + ")");
  }
  return static_cast<std::size_t>(agent);
}

void Radio::attach(AgentId agent, Receiver& receiver) {
  receivers_[index(agent, "receiver")] = &receiver;
}

const SenderCounts& Radio::counts(AgentId sender) const {
  return transmitters_[index(sender, "sender")].counts;
}

std::uint32_t Radio::take_slot() {
  if (free_slots_.empty()) {
    slots_.push_back(std::make_unique<Transmission>());
    slots_.back()->lost.reserve(hearers_max_);
    free_slots_.reserve(slots_.capacity());  // so that giving back never allocates
    return static_cast<std::uint32_t>(slots_.size() - 1);
  }
  const std::uint32_t slot = free_slots_.back();
  free_slots_.pop_back();
  return slot;
}

// A buffer that must grow has room for the largest packet so far, so that each grows rarely,
// however sizes vary.
void Radio::reserve(std::vector<std::byte>* buffer, std::size_t bytes) {
  packet_bytes_max_ = std::max(packet_bytes_max_, bytes);
  if (buffer->capacity() < bytes) buffer->reserve(std::bit_ceil(packet_bytes_max_));
}

void Radio::release_slot(std::uint32_t slot) {
  Transmission& t = *slots_[slot];
  t.under_way = false;
  free_slots_.push_back(slot);
  t.rider = RiderPtr();
}

// Potential receivers of a packet. Refers to `receiver` unless that is no_agent.
std::span<const AgentId> Radio::hearers(AgentId sender, const AgentId& receiver) const {
  return receiver == no_agent ? topology_.neighbours(sender) : std::span(&receiver, 1);
}

// Uses up the packet's draw on each of its links and, unless `lost` is null, notes what is lost.
void Radio::draw_losses(const Outgoing& packet, AgentId sender, std::vector<std::uint8_t>* lost) {
  const std::span<const AgentId> to = hearers(sender, packet.receiver);
  std::size_t first = topology_.first_link(sender);
  if (packet.receiver != no_agent) {
    const std::int64_t link = topology_.link(sender, packet.receiver);
    if (link < 0) return;
    first = static_cast<std::size_t>(link);
  }
  const bool draws = lost && options_.loss_probability > 0.0;  // draws are keyed: none need be made
  for (std::size_t i = 0; i < to.size(); ++i) {
    const std::uint64_t count = packet.tick ? *packet.tick : link_packets_[first + i]++;
    if (!lost) continue;
    lost->push_back(draws && simulation_
                                 .stream_at(packet.tick ? loss_of_tick : loss_of_packet,
                                            Entity::link(sender, to[i]), count)
                                 .bernoulli(options_.loss_probability));
  }
}

bool Radio::send(AgentId sender, const Outgoing& packet) {
  Transmitter& transmitter = transmitters_[index(sender, "sender")];
  if (packet.receiver != no_agent) index(packet.receiver, "receiver");
  require(!packet.tick || *packet.tick < ticks_max, "radio: a tick must be below 2^48");
  require(packet.bytes.size() <= std::numeric_limits<std::uint32_t>::max(),
          "radio: a packet must be below 4 GiB");

  const Time now = simulation_.now();
  const std::span<const AgentId> to = hearers(sender, packet.receiver);
  SenderCounts& counts = transmitter.counts;
  ++counts.packets;
  counts.expected += to.size();
  if (transmitter.occupancy(now) >= options_.queue_packets_max) {
    draw_losses(packet, sender, nullptr);
    for (const AgentId receiver : to) {
      settle({now, now, sender, receiver, packet.kind,
              static_cast<std::uint32_t>(packet.bytes.size()), 0},
             Fate::queue_full);
    }
    return false;
  }

  const std::uint32_t slot = take_slot();
  Transmission& t = *slots_[slot];
  reserve(&t.bytes, packet.bytes.size());
  t.bytes.assign(packet.bytes.begin(), packet.bytes.end());
  t.lost.clear();
  draw_losses(packet, sender, &t.lost);
  t.rider = packet.rider;
  t.sender = sender;
  t.receiver = packet.receiver;
  t.kind = packet.kind;
  t.reaches = packet.receiver == no_agent || !t.lost.empty();
  t.serial = transmissions_++;
  t.settled = 0;

  const std::uint64_t bytes = packet.bytes.size() + std::uint64_t{options_.header_bytes};
  t.sent = now;
  t.start = std::max(now, transmitter.free_at);
  t.end = later(t.start, air_time(bytes, options_.rate_bps));
  transmitter.enqueue(t.end);
  counts.bytes_sent += bytes;
  counts.air_time += t.end - t.start;
  t.under_way = true;
  t.arrival = EventId();
  const Time arrives = t.reaches ? later(t.end, options_.latency) : t.end;
  if (arrives < Time::never()) {
    t.arrival = simulation_.schedule(arrives, Phase::update, [this, slot] { arrive(slot); });
  }
  return true;
}

void Radio::settle(MessageRow row, Fate fate) {
  const auto f = static_cast<std::size_t>(fate);
  row.fate = fate_names_[f];
  simulation_.record().message(row);
  ++transmitters_[static_cast<std::size_t>(row.sender)].counts.fates[f];
}

// Settles the next of the hearers in order of number.
void Radio::settle_next(Transmission& t, Fate fate) {
  const AgentId receiver = hearers(t.sender, t.receiver)[t.settled++];
  settle({t.sent, simulation_.now(), t.sender, receiver, t.kind,
          static_cast<std::uint32_t>(t.bytes.size()), 0},
         fate);
}

void Radio::arrive(std::uint32_t slot) {
  Transmission& t = *slots_[slot];
  const std::span<const AgentId> to = hearers(t.sender, t.receiver);
  Packet packet{t.sender, no_agent, t.kind, t.bytes, t.sent, t.rider.get()};
  while (t.settled < to.size()) {
    const std::size_t i = t.settled;
    const Fate fate = !t.reaches ? Fate::out_of_range : t.lost[i] ? Fate::lost : Fate::delivered;
    settle_next(t, fate);
    Receiver* const receiver = receivers_[static_cast<std::size_t>(to[i])];
    if (fate != Fate::delivered || !receiver) continue;
    packet.receiver = to[i];
    simulation_.acting_for(to[i]);
    receiver->on_packet(packet);
  }
  release_slot(slot);
}

void Radio::finish() {
  std::vector<std::uint32_t> under_way;
  for (std::uint32_t slot = 0; slot < slots_.size(); ++slot) {
    if (slots_[slot]->under_way) under_way.push_back(slot);
  }
  // By age and not by slot: what is recorded must not depend on how the pool hands out slots.
  std::sort(under_way.begin(), under_way.end(), [this](std::uint32_t a, std::uint32_t b) {
    return slots_[a]->serial < slots_[b]->serial;
  });
  const Time now = simulation_.now();
  for (const std::uint32_t slot : under_way) {
    Transmission& t = *slots_[slot];
    simulation_.cancel(t.arrival);
    SenderCounts& counts = transmitters_[static_cast<std::size_t>(t.sender)].counts;
    if (t.start > now) counts.bytes_sent -= t.bytes.size() + std::uint64_t{options_.header_bytes};
    if (t.end > now) counts.air_time -= t.end - std::max(t.start, now);
    while (t.settled < hearers(t.sender, t.receiver).size()) {
      settle_next(t, Fate::in_flight_at_end);
    }
    release_slot(slot);
  }
  for (AgentId sender = 0; sender < topology_.agents(); ++sender) {
    require_balance(sender, counts(sender));
  }
}

void require_balance(AgentId sender, const SenderCounts& counts) {
  std::uint64_t settled = 0;
  for (const std::uint64_t fates : counts.fates) settled += fates;
  if (settled == counts.expected) return;
  throw BrokenInvariant("radio: agent " + std::to_string(sender) + " sent " +
                        std::to_string(counts.packets) + " packets to " +
                        std::to_string(counts.expected) + " potential receivers, but " +
                        std::to_string(settled) + " fates are known");
}

}  // namespace hearsay
