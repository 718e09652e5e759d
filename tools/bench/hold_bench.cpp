// The hold model: N events pending; each turn takes the first and schedules another one later. The
// floor is std::priority_queue over plain structs; both sides draw the same numbers: Philox4x32-10
// and the C library's logarithm, so that what is measured is the queue.
//
//   hold           the next event comes an exponential time (mean 1 s) later
//   whole_seconds  the same, rounded to whole seconds: very many events at one instant
//   bimodal        nine in ten come within a microsecond, the rest within 100 s
//   timeouts       each turn of `hold` also schedules a time-out 3 s ahead and takes back the last;
//                  to be compared with the floor of plain `hold`
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdint>
#include <queue>
#include <string>
#include <vector>

#include "sim/kernel/event_queue.hpp"
#include "tools/bench/draw.hpp"

namespace {

using hearsay::Duration;
using hearsay::EventId;
using hearsay::EventQueue;
using hearsay::Phase;
using hearsay::Time;
using hearsay::bench::Draws;
using hearsay::bench::exponential_ns;
using namespace hearsay::literals;

enum class Load { hold, whole_seconds, bimodal, timeouts };

// What happens at an event on both sides: 16 bytes that are added up.
struct Payload {
  std::uint64_t value;
  std::uint64_t* sum;
  void operator()() const { *sum += value; }
};

std::int64_t ahead_ns(Draws& draws, Load load) {
  if (load == Load::bimodal) {
    const double longest_ns = draws.next() < 0.9 ? 1e3 : 1e11;
    return static_cast<std::int64_t>(draws.next() * longest_ns);
  }
  const std::int64_t span_ns = exponential_ns(draws.next());
  constexpr std::int64_t second_ns = 1'000'000'000;
  return load == Load::whole_seconds ? (span_ns + second_ns / 2) / second_ns * second_ns : span_ns;
}

struct FloorQueue {
  struct Entry {
    std::int64_t time_ns;
    std::uint64_t sequence;
    Payload payload;
  };
  struct Later {
    bool operator()(const Entry& a, const Entry& b) const {
      return a.time_ns != b.time_ns ? a.time_ns > b.time_ns : a.sequence > b.sequence;
    }
  };
  std::priority_queue<Entry, std::vector<Entry>, Later> queue;
  std::uint64_t sequence = 0;

  void push(std::int64_t time_ns, Payload payload) { queue.push({time_ns, sequence++, payload}); }

  template <Load load>
  void turn(Draws& draws) {
    const Entry entry = queue.top();
    queue.pop();
    entry.payload();
    push(entry.time_ns + ahead_ns(draws, load), {1, entry.payload.sum});
  }
};

struct OurQueue {
  EventQueue queue;
  EventId timeout;
  std::uint64_t* sum = nullptr;

  void push(std::int64_t time_ns, Payload payload) {
    sum = payload.sum;
    queue.push(Time::nanoseconds(time_ns), Phase::act, payload);
  }

  template <Load load>
  void turn(Draws& draws) {
    EventQueue::Event event = queue.pop();
    event.callback();
    push((event.time + Duration::nanoseconds(ahead_ns(draws, load))).nanoseconds(), {1, sum});
    if constexpr (load == Load::timeouts) {
      queue.cancel(timeout);
      timeout = queue.push(event.time + 3_s, Phase::act, Payload{0, sum});
    }
  }
};

template <class Queue, Load load>
void hold(benchmark::State& state, int pending) {
  Queue queue;
  Draws draws;
  std::uint64_t sum = 0;
  for (int i = 0; i < pending; ++i) queue.push(ahead_ns(draws, load), {1, &sum});
  // As many turns as events: what is timed is the steady state.
  for (int i = 0; i < pending; ++i) queue.template turn<load>(draws);
  for (auto _ : state) queue.template turn<load>(draws);
  benchmark::DoNotOptimize(sum);
  state.SetItemsProcessed(state.iterations());
}

template <Load load>
void register_load(const char* name) {
  for (const int pending : {1'000, 100'000, 1'000'000}) {
    // Whole rounds of whatever a queue does once in a while.
    const int turns = std::max(2'000'000, 4 * pending);
    const std::string row = std::string(name) + "/" + std::to_string(pending);
    if constexpr (load != Load::timeouts) {
      benchmark::RegisterBenchmark(("floor/" + row).c_str(), hold<FloorQueue, load>, pending)
          ->Iterations(turns);
    }
    benchmark::RegisterBenchmark(("ours/" + row).c_str(), hold<OurQueue, load>, pending)
        ->Iterations(turns);
  }
}

const bool registered = [] {
  register_load<Load::hold>("hold");
  register_load<Load::whole_seconds>("whole_seconds");
  register_load<Load::bimodal>("bimodal");
  register_load<Load::timeouts>("timeouts");
  return true;
}();

}  // namespace
