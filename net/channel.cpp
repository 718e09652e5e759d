#include "net/channel.hpp"

#include <algorithm>
#include <cmath>
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

}  // namespace

Channel::Channel(Simulation& simulation, Topology topology, const RadioOptions& options)
    : simulation_(simulation),
      topology_(std::move(topology)),
      loss_(options.loss),
      latency_(options.latency),
      jitter_(options.jitter),
      propagation_m_per_s_(options.propagation_m_per_s) {
  require(topology_.links() < UINT32_MAX, "radio: more than 2^32 links");
  if (std::isfinite(propagation_m_per_s_) && !topology_.has_lengths()) {
    throw InputError("radio: propagation_m_per_s needs a topology with positions");
  }
  for (AgentId a = 0; a < topology_.agents(); ++a) {
    hearers_max_ = std::max(hearers_max_, topology_.neighbours(a).size());
  }
  link_packets_.resize(topology_.links(), 0);
  if (jitter_.law != JitterOptions::Law::none && !jitter_.reordering) {
    link_arrival_.resize(topology_.links(), Time() - 1_ns);
  }
  if (std::isfinite(propagation_m_per_s_)) order_arrivals();
}

Duration Channel::way(std::size_t link) const {
  return at_most_9e9(topology_.length_m(link) / propagation_m_per_s_);
}

void Channel::order_arrivals() {
  ears_.reserve(topology_.links());
  for (AgentId sender = 0; sender < topology_.agents(); ++sender) {
    const std::size_t first = topology_.first_link(sender);
    std::uint32_t link = static_cast<std::uint32_t>(first);
    for (const AgentId neighbour : topology_.neighbours(sender)) {
      ears_.push_back({way(link), neighbour, link});
      ++link;
    }
    std::sort(ears_.begin() + static_cast<std::ptrdiff_t>(first), ears_.end(), arrives_before);
  }
}

std::span<const AgentId> Channel::neighbours(AgentId agent) { return topology_.neighbours(agent); }

void Channel::route(Transmission& t) {
  t.route = Route{};
  t.way = Duration();
  t.aimed = true;
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
  if (!t.route.reaches) return;
  t.route.first_link = static_cast<std::uint32_t>(link);
  if (ears_.empty()) return;
  t.way = way(t.route.first_link);
  t.ears.assign(1, {t.way, t.receiver, t.route.first_link});
  t.route.ears = t.ears.data();
}

PacketOnLink Channel::on_link(const Transmission& t, std::size_t i, std::uint64_t index) const {
  return {.seed = simulation_.seed(),
          .from = t.sender,
          .to = t.route.hearer(i),
          .numbering = t.has_tick ? Numbering::tick : Numbering::packet,
          .index = index};
}

void Channel::aim(Transmission& t, bool draws) {
  route(t);
  if (t.fates.size() < t.route.size) t.fates.resize(hearers_max_);
  if (!t.route.reaches) {
    t.fates[0] = Fate::out_of_range;
    return;
  }
  draws = draws && !loss_.never();
  const bool numbered = jitter_.law != JitterOptions::Law::none && !t.has_tick;
  t.numbers.clear();
  if (numbered) t.numbers.reserve(hearers_max_);
  for (std::size_t i = 0; i < t.route.size; ++i) {
    const std::uint64_t index = t.has_tick ? t.index : link_packets_[t.route.link(i)]++;
    if (t.receiver != no_agent) t.index = index;
    if (numbered) t.numbers.push_back(index);
    const bool lost = draws && loss_.lost(on_link(t, i, index), t.frames);
    t.fates[i] = lost ? Fate::lost : Fate::delivered;
  }
}

Fate Channel::repeat(const Transmission& t) const {
  if (!t.route.reaches) return Fate::out_of_range;
  PacketOnLink packet = on_link(t, 0, t.index);
  packet.repetition = static_cast<std::uint32_t>(t.repetition);
  return loss_.lost(packet, t.frames) ? Fate::lost : Fate::delivered;
}

bool Channel::acknowledgement_lost(const Transmission& t) const {
  PacketOnLink answer = on_link(t, 0, t.index);
  std::swap(answer.from, answer.to);
  answer.repetition = static_cast<std::uint32_t>(t.repetition);
  answer.answer = true;
  return loss_.lost(answer);
}

void Channel::launch(Transmission& t) {
  t.arrives = t.route.reaches ? later(t.end, latency_) : t.end;
  if (jitter_.law != JitterOptions::Law::none && t.route.reaches) draw_jitter(t);
}

// A repetition has a jitter of its own, not on top of the last one's.
void Channel::draw_jitter(Transmission& t) {
  sorting_.clear();
  for (std::size_t i = 0; i < t.route.size; ++i) {
    const std::uint32_t link = t.route.link(i);
    PacketOnLink packet = on_link(t, i, t.has_tick ? t.index : t.numbers[i]);
    packet.repetition = static_cast<std::uint32_t>(t.repetition);
    FrameDraws draws(packet, jitter_draws);
    const double spread_s = jitter_.spread.seconds();
    const double jitter_s = jitter_.law == JitterOptions::Law::uniform
                                ? spread_s * draws.next()
                                : -spread_s * math::log(1.0 - draws.next());
    const Duration pure = t.receiver == no_agent ? t.route.delay(i) : t.way;
    Duration delay = later(Time::at(pure), at_most_9e9(jitter_s)).since_start();
    if (!jitter_.reordering) {
      // Not at the same instant: there, who is first depends on what else the packets have to do.
      Time& last = link_arrival_[link];
      last = std::max(later(last, 1_ns), later(t.arrives, delay));
      delay = last - t.arrives;
    }
    sorting_.emplace_back(Ear{delay, t.route.hearer(i), link}, t.fates[i]);
  }
  std::sort(sorting_.begin(), sorting_.end(),
            [](const auto& a, const auto& b) { return arrives_before(a.first, b.first); });
  t.ears.clear();
  t.ears.reserve(hearers_max_);
  for (std::size_t i = 0; i < sorting_.size(); ++i) {
    t.ears.push_back(sorting_[i].first);
    t.fates[i] = sorting_[i].second;
  }
  t.route.ears = t.ears.data();
}

}  // namespace hearsay
