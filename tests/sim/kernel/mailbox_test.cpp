#include "sim/kernel/mailbox.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sim/kernel/error.hpp"

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

Process receive_within(Simulation& simulation, Mailbox<int>& box, Duration timeout, Log& log) {
  for (;;) {
    const std::optional<int> item = co_await box.receive_within(timeout);
    log.push_back(stamp(simulation, item ? std::to_string(*item) : "nothing"));
    if (!item) co_return;
  }
}

void put_at(Simulation& simulation, Mailbox<int>& box, Duration at, int item,
            Phase phase = Phase::update) {
  simulation.schedule(Time::at(at), phase, [&box, item] { EXPECT_TRUE(box.put(item)); });
}

TEST(Mailbox, IsBoundedAndCountsWhatItDrops) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 2);
  EXPECT_FALSE(box.ready());
  EXPECT_TRUE(box.put(1));
  EXPECT_TRUE(box.put(2));
  EXPECT_FALSE(box.put(3));
  EXPECT_FALSE(box.put(4));
  EXPECT_EQ(box.size(), 2u);
  EXPECT_EQ(box.dropped(), 2u);
  EXPECT_EQ(box.try_receive(), 1);
  EXPECT_TRUE(box.put(5));
  EXPECT_EQ(box.try_receive(), 2);
  EXPECT_EQ(box.try_receive(), 5);
  EXPECT_EQ(box.try_receive(), std::nullopt);
  EXPECT_THROW(Mailbox<int>(simulation, 0), BrokenInvariant);
}

TEST(Mailbox, AWaitingProcessGetsItemsInOrder) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 4);
  Log log;
  Process process = receive(simulation, box, 3, "a", log);
  process.start(simulation, 0);
  put_at(simulation, box, 10_ms, 1);
  put_at(simulation, box, 20_ms, 2);
  put_at(simulation, box, 20_ms, 3);
  (void)simulation.run();
  EXPECT_EQ(log, (Log{"10 ms: a1", "20 ms: a2", "20 ms: a3"}));
  EXPECT_TRUE(process.done());
}

TEST(Mailbox, PuttingWakesThroughTheQueueAndNotDirectly) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 4);
  Log log;
  Process process = receive(simulation, box, 1, "a", log);
  process.start(simulation, 0);
  simulation.schedule(Time::at(1_s), Phase::act, [&] {
    EXPECT_TRUE(box.put(1));
    log.push_back("put");
  });
  simulation.schedule(Time::at(1_s), Phase::act, [&] { log.push_back("next"); });
  (void)simulation.run();
  // Updates come before the next one acts.
  EXPECT_EQ(log, (Log{"put", "1000 ms: a1", "next"}));
}

TEST(Mailbox, SeveralProcessesAreServedInTheOrderInWhichTheyCame) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 8);
  Log log;
  Process a = receive(simulation, box, 2, "a", log);
  Process b = receive(simulation, box, 2, "b", log);
  Process c = receive(simulation, box, 1, "c", log);
  a.start(simulation, 0);
  b.start(simulation, 1);
  c.start(simulation, 2);
  put_at(simulation, box, 10_ms, 1);
  put_at(simulation, box, 20_ms, 2);
  put_at(simulation, box, 30_ms, 3);
  put_at(simulation, box, 40_ms, 4);
  put_at(simulation, box, 50_ms, 5);
  (void)simulation.run();
  EXPECT_EQ(log, (Log{"10 ms: a1", "20 ms: b2", "30 ms: c3", "40 ms: a4", "50 ms: b5"}));
}

TEST(Mailbox, WhoFindsTheItemTakenWaitsOn) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 8);
  Log log;
  Process process = receive(simulation, box, 1, "a", log);
  process.start(simulation, 0);
  simulation.schedule(Time::at(10_ms), Phase::act, [&] {
    EXPECT_TRUE(box.put(1));
    EXPECT_EQ(box.try_receive(), 1);  // before the process comes to it
  });
  put_at(simulation, box, 20_ms, 2);
  (void)simulation.run();
  EXPECT_EQ(log, (Log{"20 ms: a2"}));
}

Process put_and_receive(Simulation& simulation, Mailbox<int>& box, int items, Log& log) {
  for (int item = 1; item <= items; ++item) (void)box.put(item);
  const int item = co_await box.receive();
  log.push_back(stamp(simulation, "newcomer" + std::to_string(item)));
}

TEST(Mailbox, ANewcomerDoesNotOvertakeWhoWaits) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 8);
  Log log;
  Process waiting = receive(simulation, box, 1, "a", log);
  Process newcomer = put_and_receive(simulation, box, 1, log);
  waiting.start(simulation, 0);
  // It comes when the item is there and the other is about to be woken: it must get the next.
  simulation.schedule(Time::at(10_ms), Phase::act, [&] { newcomer.start(simulation, 1); });
  put_at(simulation, box, 20_ms, 2);
  (void)simulation.run();
  EXPECT_EQ(log, (Log{"10 ms: a1", "20 ms: newcomer2"}));
}

TEST(Mailbox, ANewcomerIsServedAtOnceIfThereIsEnoughForAll) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 8);
  Log log;
  Process waiting = receive(simulation, box, 1, "a", log);
  Process newcomer = put_and_receive(simulation, box, 2, log);
  waiting.start(simulation, 0);
  simulation.schedule(Time::at(10_ms), Phase::act, [&] { newcomer.start(simulation, 1); });
  (void)simulation.run();
  EXPECT_EQ(log, (Log{"10 ms: a1", "10 ms: newcomer2"}));
}

TEST(Mailbox, TheItemOfACancelledProcessGoesToTheNext) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 8);
  Log log;
  Process a = receive(simulation, box, 1, "a", log);
  Process b = receive(simulation, box, 1, "b", log);
  a.start(simulation, 0);
  b.start(simulation, 1);
  simulation.schedule(Time::at(10_ms), Phase::act, [&] {
    EXPECT_TRUE(box.put(1));
    a.cancel();  // woken, but not yet there
  });
  // Two beginnings, this callback, and b's waking: that of a was taken back.
  EXPECT_EQ(simulation.run().events, 4u);
  EXPECT_EQ(log, (Log{"10 ms: b1"}));
  EXPECT_FALSE(box.has_waiters());
}

TEST(Mailbox, CancellingWhoWaitsLeavesNothingBehind) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 8);
  Log log;
  Process a = receive(simulation, box, 1, "a", log);
  Process b = receive_within(simulation, box, 5_s, log);
  a.start(simulation, 0);
  b.start(simulation, 1);
  simulation.schedule(Time::at(1_s), Phase::act, [&] {
    EXPECT_TRUE(box.has_waiters());
    a.cancel();
    b = Process();
    EXPECT_FALSE(box.has_waiters());
    EXPECT_TRUE(box.put(1));
  });
  const RunEnd end = simulation.run();
  EXPECT_EQ(end.at, Time::at(1_s)) << "the time-out stayed in the queue";
  EXPECT_TRUE(log.empty());
}

TEST(Mailbox, ReceivingWithinATimeGivesTheItemOrNothing) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 8);
  Log log;
  Process process = receive_within(simulation, box, 100_ms, log);
  process.start(simulation, 0);
  put_at(simulation, box, 0_s, 7, Phase::world);  // there before the process
  put_at(simulation, box, 50_ms, 8);
  (void)simulation.run();
  EXPECT_EQ(log, (Log{"0 ms: 7", "50 ms: 8", "150 ms: nothing"}));
  EXPECT_FALSE(box.has_waiters());
}

TEST(Mailbox, AtTheInstantOfTheTimeOutAnItemWins) {
  for (const Phase phase : {Phase::world, Phase::update}) {
    Simulation simulation({});
    Mailbox<int> box(simulation, 8);
    Log log;
    Process process = receive_within(simulation, box, 100_ms, log);
    process.start(simulation, 0);
    put_at(simulation, box, 100_ms, 8, phase);
    (void)simulation.run();
    EXPECT_EQ(log, (Log{"100 ms: 8", "200 ms: nothing"}));
  }
}

TEST(Mailbox, ATimeOutOfZeroOrLessIsALook) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 8);
  Log log;
  Process zero = receive_within(simulation, box, 0_s, log);
  Process less = receive_within(simulation, box, -(1_s), log);
  zero.start(simulation, 0);
  less.start(simulation, 1);
  (void)simulation.run();
  EXPECT_EQ(log, (Log{"0 ms: nothing", "0 ms: nothing"}));
}

TEST(Mailbox, WithoutEndToTheTimeOutItWaits) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 8);
  Log log;
  Process process = receive_within(simulation, box, forever, log);
  process.start(simulation, 0);
  EXPECT_EQ(simulation.run().events, 1u);
  EXPECT_TRUE(log.empty());
}

Process take_owned(Mailbox<std::unique_ptr<int>>& box, int& sum) {
  for (;;) {
    const std::unique_ptr<int> item = co_await box.receive();
    sum += *item;
    std::optional<std::unique_ptr<int>> soon = co_await box.receive_within(1_s);
    if (!soon) co_return;
    sum += 100 * **soon;
  }
}

TEST(Mailbox, PassesThingsThatCanOnlyBeMoved) {
  Simulation simulation({});
  Mailbox<std::unique_ptr<int>> box(simulation, 4);
  int sum = 0;
  Process process = take_owned(box, sum);
  process.start(simulation, 0);
  for (int i = 1; i <= 3; ++i) {
    simulation.schedule(Time::at(100_ms * i), Phase::update,
                        [&box, i] { EXPECT_TRUE(box.put(std::make_unique<int>(i))); });
  }
  (void)simulation.run();
  EXPECT_EQ(sum, 1 + 200 + 3);
  EXPECT_TRUE(process.done());
}

TEST(Mailbox, DestroyedUnderWhoWaitsItNeverWakesThem) {
  Simulation simulation({});
  auto box = std::make_unique<Mailbox<int>>(simulation, 8);
  Log log;
  Process a = receive(simulation, *box, 1, "a", log);
  Process b = receive(simulation, *box, 1, "b", log);
  a.start(simulation, 0);
  b.start(simulation, 1);
  simulation.schedule(Time::at(1_s), Phase::act, [&] {
    EXPECT_TRUE(box->put(1));
    box.reset();
  });
  (void)simulation.run();
  EXPECT_TRUE(log.empty());
  EXPECT_FALSE(a.done());
}

TEST(Mailbox, AnExceptionOfWhoReceivesIsChargedToHim) {
  Simulation simulation({});
  Mailbox<int> box(simulation, 8);
  const auto fail = [](Mailbox<int>& from) -> Process {
    const int item = co_await from.receive();
    throw std::runtime_error("cannot read " + std::to_string(item));
  };
  Process process = fail(box);
  process.start(simulation, 5);
  simulation.schedule(Time::at(1_s), Phase::act, [&] {
    simulation.acting_for(3);  // the sender
    EXPECT_TRUE(box.put(9));
  });
  const RunEnd end = simulation.run();
  EXPECT_EQ(end.agent, 5);
  EXPECT_EQ(end.message, "agent 5 failed at 1.000000000 s: cannot read 9");
}

}  // namespace
}  // namespace hearsay
