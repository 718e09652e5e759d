#include "sim/kernel/process.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/kernel/mailbox.hpp"

namespace hearsay {
namespace {

// Says that the frame it lives in was destroyed.
class Guard {
 public:
  explicit Guard(int& destroyed) : destroyed_(destroyed) {}
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;
  ~Guard() { ++destroyed_; }

 private:
  int& destroyed_;
};

Process tick(Simulation& simulation, Duration period, std::vector<double>& seen, int& destroyed) {
  const Guard guard(destroyed);
  for (;;) {
    seen.push_back(simulation.now().seconds());
    co_await sleep(simulation, period);
  }
}

TEST(Process, SleepsAndGoesOn) {
  Simulation simulation({.end = Time::at(3_s)});
  std::vector<double> seen;
  int destroyed = 0;
  {
    Process process = tick(simulation, 1_s, seen, destroyed);
    process.start(simulation, 0);
    EXPECT_TRUE(seen.empty()) << "a process begins through the queue";
    EXPECT_EQ(simulation.run().reason, EndReason::time_reached);
    EXPECT_EQ(seen, (std::vector<double>{0, 1, 2, 3}));
    EXPECT_FALSE(process.done());
  }
  EXPECT_EQ(destroyed, 1);
}

TEST(Process, CancelledWhileItSleepsItNeverGoesOn) {
  Simulation simulation({});
  std::vector<double> seen;
  int destroyed = 0;
  Process process = tick(simulation, 1_s, seen, destroyed);
  process.start(simulation, 0);
  simulation.schedule(Time::at(2500_ms), Phase::act, [&] {
    process.cancel();
    EXPECT_EQ(destroyed, 1);
    EXPECT_TRUE(process.done());
    process.cancel();
  });
  const RunEnd end = simulation.run();
  EXPECT_EQ(seen, (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(end.reason, EndReason::nothing_left) << "its event stayed in the queue";
  EXPECT_EQ(end.at, Time::at(2500_ms));
}

TEST(Process, CancelledAtTheInstantOfItsWakeUpItDoesNotGoOn) {
  Simulation simulation({.end = Time::at(5_s)});
  std::vector<double> seen;
  int destroyed = 0;
  Process process = tick(simulation, 1_s, seen, destroyed);
  process.start(simulation, 0);
  simulation.schedule(Time::at(1_s), Phase::update, [&] { process.cancel(); });
  (void)simulation.run();
  EXPECT_EQ(seen, (std::vector<double>{0}));
  EXPECT_EQ(destroyed, 1);
}

TEST(Process, CancelledBeforeItsBeginningItNeverBegins) {
  Simulation simulation({});
  std::vector<double> seen;
  int destroyed = 0;
  {
    Process process = tick(simulation, 1_s, seen, destroyed);
    process.start(simulation, 0);
  }
  EXPECT_EQ(simulation.run().events, 0u);
  EXPECT_TRUE(seen.empty());
}

TEST(Process, NeverStartedItIsDestroyedInPeace) {
  Simulation simulation({});
  std::vector<double> seen;
  int destroyed = 0;
  {
    const Process process = tick(simulation, 1_s, seen, destroyed);
    EXPECT_FALSE(process.done());
  }
  EXPECT_EQ(simulation.run().events, 0u);
  EXPECT_TRUE(Process().done());
}

TEST(Process, StartsOnceAndOnlyIfItWasMade) {
  Simulation simulation({.end = Time::at(1_s)});
  std::vector<double> seen;
  int destroyed = 0;
  Process process = tick(simulation, 2_s, seen, destroyed);
  process.start(simulation, 0);
  EXPECT_THROW(process.start(simulation, 0), BrokenInvariant);
  EXPECT_THROW(Process().start(simulation, 0), BrokenInvariant);
  (void)simulation.run();
  EXPECT_EQ(seen.size(), 1u);
}

TEST(Process, MovesWithoutDisturbingWhatRuns) {
  Simulation simulation({.end = Time::at(2_s)});
  std::vector<double> first;
  std::vector<double> second;
  int destroyed_first = 0;
  int destroyed_second = 0;
  Process process = tick(simulation, 1_s, first, destroyed_first);
  process.start(simulation, 0);
  Process other = std::move(process);
  EXPECT_TRUE(process.done());  // NOLINT: what a move leaves behind is what is tested
  process = tick(simulation, 1_s, second, destroyed_second);
  process.start(simulation, 1);
  // Assigning over a process cancels it.
  simulation.schedule(Time::at(1500_ms), Phase::act, [&] { other = std::move(process); });
  (void)simulation.run();
  EXPECT_EQ(first, (std::vector<double>{0, 1}));
  EXPECT_EQ(second, (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(destroyed_first, 1);
  EXPECT_EQ(destroyed_second, 0);
}

Process brief(Simulation& simulation, int& destroyed) {
  const Guard guard(destroyed);
  co_await sleep(simulation, 1_s);
}

TEST(Process, OnceDoneItMayOutliveItsSimulation) {
  int destroyed = 0;
  Process process;
  {
    Simulation simulation({});
    process = brief(simulation, destroyed);
    process.start(simulation, 0);
    (void)simulation.run();
    EXPECT_TRUE(process.done());
    EXPECT_EQ(destroyed, 1);
  }
}

Process fail_after(Simulation& simulation, Duration span, std::string what) {
  co_await sleep(simulation, span);
  throw std::runtime_error(what);
}

TEST(Process, AnExceptionEndsTheRunWithNameAndTime) {
  Simulation simulation({.end = Time::at(60_s)});
  simulation.name_of_agent = [](AgentId agent) { return "uav" + std::to_string(agent); };
  std::vector<double> seen;
  int destroyed = 0;
  Process bystander = tick(simulation, 5_s, seen, destroyed);
  Process process = fail_after(simulation, 12500_ms, "no more fuel");
  bystander.start(simulation, 0);
  process.start(simulation, 2);
  const RunEnd end = simulation.run();
  EXPECT_EQ(end.reason, EndReason::agent_failed);
  EXPECT_EQ(end.agent, 2);
  EXPECT_EQ(end.message, "agent 'uav2' failed at 12.500000000 s: no more fuel");
  EXPECT_TRUE(process.done());
  EXPECT_EQ(seen, (std::vector<double>{0, 5, 10}));
}

Process fail_at_once() {
  throw std::runtime_error("at once");
  co_return;
}

TEST(Process, AnExceptionBeforeTheFirstWaitEndsTheRunToo) {
  Simulation simulation({});
  Process process = fail_at_once();
  process.start(simulation, 1);
  EXPECT_EQ(simulation.run().message, "agent 1 failed at 0.000000000 s: at once");
}

Process sleep_badly(Simulation& simulation, std::vector<double>& seen) {
  co_await sleep(simulation, 3_s);
  seen.push_back(simulation.now().seconds());
  co_await sleep(simulation, -(2_s));
  seen.push_back(simulation.now().seconds());
  const Time past = Time::at(1_s);
  co_await sleep_until(simulation, past);
  seen.push_back(simulation.now().seconds());
  co_await sleep(simulation, forever);
  seen.push_back(simulation.now().seconds());
}

TEST(Process, SleepingIntoThePastGoesOnAtOnceAndForeverNever) {
  Simulation simulation({});
  std::vector<double> seen;
  Process process = sleep_badly(simulation, seen);
  process.start(simulation, 0);
  EXPECT_EQ(simulation.run().reason, EndReason::nothing_left);
  EXPECT_EQ(seen, (std::vector<double>{3, 3, 3}));
}

Process write(Simulation& simulation, Phase phase, char letter, std::string& order) {
  const Time at = Time::at(1_s);
  co_await sleep_until(simulation, at, phase);
  order += letter;
}

TEST(Process, WakesInItsPhaseAndThenInOrder) {
  Simulation simulation({});
  std::string order;
  std::vector<Process> processes;
  const std::pair<Phase, char> plan[] = {{Phase::observe, 'o'}, {Phase::act, 'a'},
                                         {Phase::world, 'w'},   {Phase::act, 'b'},
                                         {Phase::update, 'u'},  {Phase::measure, 'm'}};
  for (const auto& [phase, letter] : plan) {
    processes.push_back(write(simulation, phase, letter, order));
  }
  for (Process& process : processes) process.start(simulation, 0);
  (void)simulation.run();
  EXPECT_EQ(order, "wmuabo");
}

Process wake_many_times(Simulation& simulation, int times, int& count) {
  for (int i = 0; i < times; ++i) {
    co_await sleep(simulation, 0_s);
    ++count;
  }
}

TEST(Process, AMillionWakeUpsAtOneInstantDoNotOverflowTheStack) {
  Simulation simulation({});
  int count = 0;
  Process process = wake_many_times(simulation, 1'000'000, count);
  process.start(simulation, 0);
  const RunEnd end = simulation.run();
  EXPECT_EQ(count, 1'000'000);
  EXPECT_EQ(end.at, Time());
}

Process take_many(Mailbox<int>& box, int times, int& count) {
  for (int i = 0; i < times; ++i) {
    (void)box.put(i);
    const int got = co_await box.receive();  // ready at once: it does not even suspend
    count += got == i ? 1 : 0;
  }
}

TEST(Process, AMillionItemsThatAreThereAlreadyDoNotOverflowTheStack) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 1);
  int count = 0;
  Process process = take_many(box, 1'000'000, count);
  process.start(simulation, 0);
  (void)simulation.run();
  EXPECT_EQ(count, 1'000'000);
}

Process draw(Simulation& simulation, std::vector<double>& seen) {
  Stream stream = simulation.stream(Purpose("waits"), Entity::agent(0));
  for (int i = 0; i < 50; ++i) {
    const Duration span = Duration::seconds(stream.exponential(1.0));
    co_await sleep(simulation, span);
    seen.push_back(simulation.now().seconds());
  }
}

// What one run sees when, from within its events, `other` is run to its end if there is one.
std::vector<double> waits(std::uint64_t seed, Simulation* other = nullptr) {
  Simulation simulation({.seed = seed});
  std::vector<double> seen;
  Process process = draw(simulation, seen);
  process.start(simulation, 0);
  if (other != nullptr) {
    simulation.schedule(Time::at(7_s), Phase::act, [other] { (void)other->run(); });
  }
  EXPECT_TRUE(simulation.run().ok());
  return seen;
}

TEST(Process, TwoSimulationsInOneThreadDoNotInfluenceEachOther) {
  Simulation inner({.seed = 2});
  std::vector<double> seen_inside;
  Process process = draw(inner, seen_inside);
  process.start(inner, 0);
  const std::vector<double> outer = waits(1, &inner);
  EXPECT_EQ(outer, waits(1));
  EXPECT_EQ(seen_inside, waits(2));
  EXPECT_NE(outer, seen_inside);
}

Process cancel_itself(Process& self) {
  self.cancel();
  co_return;
}

TEST(ProcessDeathTest, CancellingItselfStopsTheProgramWithAMessage) {
  const auto suicide = [] {
    Simulation simulation({});
    Process process;
    process = cancel_itself(process);
    process.start(simulation, 0);
    (void)simulation.run();
  };
  EXPECT_DEATH(suicide(), "a process cancelled or destroyed itself");
}

}  // namespace
}  // namespace hearsay
