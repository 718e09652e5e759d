// Counts what the kernel allocates.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "sim/kernel/mailbox.hpp"
#include "sim/kernel/process.hpp"
#include "tools/memory/memory.hpp"

namespace hearsay {
namespace {

using memory::allocations;

TEST(Allocation, IsCountedHere) {
  const std::size_t before = allocations();
  auto* volatile number = new int(3);
  delete number;
  EXPECT_EQ(allocations(), before + 1);
}

TEST(Allocation, TheQueueNeedsNoneInSteadyState) {
  EventQueue queue;
  Stream stream(1, Purpose("allocation test"), Entity{0});
  Time now;
  double sum = 0;
  const auto push = [&](Duration ahead) {
    return queue.push(now + ahead, Phase::act,
                      [&sum, a = 1.0, b = 2.0, c = 3.0] { sum += a * b * c; });
  };
  const auto turn = [&] {
    EventQueue::Event event = queue.pop();
    now = event.time;
    event.callback();
    push(Duration::seconds(stream.exponential(1.0)));
    queue.cancel(push(3_s));
  };
  for (int i = 0; i < 1000; ++i) push(Duration::seconds(stream.exponential(1.0)));
  for (int i = 0; i < 5000; ++i) turn();
  const std::size_t before = allocations();
  for (int i = 0; i < 50'000; ++i) turn();
  EXPECT_EQ(allocations(), before);
  EXPECT_EQ(sum, 6.0 * 55'000);
}

Process sleep_on(Simulation& simulation, Stream stream, int& wakes) {
  for (;;) {
    const Duration span = Duration::seconds(stream.exponential(1.0));
    co_await sleep(simulation, span);
    ++wakes;
  }
}

Process serve(Mailbox<int>& box, int& served) {
  for (;;) {
    const std::optional<int> item = co_await box.receive_within(50_ms);
    served += item ? 1 : 0;
  }
}

Process ask(Simulation& simulation, Mailbox<int>& box, Signal& stop) {
  Waitable* const both[] = {&stop, &box};
  for (;;) {
    (void)box.put(1);
    const std::optional<std::size_t> which = co_await first_of(simulation, both, 10_ms);
    if (which && *which == 0) co_return;
    co_await sleep(simulation, 20_ms);
  }
}

TEST(Allocation, SleepingAndWaitingProcessesNeedNone) {
  Simulation simulation({.end = Time::at(100_s)});
  Mailbox<int> box(simulation, 16);
  Signal stop(simulation);
  int wakes = 0;
  int served = 0;
  std::vector<Process> processes;
  for (AgentId agent = 0; agent < 100; ++agent) {
    processes.push_back(
        sleep_on(simulation, simulation.stream(Purpose("sleep"), Entity::agent(agent)), wakes));
  }
  processes.push_back(serve(box, served));
  processes.push_back(ask(simulation, box, stop));
  for (Process& process : processes) process.start(simulation, 0);
  std::size_t before = 0;
  std::size_t after = 1;
  simulation.schedule(Time::at(10_s), Phase::act, [&before] { before = allocations(); });
  simulation.schedule(Time::at(100_s), Phase::observe, [&after] { after = allocations(); });
  EXPECT_EQ(simulation.run().reason, EndReason::time_reached);
  EXPECT_EQ(after, before);
  EXPECT_GT(wakes, 9'000);
  EXPECT_GT(served, 1'000);
}

class Nowhere : public DigestSink {
 public:
  void update(std::span<const std::byte> bytes) override { count += bytes.size(); }
  std::size_t count = 0;
};

TEST(Allocation, DigestingFatesNeedsNone) {
  Nowhere sink;
  Record record({.digest = &sink});
  const MessageRow row{Time(), Time(), 0, 1, record.name("belief"), 60, record.name("lost")};
  const std::size_t before = allocations();
  for (int i = 0; i < 10'000; ++i) record.message(row);
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(sink.count, 500'000u);
}

}  // namespace
}  // namespace hearsay
