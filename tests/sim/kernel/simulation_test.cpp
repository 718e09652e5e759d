#include "sim/kernel/simulation.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

TEST(Simulation, LetsEventsUpToAndIncludingTheEndHappen) {
  Simulation simulation({.end = Time::at(10_s)});
  std::vector<double> seen;
  for (const double t : {10.0, 3.0, 10.000000001, 12.0}) {
    simulation.schedule(Time::at(Duration::seconds(t)), Phase::act,
                        [&] { seen.push_back(simulation.now().seconds()); });
  }
  const RunEnd end = simulation.run();
  EXPECT_EQ(seen, (std::vector<double>{3.0, 10.0}));
  EXPECT_EQ(end.reason, EndReason::time_reached);
  EXPECT_EQ(end.at, Time::at(10_s));
  EXPECT_EQ(simulation.now(), Time::at(10_s));
  EXPECT_EQ(end.events, 2u);
  EXPECT_TRUE(end.ok());
  EXPECT_TRUE(end.message.empty());
}

TEST(Simulation, TheClockStandsAtTheEndEvenIfTheLastEventWasEarlier) {
  Simulation simulation({.end = Time::at(10_s)});
  simulation.schedule(Time::at(4_s), Phase::act, [] {});
  simulation.schedule(Time::at(11_s), Phase::act, [] { FAIL(); });
  EXPECT_EQ(simulation.run().at, Time::at(10_s));
}

TEST(Simulation, EndsWhenNothingIsLeft) {
  Simulation simulation({.end = Time::at(10_s)});
  simulation.schedule(Time::at(4_s), Phase::act, [] {});
  const RunEnd end = simulation.run();
  EXPECT_EQ(end.reason, EndReason::nothing_left);
  EXPECT_EQ(end.at, Time::at(4_s));
  EXPECT_TRUE(end.ok());
}

TEST(Simulation, WhatIsScheduledForNeverDoesNotHappen) {
  for (const Time last : {Time::never(), Time::at(5_s)}) {
    Simulation simulation({.end = last});
    simulation.schedule(Time::never(), Phase::act, [] { FAIL(); });
    const RunEnd end = simulation.run();
    EXPECT_EQ(end.reason,
              last == Time::never() ? EndReason::nothing_left : EndReason::time_reached);
    EXPECT_EQ(end.events, 0u);
  }
}

TEST(Simulation, EndsWhenTheBudgetOfEventsIsSpent) {
  Simulation simulation({.events_max = 1000});
  std::uint64_t calls = 0;
  struct Again {
    Simulation& simulation;
    std::uint64_t& calls;
    void operator()() {
      ++calls;
      simulation.schedule(simulation.now() + 1_ms, Phase::act, Again{simulation, calls});
    }
  };
  simulation.schedule(Time(), Phase::act, Again{simulation, calls});
  const RunEnd end = simulation.run();
  EXPECT_EQ(end.reason, EndReason::event_budget);
  EXPECT_EQ(end.events, 1000u);
  EXPECT_EQ(calls, 1000u);
  EXPECT_EQ(end.at, Time::at(999_ms));
  EXPECT_FALSE(end.ok());
}

TEST(Simulation, ABudgetThatIsJustEnoughDoesNotEndTheRun) {
  Simulation simulation({.events_max = 2});
  simulation.schedule(Time(), Phase::act, [] {});
  simulation.schedule(Time(), Phase::act, [] {});
  EXPECT_EQ(simulation.run().reason, EndReason::nothing_left);
}

TEST(Simulation, AtOneInstantPhasesHaveTheirOrder) {
  Simulation simulation({});
  std::string order;
  const auto add = [&](Phase phase, char letter) {
    simulation.schedule(Time::at(1_s), phase, [&order, letter] { order += letter; });
  };
  add(Phase::observe, 'o');
  add(Phase::act, 'a');
  add(Phase::update, 'u');
  add(Phase::measure, 'm');
  add(Phase::world, 'w');
  add(Phase::act, 'b');
  // An update that becomes known while agents act comes before the next of them acts.
  simulation.schedule(Time::at(1_s), Phase::act, [&] {
    order += 'c';
    simulation.schedule(simulation.now(), Phase::update, [&] { order += 'v'; });
  });
  add(Phase::act, 'd');
  EXPECT_TRUE(simulation.run().ok());
  EXPECT_EQ(order, "wmuabcvdo");
}

TEST(Simulation, RefusesEventsInThePast) {
  Simulation simulation({});
  EXPECT_THROW(simulation.schedule(Time::at(-(1_ns)), Phase::act, [] {}), BrokenInvariant);
  simulation.schedule(Time::at(2_s), Phase::act, [&] {
    EXPECT_THROW(simulation.schedule(Time::at(1_s), Phase::act, [] {}), BrokenInvariant);
    simulation.schedule(Time::at(2_s), Phase::world, [] {});
  });
  EXPECT_TRUE(simulation.run().ok());
}

TEST(Simulation, WhoTakesSamplesSchedulesNothingAtTheSameInstant) {
  Simulation simulation({});
  simulation.schedule(Time::at(2_s), Phase::observe, [&] {
    simulation.schedule(Time::at(3_s), Phase::observe, [&] {
      simulation.schedule(simulation.now(), Phase::observe, [] { FAIL(); });
    });
  });
  const RunEnd end = simulation.run();
  EXPECT_EQ(end.reason, EndReason::agent_failed);
  EXPECT_EQ(end.message,
            "the run failed at 3.000000000 s: a callback that takes samples scheduled an event at "
            "once");
}

TEST(Simulation, RunsOnce) {
  Simulation simulation({});
  (void)simulation.run();
  EXPECT_THROW((void)simulation.run(), BrokenInvariant);
}

TEST(Simulation, RefusesAnEndBeforeTheStart) {
  EXPECT_THROW(Simulation({.end = Time::at(-(1_s))}), BrokenInvariant);
}

TEST(Simulation, AnExceptionEndsTheRunInTheNameOfTheActingAgent) {
  Simulation simulation({.end = Time::at(60_s)});
  simulation.name_of_agent = [](AgentId agent) {
    return agent == 2 ? std::string("uav2") : std::string();
  };
  simulation.schedule(Time::at(12500_ms), Phase::act, [&] {
    simulation.acting_for(2);
    throw std::runtime_error("no more fuel");
  });
  simulation.schedule(Time::at(12500_ms), Phase::act, [] { FAIL() << "after the failure"; });
  const RunEnd end = simulation.run();
  EXPECT_EQ(end.reason, EndReason::agent_failed);
  EXPECT_FALSE(end.ok());
  EXPECT_EQ(end.agent, 2);
  EXPECT_EQ(end.at, Time::at(12500_ms));
  EXPECT_EQ(end.message, "agent 'uav2' failed at 12.500000000 s: no more fuel");
}

std::string message_of_failure(AgentId agent, bool known_exception) {
  Simulation simulation({});
  simulation.schedule(Time::nanoseconds(1), Phase::act, [&] {
    simulation.acting_for(agent);
    if (known_exception) throw BrokenInvariant("x");
    throw 7;
  });
  return simulation.run().message;
}

TEST(Simulation, NamesWhoHasNoNameByNumber) {
  EXPECT_EQ(message_of_failure(3, true), "agent 3 failed at 0.000000001 s: x");
  EXPECT_EQ(message_of_failure(central_agent, true),
            "the central estimator failed at 0.000000001 s: x");
  EXPECT_EQ(message_of_failure(no_agent, true), "the run failed at 0.000000001 s: x");
  EXPECT_EQ(message_of_failure(no_agent, false),
            "the run failed at 0.000000001 s: an exception that is not a std::exception");
}

TEST(Simulation, NoEventActsForTheAgentOfTheOneBefore) {
  Simulation simulation({});
  simulation.schedule(Time(), Phase::act, [&] { simulation.acting_for(1); });
  simulation.schedule(Time(), Phase::act, [] { throw std::runtime_error("x"); });
  EXPECT_EQ(simulation.run().agent, no_agent);
}

TEST(Simulation, TheFirstFailureCounts) {
  Simulation simulation({});
  simulation.schedule(Time::at(1_s), Phase::act, [&] {
    simulation.fail(4, std::make_exception_ptr(std::runtime_error("first")));
    throw std::runtime_error("second");
  });
  const RunEnd end = simulation.run();
  EXPECT_EQ(end.agent, 4);
  EXPECT_EQ(end.message, "agent 4 failed at 1.000000000 s: first");
}

TEST(Simulation, ACancelledEventDoesNotHappen) {
  Simulation simulation({});
  const EventId id = simulation.schedule(Time::at(2_s), Phase::act, [] { FAIL(); });
  simulation.schedule(Time::at(1_s), Phase::act, [&] {
    EXPECT_TRUE(simulation.cancel(id));
    EXPECT_FALSE(simulation.cancel(id));
  });
  EXPECT_EQ(simulation.run().events, 1u);
}

TEST(Simulation, KnowsTheInstantAfterASpan) {
  Simulation simulation({});
  simulation.schedule(Time::at(2_s), Phase::act, [&] {
    EXPECT_EQ(simulation.after(3_s), Time::at(5_s));
    EXPECT_EQ(simulation.after(-(3_s)), Time::at(2_s));
    EXPECT_EQ(simulation.after(Duration::nanoseconds(INT64_MAX)), Time::never());
  });
  EXPECT_TRUE(simulation.run().ok());
}

// A walk of 40 steps of 1 … 4 ms, among other events on whole milliseconds. With `inline_too` it
// goes on by itself where it may.
std::vector<std::string> walk(bool inline_too, const Simulation::Options& options, RunEnd* end) {
  Simulation simulation(options);
  std::vector<std::string> seen;
  const auto note = [&](const std::string& what) {
    seen.push_back(std::to_string(simulation.now().nanoseconds() / 1'000'000) + " " + what);
  };
  struct Walk {
    Simulation& simulation;
    bool inline_too;
    std::function<void(int)> step;
    int steps = 0;
    void go() {
      for (;;) {
        step(++steps);
        if (steps == 40) return;
        const Time next = simulation.now() + 1_ms * (1 + steps * 7 % 4);
        if (inline_too && simulation.go_on(next, Phase::update)) continue;
        simulation.schedule(next, Phase::update, [this] { go(); });
        return;
      }
    }
  };
  Walk one{simulation, inline_too, [&](int n) {
             note("step " + std::to_string(n));
             if (n % 5 != 0) return;
             const Time later = simulation.now() + 1_ms * (n % 3);
             for (const Phase phase : {Phase::act, Phase::update}) {
               simulation.schedule(later, phase, [&] { note("reaction"); });
             }
           }};
  Walk other{simulation, inline_too, [&](int n) { note("other " + std::to_string(n)); }};
  simulation.schedule(Time::at(3_ms), Phase::update, [&] { one.go(); });
  simulation.schedule(Time::at(50_ms), Phase::update, [&] { other.go(); });
  for (int ms = 0; ms < 150; ms += 7) {
    simulation.schedule(Time::at(1_ms * ms), static_cast<Phase>(ms % 5), [&] { note("else"); });
  }
  const EventId cancelled = simulation.schedule(Time::at(30_ms), Phase::act, [] { FAIL(); });
  simulation.cancel(cancelled);
  *end = simulation.run();
  return seen;
}

TEST(Simulation, WhatGoesOnByItselfLeavesTheSameRunAsWhatIsScheduled) {
  std::vector<Simulation::Options> all;
  for (std::uint64_t events = 0; events < 150; ++events) all.push_back({.events_max = events});
  for (int ms = 0; ms < 160; ++ms) all.push_back({.end = Time::at(1_ms * ms)});
  all.push_back({});
  for (const Simulation::Options& options : all) {
    RunEnd by_itself, scheduled;
    EXPECT_EQ(walk(true, options, &by_itself), walk(false, options, &scheduled));
    EXPECT_EQ(by_itself.events, scheduled.events);
    EXPECT_EQ(by_itself.at, scheduled.at);
    EXPECT_EQ(by_itself.reason, scheduled.reason);
  }
}

TEST(Simulation, AnEventGoesOnOnlyWhereNothingElseIsDue) {
  Simulation simulation({.end = Time::at(10_s)});
  simulation.schedule(Time::at(5_s), Phase::observe, [] {});
  simulation.schedule(Time::at(1_s), Phase::act, [&] {
    EXPECT_FALSE(simulation.go_on(Time::at(5_s), Phase::world)) << "a tie is the queue's";
    EXPECT_FALSE(simulation.go_on(Time::at(6_s), Phase::world));
    EXPECT_EQ(simulation.now(), Time::at(1_s));
    EXPECT_TRUE(simulation.go_on(Time::at(5_s) - 1_ns, Phase::world));
    EXPECT_EQ(simulation.now(), Time::at(5_s) - 1_ns);
    EXPECT_TRUE(simulation.go_on(simulation.now(), Phase::world)) << "at once";
    EXPECT_THROW((void)simulation.go_on(Time::at(1_s), Phase::act), BrokenInvariant);
  });
  simulation.schedule(Time::at(7_s), Phase::act, [&] {
    EXPECT_FALSE(simulation.go_on(Time::at(10_s) + 1_ns, Phase::act)) << "behind the end";
    EXPECT_TRUE(simulation.go_on(Time::at(10_s), Phase::observe));
    EXPECT_FALSE(simulation.go_on(Time::at(10_s), Phase::observe)) << "samples come last";
  });
  EXPECT_THROW((void)simulation.go_on(Time::at(1_s), Phase::act), BrokenInvariant);
  const RunEnd end = simulation.run();
  EXPECT_TRUE(end.ok()) << end.message;
  EXPECT_EQ(end.events, 6u);
  EXPECT_THROW((void)simulation.go_on(Time::never(), Phase::act), BrokenInvariant);
}

TEST(Simulation, NothingGoesOnAfterAFailureOrAtNever) {
  Simulation simulation({});
  simulation.schedule(Time::at(1_s), Phase::act, [&] {
    EXPECT_FALSE(simulation.go_on(Time::never(), Phase::act));
    simulation.fail(4, std::make_exception_ptr(std::runtime_error("x")));
    EXPECT_FALSE(simulation.go_on(Time::at(2_s), Phase::act));
  });
  EXPECT_EQ(simulation.run().at, Time::at(1_s));
}

TEST(Simulation, WhereAnEventGoesOnNobodyActsAtFirst) {
  Simulation simulation({});
  simulation.schedule(Time::at(1_s), Phase::act, [&] {
    simulation.acting_for(2);
    EXPECT_TRUE(simulation.go_on(Time::at(2_s), Phase::act));
    throw std::runtime_error("x");
  });
  EXPECT_EQ(simulation.run().message, "the run failed at 2.000000000 s: x");
}

TEST(Simulation, EndReasonsHaveNames) {
  EXPECT_STREQ(to_string(EndReason::time_reached), "time reached");
  EXPECT_STREQ(to_string(EndReason::nothing_left), "nothing left");
  EXPECT_STREQ(to_string(EndReason::agent_failed), "agent failed");
  EXPECT_STREQ(to_string(EndReason::event_budget), "event budget");
}

TEST(Simulation, StreamsAreThoseOfItsSeed) {
  Simulation simulation({.seed = 77});
  const Purpose purpose("loss");
  EXPECT_EQ(simulation.stream(purpose, Entity::agent(3)).bits(),
            Stream(77, purpose, Entity::agent(3)).bits());
  EXPECT_EQ(simulation.stream_at(purpose, Entity::link(0, 1), 5).bits(),
            Stream::at(77, purpose, Entity::link(0, 1), 5).bits());
}

}  // namespace
}  // namespace hearsay
