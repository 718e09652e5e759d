#include "net/channel.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

constexpr PurposeOnLink jitter_draws{Purpose("jitter of a tick"), Purpose("jitter of a packet"),
                                     Purpose("jitter of a repetition")};

// What takes longer than 9e9 s takes 9e9 s.
Duration at_most_9e9(double s) { return Duration::seconds(std::min(s, 9e9)); }

bool arrives_before(const Ear& a, const Ear& b) {
  return a.delay != b.delay ? a.delay < b.delay : a.agent < b.agent;
}

// Without a branch: none foresees what is drawn.
Fate fate_if(bool lost) {
  static_assert(Fate{0} == Fate::delivered && Fate{1} == Fate::lost);
  return static_cast<Fate>(lost);
}

template <class T>
T& at_link(std::vector<T>& values, std::uint32_t link) {
  if (values.size() <= link) values.resize(std::bit_ceil(std::size_t{link} + 1));
  return values[link];
}

}  // namespace

Channel::Channel(Simulation& simulation, Reach reach, const RadioOptions& options)
    : simulation_(simulation),
      topology_(std::move(reach.topology)),
      changes_(std::move(reach.changes)),
      positions_m_(std::move(reach.positions_m)),
      places_(reach.places),
      by_place_(reach.by_place),
      states_(topology_, changes_),
      propagation_(options.propagation),
      loss_(options.loss),
      jammers_(options.jammers),
      latency_(options.latency),
      jitter_(options.jitter),
      propagation_m_per_s_(options.propagation_m_per_s),
      mtu_bytes_(options.mtu_bytes.value_or(std::numeric_limits<std::uint32_t>::max())),
      header_bytes_(options.header_bytes),
      answer_bytes_(options.acknowledgement.bytes),
      quiet_(changes_.empty() && jammers_.none()),
      powers_(std::isfinite(options.capture_db)),
      numbers_links_(options.count_links ||
                     (jitter_.law != JitterOptions::Law::none && !jitter_.reordering)),
      certain_(propagation_.certain()),
      noisy_(!jammers_.none() && propagation_.has_powers()) {
  require(topology_.links() < UINT32_MAX, "radio: more than 2^32 links");
  require(!by_place_ || (places_ != nullptr && topology_.links() == 0),
          "radio: hearing by place needs places, and a topology without links");
  const bool placed = by_place_ || topology_.has_lengths();
  if (std::isfinite(propagation_m_per_s_) && !placed) {
    throw InputError("radio: propagation_m_per_s needs a topology with positions");
  }
  if ((!certain_ || powers_) && !placed) {
    throw InputError("radio: propagation models and capture need a topology with positions");
  }
  if (!jammers_.none() && !places_ && positions_m_.empty()) {
    throw InputError("radio: jammers need agents with positions");
  }
  for (AgentId a = 0; a < topology_.agents(); ++a) {
    hearers_max_ = std::max(hearers_max_, topology_.neighbours(a).size());
  }
  link_packets_.resize(topology_.links(), 0);
  if (std::isfinite(propagation_m_per_s_) && !by_place_) order_arrivals();
  if (!certain_ && !by_place_) {
    for (AgentId a = 0; a < topology_.agents(); ++a) {
      for (const AgentId b : topology_.neighbours(a)) link_quality_.push_back(quality(a, b, 0.0));
    }
    frame_success_.reserve(link_quality_.size());
    for (const LinkQuality& link : link_quality_) {
      frame_success_.push_back({frame_success(link, 0), 0});
    }
  }
  if (jitter_.law != JitterOptions::Law::none && !jitter_.reordering) {
    link_arrival_.resize(topology_.links());
  }
  schedule_change();
}

void Channel::schedule_change() {
  change_ = EventId();
  const Time next = states_.next_change();
  if (next == Time::never()) return;
  change_ = simulation_.schedule(next, Phase::world, [this] {
    states_.advance(simulation_.now());
    schedule_change();
  });
}

Duration Channel::way(double distance_m) const {
  return at_most_9e9(distance_m / propagation_m_per_s_);
}

void Channel::order_arrivals() {
  ears_.reserve(topology_.links());
  for (AgentId sender = 0; sender < topology_.agents(); ++sender) {
    const std::size_t first = topology_.first_link(sender);
    auto link = static_cast<std::uint32_t>(first);
    for (const AgentId neighbour : topology_.neighbours(sender)) {
      ears_.push_back({way(topology_.length_m(link)), neighbour, link});
      ++link;
    }
    std::sort(ears_.begin() + static_cast<std::ptrdiff_t>(first), ears_.end(), arrives_before);
  }
}

Point Channel::position(AgentId agent) const {
  if (places_) return places_->at(agent, simulation_.now());
  require(!positions_m_.empty(), "radio: nobody knows where agents stand");
  return positions_m_[static_cast<std::size_t>(agent)];
}

std::span<const AgentId> Channel::neighbours(AgentId agent) {
  if (!by_place_ && changes_.empty()) return topology_.neighbours(agent);
  neighbours_.clear();
  if (by_place_) {
    for (const Nearby& near : places_->near(agent, simulation_.now())) {
      neighbours_.push_back(near.agent);
    }
    return neighbours_;
  }
  std::size_t link = topology_.first_link(agent);
  for (const AgentId neighbour : topology_.neighbours(agent)) {
    if (states_.up(link++)) neighbours_.push_back(neighbour);
  }
  return neighbours_;
}

std::uint32_t Channel::number(AgentId from, AgentId to) {
  return numbers_.try_emplace(Entity::link(from, to).key, numbers_.size()).first->second;
}

void Channel::route(Transmission& t) {
  t.route = Route{};
  t.way = Duration();
  t.aimed = true;
  if (by_place_) return route_moving(t);
  const std::size_t first = topology_.first_link(t.sender);
  if (t.receiver == no_agent) {
    const std::span<const AgentId> neighbours = topology_.neighbours(t.sender);
    t.route.size = neighbours.size();
    t.route.neighbours = neighbours.data();
    t.route.first_link = static_cast<std::uint32_t>(first);
    if (!ears_.empty()) t.route.ears = ears_.data() + first;
    return;
  }
  t.route.size = 1;
  t.route.neighbours = &t.receiver;
  const std::int64_t link = topology_.link(t.sender, t.receiver);
  t.route.reaches = link >= 0;
  t.route.first_link = no_link;
  if (!t.route.reaches) return;
  t.route.first_link = static_cast<std::uint32_t>(link);
  if (ears_.empty()) return;
  t.way = way(topology_.length_m(t.route.first_link));
  t.ears.assign(1, {t.way, t.receiver, t.route.first_link});
  t.route.ears = t.ears.data();
}

void Channel::route_moving(Transmission& t) {
  const bool numbered = numbers_links_ || !t.has_tick;
  const bool takes_time = std::isfinite(propagation_m_per_s_);
  t.ears.clear();
  const auto hears = [&](AgentId agent, double squared_m2) {
    const Duration delay = takes_time ? way(std::sqrt(squared_m2)) : Duration();
    t.ears.push_back({delay, agent, numbered ? number(t.sender, agent) : 0});
  };
  if (t.receiver == no_agent) {
    for (const Nearby& near : places_->near(t.sender, simulation_.now())) {
      hears(near.agent, near.squared_distance_m2);
    }
    if (takes_time) std::sort(t.ears.begin(), t.ears.end(), arrives_before);
  } else {
    const double distance = distance_m(t.sender, t.receiver);
    t.route.reaches = distance <= propagation_.reach_m();
    hears(t.receiver, distance * distance);
    t.way = t.ears[0].delay;
  }
  t.route.size = t.ears.size();
  t.route.ears = t.ears.data();
}

double Channel::distance_m(AgentId from, AgentId to) const {
  if (!by_place_) {
    const std::int64_t link = topology_.link(from, to);
    if (link >= 0) return topology_.length_m(static_cast<std::size_t>(link));
  }
  return std::sqrt(squared_distance_m2(position(from), position(to)));
}

PacketOnLink Channel::on_link(const Transmission& t, AgentId to, std::uint64_t index) const {
  return {.seed = simulation_.seed(),
          .from = t.sender,
          .to = to,
          .numbering = t.has_tick ? Numbering::tick : Numbering::packet,
          .index = index};
}

LinkQuality Channel::quality(AgentId from, AgentId to, double interference_mw) const {
  return propagation_.quality(distance_m(from, to),
                              propagation_.shadowing_db(simulation_.seed(), from, to),
                              interference_mw);
}

double Channel::power_dbm(AgentId from, AgentId to) const {
  if (!powers_) return 0.0;
  return propagation_.received_dbm(distance_m(from, to),
                                   propagation_.shadowing_db(simulation_.seed(), from, to));
}

FrameSizes Channel::frame_sizes(const Transmission& t) const {
  const auto bytes = static_cast<std::uint32_t>(t.bytes.size());
  const std::uint32_t before_last = (t.frames - 1) * mtu_bytes_;
  return {.frames = t.frames,
          .frame_bytes = mtu_bytes_ + header_bytes_,
          .last_bytes = bytes - before_last + header_bytes_};
}

// Whether the distance lets all frames through, with nobody who jams.
bool Channel::heard(PacketOnLink packet, const Transmission& t, std::uint32_t link) {
  const FrameSizes sizes = frame_sizes(t);
  if (link_quality_.empty()) {
    return packet_heard(quality(packet.from, packet.to, 0.0), packet, sizes);
  }
  if (sizes.frames > 1) return packet_heard(link_quality_[link], packet, sizes);
  FrameSuccess& known = frame_success_[link];
  if (known.bytes != sizes.last_bytes) {
    known = {frame_success(link_quality_[link], sizes.last_bytes), sizes.last_bytes};
  }
  return first_frame_heard(known.success, packet);
}

void Channel::aim(Transmission& t, bool draws) {
  route(t);
  if (t.fates.size() < t.route.size || t.fates.empty()) {
    t.fates.resize(std::max(hearers_max_, std::bit_ceil(t.route.size)));
  }
  if (!t.route.reaches) {
    t.fates[0] = Fate::out_of_range;
    return;
  }
  const bool numbered = noisy_ || (jitter_.law != JitterOptions::Law::none && !t.has_tick);
  t.numbers.clear();
  if (numbered) t.numbers.reserve(t.fates.size());
  const bool lossy = draws && !loss_.never();
  const bool fading = draws && !certain_;
  const Route route = t.route;  // a copy, and no address of `packet`: they stay in registers
  const bool has_tick = t.has_tick;
  const std::uint32_t frames = t.frames;
  Fate* const fates = t.fates.data();
  PacketOnLink packet = on_link(t, no_agent, t.index);
  for (std::size_t i = 0; i < route.size; ++i) {
    const Ear ear = route.ear(i);
    packet.to = ear.agent;
    if (!has_tick) packet.index = at_link(link_packets_, ear.link)++;
    if (numbered) t.numbers.push_back(packet.index);
    fates[i] = Fate::delivered;
    if (lossy) fates[i] = fate_if(loss_.lost(packet, frames));
    if (fading && fates[i] == Fate::delivered && !heard(packet, t, ear.link)) fates[i] = Fate::lost;
  }
  if (t.receiver != no_agent) t.index = packet.index;
}

Fate Channel::repeat(Transmission& t) {
  if (by_place_) route(t);
  if (!t.route.reaches) return Fate::out_of_range;
  PacketOnLink packet = on_link(t, t.receiver, t.index);
  packet.repetition = static_cast<std::uint32_t>(t.repetition);
  const bool gone =
      loss_.lost(packet, t.frames) || (!certain_ && !heard(packet, t, t.route.ear(0).link));
  return gone ? Fate::lost : Fate::delivered;
}

bool Channel::acknowledgement_lost(const Transmission& t) const {
  PacketOnLink answer = on_link(t, t.receiver, t.index);
  std::swap(answer.from, answer.to);
  answer.repetition = static_cast<std::uint32_t>(t.repetition);
  answer.answer = true;
  if (loss_.lost(answer)) return true;
  if (certain_) return false;
  const FrameSizes sizes{.frames = 1, .frame_bytes = 0, .last_bytes = answer_bytes_};
  return !packet_heard(quality(answer.from, answer.to, 0.0), answer, sizes);
}

Fate Channel::fate_on_arrival(const Transmission& t, std::size_t i) const {
  if (!t.route.reaches) return Fate::delivered;
  if (!changes_.empty() && !states_.up_since(t.route.ear(i).link, t.start)) {
    return Fate::out_of_range;
  }
  if (jammers_.none()) return Fate::delivered;
  const AgentId hearer = t.route.hearer(i);
  const Point place_m = position(hearer);
  if (jammers_.jams(place_m, t.start, t.end)) return Fate::jammed;
  if (!propagation_.has_powers()) return Fate::delivered;
  const double noise_mw = jammers_.interference_mw(place_m, t.start, t.end, propagation_);
  if (noise_mw <= 0.0) return Fate::delivered;
  PacketOnLink packet = on_link(t, hearer, t.numbers[i]);
  packet.repetition = static_cast<std::uint32_t>(t.repetition);
  const LinkQuality jammed = quality(t.sender, hearer, noise_mw);
  return packet_heard(jammed, packet, frame_sizes(t)) ? Fate::delivered : Fate::jammed;
}

void Channel::launch(Transmission& t) {
  t.arrives = t.route.reaches ? later(t.end, latency_) : t.end;
  if (jitter_.law != JitterOptions::Law::none && t.route.reaches) draw_jitter(t);
}

// A repetition has a jitter of its own, not on top of the last one's.
void Channel::draw_jitter(Transmission& t) {
  sorting_.clear();
  for (std::size_t i = 0; i < t.route.size; ++i) {
    const Ear ear = t.route.ear(i);
    PacketOnLink packet = on_link(t, ear.agent, t.has_tick ? t.index : t.numbers[i]);
    packet.repetition = static_cast<std::uint32_t>(t.repetition);
    FrameDraws draws(packet, jitter_draws);
    const double spread_s = jitter_.spread.seconds();
    const double jitter_s = jitter_.law == JitterOptions::Law::uniform
                                ? spread_s * draws.next()
                                : -spread_s * math::log(1.0 - draws.next());
    const Duration pure = t.receiver == no_agent ? ear.delay : t.way;
    Duration delay = later(Time::at(pure), at_most_9e9(jitter_s)).since_start();
    if (!jitter_.reordering) {
      // Not at the same instant: there, who is first depends on what else the packets have to do.
      Time& earliest = at_link(link_arrival_, ear.link);
      const Time arrival = std::max(earliest, later(t.arrives, delay));
      delay = arrival - t.arrives;
      earliest = later(arrival, 1_ns);
    }
    sorting_.push_back(
        {{delay, ear.agent, ear.link}, t.fates[i], t.numbers.empty() ? 0 : t.numbers[i]});
  }
  std::sort(sorting_.begin(), sorting_.end(),
            [](const Sorted& a, const Sorted& b) { return arrives_before(a.ear, b.ear); });
  t.ears.clear();
  t.ears.reserve(t.fates.size());
  for (std::size_t i = 0; i < sorting_.size(); ++i) {
    t.ears.push_back(sorting_[i].ear);
    t.fates[i] = sorting_[i].fate;
    if (!t.numbers.empty()) t.numbers[i] = sorting_[i].number;
  }
  t.route.ears = t.ears.data();
}

}  // namespace hearsay
