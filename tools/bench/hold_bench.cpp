// The hold model: N events pending; each turn takes the first and schedules another one later. The
// floor is std::priority_queue over plain structs; both sides draw the same numbers.
//
//   hold           the next event comes an exponential time (mean 1 s) later
//   whole_seconds  the same, rounded up to whole seconds: very many events at one instant
//   timeouts       each turn also schedules a time-out 3 s ahead and takes back the last one
#include <benchmark/benchmark.h>

#include <cstdint>
#include <queue>
#include <vector>

#include "sim/kernel/event_queue.hpp"
#include "sim/kernel/random.hpp"

namespace {

using hearsay::Duration;
using hearsay::EventId;
using hearsay::EventQueue;
using hearsay::Phase;
using hearsay::Stream;
using hearsay::Time;
using namespace hearsay::literals;

enum class Load { hold, whole_seconds, timeouts };

// What happens at an event on both sides: 16 bytes that are added up.
struct Payload {
  std::uint64_t value;
  std::uint64_t* sum;
  void operator()() const { *sum += value; }
};

Duration ahead(Stream& stream, Load load) {
  const Duration span = Duration::seconds(stream.exponential(1.0));
  return load == Load::whole_seconds ? 1_s * (span / 1_s + 1) : span;
}

Stream draws() { return Stream(1, hearsay::Purpose("hold"), hearsay::Entity{0}); }

template <Load load>
void floor_queue(benchmark::State& state) {
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
  Stream stream = draws();
  std::uint64_t sequence = 0;
  std::uint64_t sum = 0;
  for (std::int64_t i = 0; i < state.range(0); ++i) {
    queue.push({ahead(stream, load).nanoseconds(), sequence++, {1, &sum}});
  }
  for (auto _ : state) {
    // A time-out that was taken back is an entry with nothing to add, which is passed over.
    while (queue.top().payload.value == 0) queue.pop();
    const Entry entry = queue.top();
    queue.pop();
    entry.payload();
    queue.push({entry.time_ns + ahead(stream, load).nanoseconds(), sequence++, {1, &sum}});
    if constexpr (load == Load::timeouts) {
      queue.push({entry.time_ns + (3_s).nanoseconds(), sequence++, {0, &sum}});
    }
  }
  benchmark::DoNotOptimize(sum);
  state.SetItemsProcessed(state.iterations());
}

template <Load load>
void our_queue(benchmark::State& state) {
  EventQueue queue;
  Stream stream = draws();
  std::uint64_t sum = 0;
  for (std::int64_t i = 0; i < state.range(0); ++i) {
    queue.push(Time::at(ahead(stream, load)), Phase::act, Payload{1, &sum});
  }
  EventId timeout;
  for (auto _ : state) {
    EventQueue::Event event = queue.pop();
    event.callback();
    queue.push(event.time + ahead(stream, load), Phase::act, Payload{1, &sum});
    if constexpr (load == Load::timeouts) {
      queue.cancel(timeout);
      timeout = queue.push(event.time + 3_s, Phase::act, Payload{0, &sum});
    }
  }
  benchmark::DoNotOptimize(sum);
  state.SetItemsProcessed(state.iterations());
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(1'000)->Arg(100'000)->Arg(1'000'000);
}

BENCHMARK(floor_queue<Load::hold>)->Name("floor/hold")->Apply(sizes);
BENCHMARK(our_queue<Load::hold>)->Name("ours/hold")->Apply(sizes);
BENCHMARK(floor_queue<Load::whole_seconds>)->Name("floor/whole_seconds")->Apply(sizes);
BENCHMARK(our_queue<Load::whole_seconds>)->Name("ours/whole_seconds")->Apply(sizes);
BENCHMARK(floor_queue<Load::timeouts>)->Name("floor/timeouts")->Apply(sizes);
BENCHMARK(our_queue<Load::timeouts>)->Name("ours/timeouts")->Apply(sizes);

}  // namespace
