// A broadcast that goes on from hearer to hearer leaves the same run as one whose every arrival
// goes through the queue.
#include <gtest/gtest.h>

#include <algorithm>

#include <deque>

#include "tests/net/bed.hpp"

namespace hearsay {
namespace {

struct Load {
  std::uint64_t seed = 1;
  std::uint64_t events_max = 1'000'000;
  Time end = Time::at(30_s);
  double m_per_s = 20.0;
  int agents = 8;
};

std::vector<std::array<double, 3>> places_m(const Load& load) {
  Stream place(load.seed, Purpose("place"), Entity{0});
  std::vector<std::array<double, 3>> places;
  // On a grid, so that many ways are of one length.
  for (int a = 0; a < load.agents; ++a) {
    places.push_back(
        {static_cast<double>(place.below(5)), static_cast<double>(place.below(5)), 0.0});
  }
  return places;
}

constexpr double rate_bps = 800.0;
constexpr double loss = 0.2;
constexpr Duration latency = 50_ms;

// What a run leaves behind.
struct Trace {
  std::uint64_t digest;
  std::vector<std::string> lines;
  RunEnd end;
};

// Agents that talk every 250 ms and answer every third packet with a longer one to its sender, and
// a bystander that looks every 50 ms in every phase. All times are multiples of 50 ms but for the
// ways, many of which are, too.
class Players {
 public:
  virtual ~Players() = default;
  Trace run() {
    for (AgentId a = 0; a < load_.agents; ++a) {
      simulation_.schedule(Time::at(50_ms * (a % 3)), Phase::act, [this, a] { talk(a); });
    }
    for (const Phase phase : {Phase::world, Phase::measure, Phase::update, Phase::observe}) {
      simulation_.schedule(Time(), phase, [this, phase] { look(phase); });
    }
    RunEnd end = simulation_.run();
    finish();
    simulation_.record().finish();
    return {digest_.hash, lines_, end};
  }

 protected:
  explicit Players(const Load& load)
      : load_(load),
        simulation_({.seed = load.seed,
                     .end = load.end,
                     .events_max = load.events_max,
                     .record = {.digest = &digest_}}) {}
  virtual void send(AgentId from, std::size_t bytes, AgentId to) = 0;
  virtual void finish() = 0;
  void hear(AgentId from, AgentId me, std::size_t bytes) {
    note("hears " + std::to_string(from) + " " + std::to_string(me));
    if (++heard_ % 3 == 0 && bytes < 12) send(me, bytes + 1, from);
  }

  Load load_;
  FnvDigest digest_;
  Simulation simulation_;

 private:
  void talk(AgentId me) {
    send(me, 5, no_agent);
    simulation_.schedule(simulation_.now() + 250_ms, Phase::act, [this, me] { talk(me); });
  }
  void look(Phase phase) {
    note("looks " + std::to_string(static_cast<int>(phase)));
    simulation_.schedule(simulation_.now() + 50_ms, phase, [this, phase] { look(phase); });
  }
  void note(const std::string& what) {
    lines_.push_back(std::to_string(simulation_.now().nanoseconds()) + " " + what);
  }
  std::vector<std::string> lines_;
  std::uint64_t heard_ = 0;
};

class OverRadio final : public Players {
 public:
  explicit OverRadio(const Load& load)
      : Players(load),
        radio_(simulation_, Topology::disk(places_m(load), 4.0),
               {.rate_bps = rate_bps,
                .queue = {.packets_max = 1'000'000},
                .latency = latency,
                .loss = Loss::bernoulli(loss),
                .propagation_m_per_s = load.m_per_s}) {
    for (AgentId a = 0; a < load.agents; ++a) {
      ears_.push_back(std::make_unique<Ear>(*this));
      radio_.attach(a, *ears_.back());
    }
  }

 private:
  struct Ear final : Receiver {
    explicit Ear(OverRadio& owner) : owner_(owner) {}
    void on_packet(const Packet& packet) override {
      owner_.hear(packet.sender, packet.receiver, packet.bytes.size());
    }
    OverRadio& owner_;
  };
  void send(AgentId from, std::size_t bytes, AgentId to) override {
    const std::vector<std::byte> payload(bytes);
    radio_.send(from, {.kind = 0, .bytes = payload, .receiver = to});
  }
  void finish() override { radio_.finish(); }

  Radio radio_;
  std::vector<std::unique_ptr<Ear>> ears_;
};

// The same without a cursor, as plainly as can be said: each arrival schedules the next.
class Plain final : public Players {
 public:
  explicit Plain(const Load& load) : Players(load), topology_(Topology::disk(places_m(load), 4.0)) {
    for (const char* fate : {"delivered", "lost"}) simulation_.record().name(fate);
    in_flight_ = simulation_.record().name("in_flight_at_end");
  }

 private:
  struct Arrival {
    Time time;
    AgentId to;
    bool lost;
  };
  struct Flight {
    Time sent;
    AgentId from;
    std::size_t bytes;
    std::vector<Arrival> arrivals;  // in order
    std::size_t next = 0;
  };

  void send(AgentId from, std::size_t bytes, AgentId to) override {
    auto flight = std::make_unique<Flight>(Flight{simulation_.now(), from, bytes, {}});
    for (const AgentId other : topology_.neighbours(from)) {
      if (to != no_agent && other != to) continue;
      const auto link = static_cast<std::size_t>(topology_.link(from, other));
      const Duration way = Duration::seconds(topology_.length_m(link) / load_.m_per_s);
      const bool lost = simulation_
                            .stream_at(Purpose("loss of a packet"), Entity::link(from, other),
                                       packets_[{from, other}]++)
                            .bernoulli(loss);
      flight->arrivals.push_back({Time::at(latency + way), other, lost});  // from the last bit on
    }
    std::stable_sort(flight->arrivals.begin(), flight->arrivals.end(),
                     [](const Arrival& a, const Arrival& b) { return a.time < b.time; });
    flights_.push_back(std::move(flight));
    std::deque<Flight*>& waiting = waiting_[from];
    if (waiting.empty() && free_at_[from] <= simulation_.now()) {
      return begin(flights_.back().get());
    }
    waiting.push_back(flights_.back().get());
    if (waiting.size() == 1) wake(from);
  }
  void wake(AgentId from) {
    simulation_.schedule(free_at_[from], Phase::update, [this, from] {
      Flight* first = waiting_[from].front();
      waiting_[from].pop_front();
      begin(first);
      if (!waiting_[from].empty()) wake(from);
    });
  }
  void begin(Flight* flight) {
    Time& free_at = free_at_[flight->from];
    free_at =
        simulation_.now() + Duration::seconds(8.0 * static_cast<double>(flight->bytes) / rate_bps);
    for (Arrival& arrival : flight->arrivals) {
      arrival.time = free_at + arrival.time.since_start();
    }
    schedule(flight);
  }
  void schedule(Flight* flight) {
    const bool nobody = flight->arrivals.empty();
    const Time time =
        nobody ? free_at_[flight->from] + latency : flight->arrivals[flight->next].time;
    simulation_.schedule(time, Phase::update, [this, flight] { arrive(flight); });
  }
  void arrive(Flight* flight) {
    while (flight->next < flight->arrivals.size()) {
      const Arrival& arrival = flight->arrivals[flight->next];
      if (arrival.time > simulation_.now()) return schedule(flight);
      ++flight->next;
      record(*flight, arrival.to, arrival.lost ? 1 : 0);
      if (!arrival.lost) hear(flight->from, arrival.to, flight->bytes);
    }
  }
  void record(const Flight& flight, AgentId to, NameId fate) {
    simulation_.record().message({flight.sent, simulation_.now(), flight.from, to, 0,
                                  static_cast<std::uint32_t>(flight.bytes), fate});
  }
  void finish() override {
    for (const auto& flight : flights_) {
      while (flight->next < flight->arrivals.size()) {
        record(*flight, flight->arrivals[flight->next++].to, in_flight_);
      }
    }
  }

  Topology topology_;
  std::map<AgentId, Time> free_at_;
  std::map<AgentId, std::deque<Flight*>> waiting_;
  std::map<std::pair<AgentId, AgentId>, std::uint64_t> packets_;
  std::vector<std::unique_ptr<Flight>> flights_;
  NameId in_flight_ = 0;
};

void expect_equal(const Load& load) {
  const Trace plain = Plain(load).run();
  const Trace radio = OverRadio(load).run();
  EXPECT_EQ(radio.lines, plain.lines);
  EXPECT_EQ(radio.digest, plain.digest);
  EXPECT_EQ(radio.end.events, plain.end.events);
  EXPECT_EQ(radio.end.reason, plain.end.reason);
  EXPECT_EQ(radio.end.at, plain.end.at);
}

TEST(RadioCursor, ARunIsTheSameAsWithAnEventAnArrival) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const double m_per_s : {2.0, 20.0, 33.3, 3e8}) {
      SCOPED_TRACE(std::to_string(seed) + " at " + std::to_string(m_per_s) + " m/s");
      expect_equal({.seed = seed, .end = Time::at(5_s), .m_per_s = m_per_s});
    }
  }
}

TEST(RadioCursor, ABudgetIsSpentAtTheSamePlace) {
  for (std::uint64_t events = 1; events < 400; ++events) {
    SCOPED_TRACE(events);
    expect_equal({.seed = events % 5 + 1, .events_max = events});
  }
}

TEST(RadioCursor, ARunEndsAtTheSamePlace) {
  for (int n = 0; n < 300; ++n) {
    SCOPED_TRACE(n);
    expect_equal({.seed = 3, .end = Time::at(1_s + 1_ms * n), .m_per_s = 7.0});
  }
}

TEST(RadioCursor, TheLoadPutsTiesToTheTest) {
  const Trace trace = OverRadio({.end = Time::at(5_s)}).run();
  std::size_t ties = 0;
  for (const std::string& line : trace.lines) {
    ties += line.find("hears") != std::string::npos && line.find("50000000 ") != std::string::npos;
  }
  EXPECT_GT(ties, 50u);
  EXPECT_GT(trace.lines.size(), 1000u);
}

}  // namespace
}  // namespace hearsay
