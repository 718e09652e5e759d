#include "sim/kernel/mailbox.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hearsay {
namespace {

using Log = std::vector<std::string>;

std::string stamp(const Simulation& simulation, const std::string& what) {
  return std::to_string(simulation.now().nanoseconds() / 1'000'000) + " ms: " + what;
}

Process receive(Simulation& simulation, Mailbox<int>& box, int times, std::string who, Log& log) {
  for (int i = 0; i < times; ++i) {
    const int item = co_await box.receive();
    log.push_back(stamp(simulation, who + std::to_string(item)));
  }
}

void put_at(Simulation& simulation, Mailbox<int>& box, Duration at, int item,
            Phase phase = Phase::update) {
  simulation.schedule(Time::at(at), phase, [&box, item] { EXPECT_TRUE(box.put(item)); });
}

Process choose(Simulation& simulation, std::vector<Waitable*> among, Duration timeout, int times,
               Log& log) {
  for (int i = 0; i < times; ++i) {
    const std::optional<std::size_t> which = co_await first_of(simulation, among, timeout);
    log.push_back(stamp(simulation, which ? std::to_string(*which) : "nothing"));
    if (which) (void)static_cast<Mailbox<int>*>(among[*which])->try_receive();
  }
}

TEST(FirstOf, TellsWhichIsReadyFirst) {
  Simulation simulation({});
  Mailbox<int> a(simulation, 8);
  Mailbox<int> b(simulation, 8);
  Log log;
  Process process = choose(simulation, {&a, &b}, 100_ms, 5, log);
  process.start(simulation, 0);
  put_at(simulation, b, 10_ms, 1);
  put_at(simulation, a, 20_ms, 2);
  put_at(simulation, b, 250_ms, 3);
  put_at(simulation, a, 250_ms, 4);
  (void)simulation.run();
  EXPECT_EQ(log, (Log{"10 ms: 1", "20 ms: 0", "120 ms: nothing", "220 ms: nothing", "250 ms: 0"}));
  EXPECT_EQ(b.size(), 1u) << "it takes nothing of the others";
  EXPECT_FALSE(a.has_waiters());
  EXPECT_FALSE(b.has_waiters());
}

TEST(FirstOf, IsAnsweredAtOnceIfOneIsReady) {
  Simulation simulation({});
  Mailbox<int> a(simulation, 8);
  Mailbox<int> b(simulation, 8);
  EXPECT_TRUE(b.put(1));
  Log log;
  Process process = choose(simulation, {&a, &b}, 100_ms, 1, log);
  process.start(simulation, 0);
  EXPECT_EQ(simulation.run().events, 1u);
  EXPECT_EQ(log, (Log{"0 ms: 1"}));
}

TEST(FirstOf, CancelledLeavesAllLines) {
  Simulation simulation({});
  Mailbox<int> a(simulation, 8);
  Mailbox<int> b(simulation, 8);
  Log log;
  Process process = choose(simulation, {&a, &b}, 10_s, 1, log);
  process.start(simulation, 0);
  simulation.schedule(Time::at(1_s), Phase::act, [&] {
    EXPECT_TRUE(a.has_waiters());
    EXPECT_TRUE(b.put(1));
    process.cancel();
    EXPECT_FALSE(a.has_waiters());
    EXPECT_FALSE(b.has_waiters());
  });
  EXPECT_EQ(simulation.run().at, Time::at(1_s));
  EXPECT_TRUE(log.empty());
}

TEST(FirstOf, GoesOnWithTheRestWhenOneIsDestroyed) {
  Simulation simulation({});
  auto a = std::make_unique<Mailbox<int>>(simulation, 8);
  Mailbox<int> b(simulation, 8);
  Log log;
  Process process = choose(simulation, {a.get(), &b}, 10_s, 1, log);
  process.start(simulation, 0);
  simulation.schedule(Time::at(1_s), Phase::act, [&] { a.reset(); });
  put_at(simulation, b, 2_s, 1);
  (void)simulation.run();
  EXPECT_EQ(log, (Log{"2000 ms: 1"}));
}

TEST(FirstOf, LeavesTheItemToWhoStandsBehindIfItIsNotTaken) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 8);
  Log log;
  const auto look = [](Simulation& s, Mailbox<int>& b, Log& l) -> Process {
    Waitable* const one[] = {&b};
    const std::optional<std::size_t> which = co_await first_of(s, one, forever);
    l.push_back(which ? "looked" : "nothing");
  };
  Process first = look(simulation, box, log);
  Process second = receive(simulation, box, 1, "b", log);
  first.start(simulation, 0);
  second.start(simulation, 1);
  put_at(simulation, box, 10_ms, 1);
  (void)simulation.run();
  EXPECT_EQ(log, (Log{"looked", "10 ms: b1"}));
}

TEST(FirstOf, TakesAtMostEight) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 1);
  Log log;
  Process eight = choose(simulation, std::vector<Waitable*>(8, &box), 1_s, 1, log);
  eight.start(simulation, 0);
  Process nine = choose(simulation, std::vector<Waitable*>(9, &box), 1_s, 1, log);
  simulation.schedule(Time::at(2_s), Phase::act, [&] { nine.start(simulation, 1); });
  EXPECT_EQ(simulation.run().message,
            "agent 1 failed at 2.000000000 s: first_of waits for at most 8 things");
  EXPECT_EQ(log, (Log{"1000 ms: nothing"}));
}

Process wait_for(Simulation& simulation, Signal& signal, std::string who, Log& log) {
  co_await signal.wait();
  log.push_back(stamp(simulation, who));
}

TEST(Signal, WakesAllWhoWaitAndStaysReady) {
  Simulation simulation({});
  Signal signal(simulation);
  Log log;
  Process a = wait_for(simulation, signal, "a", log);
  Process b = wait_for(simulation, signal, "b", log);
  Process late = wait_for(simulation, signal, "late", log);
  Process later = wait_for(simulation, signal, "later", log);
  a.start(simulation, 0);
  b.start(simulation, 1);
  simulation.schedule(Time::at(1_s), Phase::act, [&] { signal.fire(); });
  simulation.schedule(Time::at(2_s), Phase::act, [&] { late.start(simulation, 2); });
  simulation.schedule(Time::at(3_s), Phase::act, [&] {
    signal.clear();
    later.start(simulation, 3);
  });
  (void)simulation.run();
  EXPECT_EQ(log, (Log{"1000 ms: a", "1000 ms: b", "2000 ms: late"}));
  EXPECT_FALSE(later.done());
}

}  // namespace
}  // namespace hearsay
