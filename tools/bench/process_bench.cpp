// Coroutines that sleep: 10,000 of them, each for an exponential time (mean 1 s) again and again.
// The floor is a std::priority_queue that resumes bare coroutine handles; both sides draw the same
// numbers. An item is one wake-up. Ours must stay within 400 bytes a process: its frame, its handle
// and its share of the queue.
#include <benchmark/benchmark.h>

#include <coroutine>
#include <cstdint>
#include <exception>
#include <queue>
#include <vector>

#include "sim/kernel/process.hpp"
#include "tools/bench/draw.hpp"
#include "tools/memory/memory.hpp"

namespace {

using hearsay::AgentId;
using hearsay::Duration;
using hearsay::Process;
using hearsay::Simulation;
using hearsay::bench::draw;
using hearsay::bench::exponential_ns;

constexpr std::uint64_t wake_ups = 1'000'000;

constexpr double bytes_max = 400;

// The least that can be called a process.
struct Bare {
  struct promise_type {
    Bare get_return_object() { return {std::coroutine_handle<promise_type>::from_promise(*this)}; }
    std::suspend_never initial_suspend() noexcept { return {}; }
    std::suspend_always final_suspend() noexcept { return {}; }
    void return_void() {}
    void unhandled_exception() { std::terminate(); }
  };
  std::coroutine_handle<promise_type> handle;
};

struct Heap {
  struct Entry {
    std::int64_t time_ns;
    std::uint64_t sequence;
    std::coroutine_handle<> handle;
  };
  struct Later {
    bool operator()(const Entry& a, const Entry& b) const {
      return a.time_ns != b.time_ns ? a.time_ns > b.time_ns : a.sequence > b.sequence;
    }
  };
  std::priority_queue<Entry, std::vector<Entry>, Later> queue;
  std::uint64_t sequence = 0;
  std::int64_t now_ns = 0;
};

class BareSleep {
 public:
  BareSleep(Heap& heap, std::int64_t span_ns) : heap_(heap), span_ns_(span_ns) {}
  bool await_ready() const noexcept { return false; }
  void await_suspend(std::coroutine_handle<> handle) {
    heap_.queue.push({heap_.now_ns + span_ns_, heap_.sequence++, handle});
  }
  void await_resume() noexcept {}

 private:
  Heap& heap_;
  std::int64_t span_ns_;
};

Bare sleep_barely(Heap& heap, std::uint32_t who, std::uint64_t& count) {
  for (std::uint64_t turn = 0;; ++turn) {
    const std::int64_t span_ns = exponential_ns(draw(turn, who).first);
    co_await BareSleep(heap, span_ns);
    ++count;
  }
}

void floor_processes(benchmark::State& state) {
  std::uint64_t count = 0;
  for (auto _ : state) {
    state.PauseTiming();
    Heap heap;
    std::vector<Bare> all;
    for (std::uint32_t i = 0; i < state.range(0); ++i) {
      all.push_back(sleep_barely(heap, i, count));
    }
    state.ResumeTiming();
    for (std::uint64_t i = 0; i < wake_ups; ++i) {
      const Heap::Entry entry = heap.queue.top();
      heap.queue.pop();
      heap.now_ns = entry.time_ns;
      entry.handle.resume();
    }
    state.PauseTiming();
    for (Bare& bare : all) bare.handle.destroy();
    state.ResumeTiming();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(count));
}

Process sleep_well(Simulation& simulation, std::uint32_t who, std::uint64_t& count) {
  for (std::uint64_t turn = 0;; ++turn) {
    const Duration span = Duration::nanoseconds(exponential_ns(draw(turn, who).first));
    co_await hearsay::sleep(simulation, span);
    ++count;
  }
}

void our_processes(benchmark::State& state) {
  std::uint64_t count = 0;
  const auto pending = static_cast<std::uint64_t>(state.range(0));
  double bytes = 0;
  for (auto _ : state) {
    state.PauseTiming();
    {
      // Their beginnings are events, too.
      const std::size_t before = hearsay::memory::bytes_held();
      Simulation simulation({.events_max = wake_ups + pending});
      std::vector<Process> all;
      for (std::uint32_t i = 0; i < state.range(0); ++i) {
        all.push_back(sleep_well(simulation, i, count));
        all.back().start(simulation, static_cast<AgentId>(i));
      }
      state.ResumeTiming();
      benchmark::DoNotOptimize(simulation.run().events);
      state.PauseTiming();
      bytes = static_cast<double>(hearsay::memory::bytes_held() - before) /
              static_cast<double>(state.range(0));
    }
    state.ResumeTiming();
  }
  state.counters["bytes_per_process"] = bytes;
  if (bytes > bytes_max) state.SkipWithError("more than 400 bytes a process");
  state.SetItemsProcessed(static_cast<std::int64_t>(count));
}

BENCHMARK(floor_processes)->Name("floor/process")->Arg(10'000)->Unit(benchmark::kMillisecond);
BENCHMARK(our_processes)->Name("ours/process")->Arg(10'000)->Unit(benchmark::kMillisecond);

}  // namespace
