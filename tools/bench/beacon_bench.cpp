// Beacons: n radios, about ten in range of each, broadcast 200 bytes every second at a phase of
// their own over 1 Mbit/s with 10 % loss and the delay of light, for 60 s. An item is a packet at
// one hearer, lost or not.
//
// The floor does the same with plain arrays: neighbours and their delays in compressed rows, one
// entry of a std::priority_queue a beacon and a delivery, the same keyed draws; it records nothing.
// Ours is Radio, every fate counted and fed to the digest. What it, the simulation and the topology
// hold of the heap half-way through is given an agent, and must not be more than 1 kB.
//
// Three more do the same with one thing added, beside the plain floor: `moving` (Gauss–Markov about
// 10 m/s, neighbours looked up in a grid when a beacon is sent; with 100,000 radios for 10 s, too),
// `fading` (log-distance with shadowing, every reception drawn from its SNR) and `sensing` (carrier
// sense with back-off, frames that overlap collide). Their fates are their own; all that they hold
// must not be more than 2 GiB.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include "net/movement.hpp"
#include "net/radio.hpp"
#include "sim/kernel/random.hpp"
#include "sim/kernel/simulation.hpp"
#include "sim/record/digest.hpp"
#include "sim/world/motion.hpp"
#include "tools/memory/memory.hpp"

namespace hearsay {
namespace {

constexpr std::uint64_t seed = 1;
constexpr double range_m = 100.0;
constexpr double neighbours_mean = 10.0;
constexpr double light_m_per_s = 299'792'458.0;
constexpr double rate_bps = 1e6;
constexpr double loss_probability = 0.1;
constexpr std::size_t beacon_bytes = 200;
constexpr Duration period = 1_s;
Time end_of(int agents) { return Time::at(agents > 10'000 ? 10_s : 60_s); }
constexpr double bytes_per_agent_max = 1024.0;
constexpr double bytes_max = 2147483648.0;  // of all, with anything added

struct Layout {
  double side_m;
  std::vector<Point> positions_m;
  Topology topology;
  std::vector<Duration> phase;
  std::vector<std::int64_t> delay_ns;  // a link
};

Layout make_layout(int agents) {
  // At this density a disk of the range holds the mean number of neighbours (fewer at the rim).
  const double side_m = range_m * std::sqrt(3.141592653589793 * agents / neighbours_mean);
  std::vector<std::array<double, 3>> positions_m;
  std::vector<Duration> phase;
  for (AgentId a = 0; a < agents; ++a) {
    Stream place(seed, Purpose("place"), Entity::agent(a));
    const double x_m = place.uniform(0.0, side_m);
    const double y_m = place.uniform(0.0, side_m);
    positions_m.push_back({x_m, y_m, 0.0});
    const auto period_ns = static_cast<std::uint64_t>(period.nanoseconds());
    phase.push_back(Duration::nanoseconds(static_cast<std::int64_t>(place.below(period_ns))));
  }
  Layout layout{side_m, positions_m, Topology::disk(positions_m, range_m), std::move(phase), {}};
  for (std::size_t link = 0; link < layout.topology.links(); ++link) {
    const double delay_s = layout.topology.length_m(link) / light_m_per_s;
    layout.delay_ns.push_back(Duration::seconds(delay_s).nanoseconds());
  }
  return layout;
}

struct Tally {
  std::uint64_t heard = 0;
  std::uint64_t lost = 0;
  std::uint64_t in_flight = 0;
  bool operator==(const Tally&) const = default;
};
struct Outcome {
  Tally tally;
  double bytes_per_agent = 0.0;
};

Outcome run_floor(const Layout& layout) {
  struct Entry {
    std::int64_t time_ns;
    std::uint64_t sequence;
    std::uint64_t tick;
    AgentId sender;
    AgentId receiver;                           // no_agent: the sender's next beacon
    bool operator<(const Entry& other) const {  // the queue's top is its largest
      return time_ns != other.time_ns ? time_ns > other.time_ns : sequence > other.sequence;
    }
  };
  const int agents = layout.topology.agents();
  const std::int64_t air_ns = std::llround(1e9 * 8.0 * beacon_bytes / rate_bps);
  std::vector<std::int64_t> free_at_ns(static_cast<std::size_t>(agents), 0);
  std::priority_queue<Entry> queue;
  std::uint64_t sequence = 0;
  Tally tally;
  for (AgentId a = 0; a < agents; ++a) {
    queue.push(
        {layout.phase[static_cast<std::size_t>(a)].nanoseconds(), sequence++, 0, a, no_agent});
  }
  const Time end = end_of(agents);
  while (!queue.empty() && queue.top().time_ns <= end.nanoseconds()) {
    const Entry entry = queue.top();
    queue.pop();
    if (entry.receiver == no_agent) {
      std::int64_t& free_ns = free_at_ns[static_cast<std::size_t>(entry.sender)];
      free_ns = std::max(free_ns, entry.time_ns) + air_ns;
      std::size_t link = layout.topology.first_link(entry.sender);
      for (const AgentId hearer : layout.topology.neighbours(entry.sender)) {
        const std::int64_t time_ns = free_ns + layout.delay_ns[link++];
        queue.push({time_ns, sequence++, entry.tick, entry.sender, hearer});
      }
      queue.push({entry.time_ns + period.nanoseconds(), sequence++, entry.tick + 1, entry.sender,
                  no_agent});
    } else if (Stream::uniform_at(seed, Purpose("loss of a tick"),
                                  Entity::link(entry.sender, entry.receiver),
                                  entry.tick) < loss_probability) {
      ++tally.lost;
    } else {
      ++tally.heard;
    }
  }
  for (; !queue.empty(); queue.pop()) tally.in_flight += queue.top().receiver != no_agent;
  return {tally};
}

class Beacon final : public Receiver {
 public:
  Beacon(Simulation& simulation, Radio& radio, AgentId me)
      : simulation_(simulation), radio_(radio), me_(me) {
    radio.attach(me, *this);
  }
  void talk() {
    static constexpr std::array<std::byte, beacon_bytes> payload{};
    radio_.send(me_, {.kind = 0, .bytes = payload, .tick = tick_++});
    simulation_.schedule(simulation_.now() + period, Phase::act, [this] { talk(); });
  }
  void on_packet(const Packet&) override { ++heard; }
  std::uint64_t heard = 0;

 private:
  Simulation& simulation_;
  Radio& radio_;
  AgentId me_;
  std::uint64_t tick_ = 0;
};

enum class Extra { none, moving, fading, sensing };

RadioOptions options_with(Extra extra) {
  RadioOptions options{.rate_bps = rate_bps,
                       .loss = Loss::bernoulli(loss_probability),
                       .propagation_m_per_s = light_m_per_s};
  if (extra == Extra::moving) options.propagation = Propagation::disk(range_m);
  if (extra == Extra::fading) {
    // Who is a potential receiver stays the same; the median link is heard up to about 70 m.
    options.propagation = Propagation::log_distance(
        {.shadowing_sigma_db = 4.0, .transmit_dbm = 5.0, .noise_dbm = -108.0, .range_m = range_m});
  }
  if (extra == Extra::sensing) {
    options.half_duplex = true;
    options.access = {.sharing = Sharing::carrier_sense,
                      .slot = 20_us,
                      .interframe = 50_us,
                      .window_min = 32,
                      .window_max = 1024};
  }
  return options;
}

// Paths of all agents about the square in which they stand.
class Wanderers final : public PathSource {
 public:
  explicit Wanderers(const Layout& layout) {
    for (AgentId a = 0; a < layout.topology.agents(); ++a) {
      motions_.push_back(
          motion::make(motion::GaussMarkov{.area = {{0.0, 0.0}, {layout.side_m, layout.side_m}},
                                           .speed_mean_m_per_s = 10.0,
                                           .speed_sigma_m_per_s = 2.0,
                                           .direction_sigma_rad = 0.5,
                                           .alpha = 0.8},
                       seed, a));
    }
  }
  Leg next(AgentId agent, Time) override {
    return motions_[static_cast<std::size_t>(agent)]->next();
  }

 private:
  std::vector<std::unique_ptr<Motion>> motions_;
};

template <Extra extra>
Outcome run_ours(const Layout& layout) {
  const int agents = layout.topology.agents();
  const Time end = end_of(agents);
  std::vector<Beacon> beacons;
  beacons.reserve(static_cast<std::size_t>(agents));  // each stays where it is
  Xxh3Digest digest;
  const std::size_t bytes_before = memory::bytes_held();
  std::size_t bytes = 0;
  Simulation simulation({.seed = seed, .end = end, .record = {.digest = &digest}});
  std::optional<Wanderers> paths;
  std::optional<Places> places;
  std::optional<Movement> movement;
  Reach reach{.topology = layout.topology};
  if constexpr (extra == Extra::moving) {
    paths.emplace(layout);
    places.emplace(agents, range_m, 0.25 * range_m);
    movement.emplace(simulation, *places, *paths);
    reach = {.topology = Topology::edges(agents, {}), .places = &*places, .by_place = true};
  }
  Radio radio(simulation, std::move(reach), options_with(extra));
  for (AgentId a = 0; a < agents; ++a) {
    beacons.emplace_back(simulation, radio, a);
    simulation.schedule(Time::at(layout.phase[static_cast<std::size_t>(a)]), Phase::act,
                        [beacon = &beacons.back()] { beacon->talk(); });
  }
  simulation.schedule(Time::at(end.since_start() / 2), Phase::observe,
                      [&bytes, bytes_before] { bytes = memory::bytes_held() - bytes_before; });
  simulation.run();
  radio.finish();
  simulation.record().finish();
  benchmark::DoNotOptimize(digest.hex());
  Tally tally;
  std::uint64_t settled = 0;
  for (const Beacon& beacon : beacons) tally.heard += beacon.heard;
  for (AgentId a = 0; a < agents; ++a) {
    const auto& fates = radio.counts(a).fates;
    tally.in_flight += fates[static_cast<std::size_t>(Fate::in_flight_at_end)];
    settled += radio.counts(a).expected;
  }
  tally.lost = settled - tally.heard - tally.in_flight;
  return {tally, static_cast<double>(bytes) / agents};
}

template <Outcome (*run)(const Layout&), bool like_floor = true>
void beacon(benchmark::State& state, int agents) {
  const Layout layout = make_layout(agents);
  Outcome outcome;
  for (auto _ : state) {
    outcome = run(layout);
    benchmark::DoNotOptimize(outcome);
  }
  const Tally& tally = outcome.tally;
  // A rate is worth something only if both do the same work.
  if (like_floor && tally != run_floor(layout).tally) {
    state.SkipWithError("fates differ from the floor's");
  }
  if (like_floor && outcome.bytes_per_agent > bytes_per_agent_max) {
    state.SkipWithError("more than 1024 bytes an agent");
  }
  if (outcome.bytes_per_agent * agents > bytes_max) state.SkipWithError("more than 2 GiB");
  if (outcome.bytes_per_agent > 0.0) state.counters["bytes_per_agent"] = outcome.bytes_per_agent;
  const auto deliveries = static_cast<double>(tally.heard + tally.lost);
  state.counters["deliveries"] = deliveries;
  state.counters["deliveries_per_s"] = benchmark::Counter(
      deliveries * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

template <Outcome (*run)(const Layout&), bool like_floor = true>
void enlist(const std::string& name, int agents) {
  benchmark::RegisterBenchmark((name + "/" + std::to_string(agents)).c_str(),
                               beacon<run, like_floor>, agents)
      ->Unit(benchmark::kMillisecond);
}

const bool registered = [] {
  for (const int agents : {100, 1'000, 10'000, 100'000}) {
    enlist<run_floor>("floor/beacon", agents);
    if (agents <= 10'000) {
      enlist<run_ours<Extra::none>>("ours/beacon", agents);
      enlist<run_ours<Extra::fading>, false>("ours/fading", agents);
      enlist<run_ours<Extra::sensing>, false>("ours/sensing", agents);
    }
    enlist<run_ours<Extra::moving>, false>("ours/moving", agents);
  }
  return true;
}();

}  // namespace
}  // namespace hearsay
