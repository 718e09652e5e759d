#include "net/radio.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "net/send_queue.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

// Two purposes, so that the n-th packet without a tick does not share the draw of tick n.
constexpr Purpose loss_of_tick("loss of a tick");
constexpr Purpose loss_of_packet("loss of a packet");
constexpr std::uint64_t ticks_max = std::uint64_t{1} << 48;

void check(const RadioOptions& options, const Topology& topology) {
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
  if (!(options.propagation_m_per_s > 0.0)) {
    refuse("propagation_m_per_s", "greater than 0", options.propagation_m_per_s);
  }
  if (std::isfinite(options.propagation_m_per_s) && !topology.has_lengths()) {
    throw InputError("radio: propagation_m_per_s needs a topology with positions");
  }
}

// An absurdly slow radio must not overflow the clock: what takes longer than 9e9 s takes 9e9 s, and
// what would end after the last instant ends never.
Duration at_most_9e9(double s) { return Duration::seconds(std::min(s, 9e9)); }
Time later(Time time, Duration span) {
  return span < Time::never() - time ? time + span : Time::never();
}

}  // namespace

// A neighbour's place in the order of arrival.
struct Radio::Ear {
  Duration delay;
  AgentId agent;
  std::uint32_t place;  // among the neighbours
};

// What belongs to a sender, together in memory.
struct alignas(64) Radio::Sender {
  SendQueue queue;
  SenderCounts counts;
};

// Where a packet goes.
struct Radio::Route {
  AgentId sender = no_agent;
  bool reaches = true;   // false: addressed to somebody out of range
  std::size_t size = 0;  // how many may hear
  std::size_t first_link = 0;
  const AgentId* neighbours = nullptr;  // of whom the links go on from first_link
  const Ear* ears = nullptr;            // the same in order of arrival; null: they hear at once
  Duration delay;                       // of all

  AgentId hearer(std::size_t i) const { return ears ? ears[i].agent : neighbours[i]; }
  std::size_t link(std::size_t i) const { return first_link + (ears ? ears[i].place : i); }
  Duration delay_of(std::size_t i) const { return ears ? ears[i].delay : Duration(); }
};

// A packet from its hand-over to the last of its fates.
struct Radio::Transmission {
  std::vector<std::byte> bytes;    // keeps its capacity for the slot's next packet
  std::vector<std::uint8_t> lost;  // flags of the hearers, drawn at hand-over
  RiderPtr rider;
  EventId arrival;        // the next one, unless it is just happening
  Time sent, start, end;  // handed over; first and last bit
  Time arrives;           // at hearers without a delay of their own
  Route route;
  std::uint64_t serial = 0;
  std::size_t settled = 0;      // hearers whose fate is known
  AgentId receiver = no_agent;  // no_agent: a broadcast
  NameId kind = 0;
  bool under_way = false;

  bool done() const { return settled == route.size; }
  Time next() const { return later(arrives, done() ? Duration() : route.delay_of(settled)); }
  MessageRow row(Time now) const {
    return {sent, now, route.sender, no_agent, kind, static_cast<std::uint32_t>(bytes.size()), 0};
  }
};

Radio::Radio(Simulation& simulation, Topology topology, const RadioOptions& options)
    : simulation_(simulation), topology_(std::move(topology)), options_(options) {
  check(options_, topology_);
  const auto agents = static_cast<std::size_t>(topology_.agents());
  receivers_.resize(agents, nullptr);
  senders_.resize(agents);
  link_packets_.resize(topology_.links(), 0);
  for (AgentId a = 0; a < topology_.agents(); ++a) {
    hearers_max_ = std::max(hearers_max_, topology_.neighbours(a).size());
  }
  for (int fate = 0; fate < fate_count; ++fate) {
    fate_names_[static_cast<std::size_t>(fate)] =
        simulation_.record().name(to_string(static_cast<Fate>(fate)));
  }
  if (std::isfinite(options_.propagation_m_per_s)) order_arrivals();
}

void Radio::order_arrivals() {
  ears_.reserve(topology_.links());
  for (AgentId sender = 0; sender < topology_.agents(); ++sender) {
    const std::span<const AgentId> neighbours = topology_.neighbours(sender);
    const std::size_t first = topology_.first_link(sender);
    for (std::uint32_t place = 0; place < neighbours.size(); ++place) {
      ears_.push_back({delay(first + place), neighbours[place], place});
    }
    std::sort(ears_.begin() + static_cast<std::ptrdiff_t>(first), ears_.end(),
              [](const Ear& a, const Ear& b) {
                return a.delay != b.delay ? a.delay < b.delay : a.agent < b.agent;
              });
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
  return senders_[index(sender, "sender")].counts;
}

std::uint32_t Radio::take_slot() {
  if (free_slots_.empty()) {
    slots_.push_back(std::make_unique<Transmission>());
    slots_.back()->lost.resize(hearers_max_, 0);
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

Duration Radio::delay(std::size_t link) const {
  return at_most_9e9(topology_.length_m(link) / options_.propagation_m_per_s);
}

// Refers to `receiver` unless that is no_agent.
Radio::Route Radio::route(AgentId sender, const AgentId& receiver) const {
  Route route{.sender = sender, .first_link = topology_.first_link(sender)};
  if (receiver == no_agent) {
    const std::span<const AgentId> neighbours = topology_.neighbours(sender);
    route.size = neighbours.size();
    route.neighbours = neighbours.data();
    if (!ears_.empty()) route.ears = ears_.data() + route.first_link;
    return route;
  }
  route.size = 1;
  route.neighbours = &receiver;
  const std::int64_t link = topology_.link(sender, receiver);
  route.reaches = link >= 0;
  if (!route.reaches) return route;
  route.first_link = static_cast<std::size_t>(link);
  route.delay = delay(route.first_link);
  return route;
}

// Of many packets in a row it is the same.
Duration Radio::air_time(std::uint64_t bytes) {
  if (bytes != air_bytes_) {
    air_bytes_ = bytes;
    air_time_ = at_most_9e9(static_cast<double>(bytes) * 8.0 / options_.rate_bps);
  }
  return air_time_;
}

// Uses up the packet's draw on each of its links and, unless `lost` is null, notes what is lost.
void Radio::draw_losses(const Outgoing& packet, const Route& route, std::uint8_t* lost) {
  if (!route.reaches) return;
  const double p = options_.loss_probability;
  const bool draws = lost && p > 0.0;  // they are keyed: none need be made
  const std::uint64_t seed = simulation_.seed();
  const Purpose purpose = packet.tick ? loss_of_tick : loss_of_packet;
  for (std::size_t i = 0; i < route.size; ++i) {
    const std::uint64_t count = packet.tick ? *packet.tick : link_packets_[route.link(i)]++;
    // Who will soon be called: in a large crowd each is far from the one before.
    __builtin_prefetch(receivers_[static_cast<std::size_t>(route.hearer(i))]);
    if (!draws) continue;
    const Entity link = Entity::link(route.sender, route.hearer(i));
    lost[i] = Stream::uniform_at(seed, purpose, link, count) < p;
  }
}

bool Radio::send(AgentId sender, const Outgoing& packet) {
  Sender& from = senders_[index(sender, "sender")];
  if (packet.receiver != no_agent) index(packet.receiver, "receiver");
  require(!packet.tick || *packet.tick < ticks_max, "radio: a tick must be below 2^48");
  require(packet.bytes.size() <= std::numeric_limits<std::uint32_t>::max(),
          "radio: a packet must be below 4 GiB");

  const Time now = simulation_.now();
  SenderCounts& counts = from.counts;
  ++counts.packets;
  if (from.queue.occupancy(now) >= options_.queue_packets_max) {
    drop(sender, packet);
    return false;
  }
  const std::uint32_t slot = take_slot();
  Transmission& t = *slots_[slot];
  t.receiver = packet.receiver;
  t.route = route(sender, t.receiver);
  counts.expected += t.route.size;
  reserve(&t.bytes, packet.bytes.size());
  t.bytes.assign(packet.bytes.begin(), packet.bytes.end());
  draw_losses(packet, t.route, t.lost.data());
  t.rider = packet.rider;
  t.kind = packet.kind;
  t.serial = transmissions_++;
  t.settled = 0;

  const std::uint64_t bytes = packet.bytes.size() + std::uint64_t{options_.header_bytes};
  t.sent = now;
  t.start = std::max(now, from.queue.free_at());
  t.end = later(t.start, air_time(bytes));
  from.queue.push(now, t.end);
  counts.bytes_sent += bytes;
  counts.air_time += t.end - t.start;
  t.arrives = t.route.reaches ? later(later(t.end, options_.latency), t.route.delay) : t.end;
  t.under_way = true;
  schedule(slot);
  return true;
}

void Radio::drop(AgentId sender, const Outgoing& packet) {
  const Route to = route(sender, packet.receiver);
  senders_[static_cast<std::size_t>(sender)].counts.expected += to.size;
  draw_losses(packet, to, nullptr);
  const Time now = simulation_.now();
  MessageRow row{
      now, now, sender, no_agent, packet.kind, static_cast<std::uint32_t>(packet.bytes.size()), 0};
  for (std::size_t i = 0; i < to.size; ++i) settle(&row, to.hearer(i), Fate::queue_full);
}

// The next arrival, unless it is later than any event can be.
void Radio::schedule(std::uint32_t slot) {
  Transmission& t = *slots_[slot];
  t.arrival = EventId();
  const Time next = t.next();
  if (next == Time::never()) return;
  t.arrival = simulation_.schedule(next, Phase::update, [this, slot] { arrive(slot); });
}

void Radio::settle(MessageRow* row, AgentId receiver, Fate fate) {
  const auto f = static_cast<std::size_t>(fate);
  row->receiver = receiver;
  row->fate = fate_names_[f];
  simulation_.record().message(*row);
  ++senders_[static_cast<std::size_t>(row->sender)].counts.fates[f];
}

// Goes from hearer to hearer, as far as nothing else comes between.
void Radio::arrive(std::uint32_t slot) {
  Transmission& t = *slots_[slot];
  const Route& route = t.route;
  MessageRow row = t.row(simulation_.now());
  Packet packet{route.sender, no_agent, t.kind, t.bytes, t.sent, t.rider.get()};
  while (!t.done()) {
    const Time time = t.next();
    if (time > row.arrived) {
      if (!simulation_.go_on(time, Phase::update)) return schedule(slot);
      row.arrived = time;
    }
    const std::size_t i = t.settled++;
    const AgentId hearer = route.hearer(i);
    const Fate fate = !route.reaches ? Fate::out_of_range
                      : t.lost[i]    ? Fate::lost
                                     : Fate::delivered;
    settle(&row, hearer, fate);
    Receiver* const receiver = receivers_[static_cast<std::size_t>(hearer)];
    if (fate != Fate::delivered || !receiver) continue;
    packet.receiver = hearer;
    simulation_.acting_for(hearer);
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
    SenderCounts& counts = senders_[static_cast<std::size_t>(t.route.sender)].counts;
    if (t.start > now) counts.bytes_sent -= t.bytes.size() + std::uint64_t{options_.header_bytes};
    if (t.end > now) counts.air_time -= t.end - std::max(t.start, now);
    MessageRow row = t.row(now);
    while (!t.done()) settle(&row, t.route.hearer(t.settled++), Fate::in_flight_at_end);
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
