// Agents that live elsewhere, in lockstep with their world: each is a thread; what passes between
// them passes as bytes.
#pragma once

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "agents/remote/remote_agent.hpp"
#include "agents/remote/remote_world.hpp"
#include "scenarios/solo.hpp"
#include "tests/scenarios/run_values.hpp"

namespace hearsay {

/// Two threads that hand each other bytes, in turn.
class Handover final : public remote::Line, public remote::Superior {
 public:
  bool exchange(const remote::Order& order, remote::Answer& answer) override {
    tell(order);
    std::unique_lock lock(mutex_);
    turn_.wait(lock, [this] { return has_answer_ || hung_up_; });
    if (hung_up_) return false;
    has_answer_ = false;
    return unpack(bytes_, answer);
  }
  void tell(const remote::Order& order) override {
    const std::scoped_lock lock(mutex_);
    pack(order, bytes_);
    has_order_ = true;
    turn_.notify_all();
  }
  bool exchange(const remote::Answer& answer, remote::Order& order) override {
    {
      const std::scoped_lock lock(mutex_);
      pack(answer, bytes_);
      has_answer_ = true;
      turn_.notify_all();
    }
    return wait_for(order);
  }
  bool wait_for(remote::Order& order) {
    std::unique_lock lock(mutex_);
    turn_.wait(lock, [this] { return has_order_; });
    has_order_ = false;
    return unpack(bytes_, order);
  }
  void hang_up() {
    const std::scoped_lock lock(mutex_);
    hung_up_ = true;
    turn_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable turn_;
  std::vector<std::byte> bytes_;
  bool has_order_ = false, has_answer_ = false, hung_up_ = false;
};

struct Result {
  std::string run, ledger;
  RunEnd end;
};

inline Result result_of(const std::shared_ptr<const PreparedScenario>& prepared,
                        Run::Options options) {
  static const Catalog catalog;
  DigestedBytes digest, ledger;
  options.digest = &digest;
  options.ledger_digest = &ledger;
  Run run(prepared, catalog, options);
  const RunEnd end = run.run();
  return {std::move(digest.all), std::move(ledger.all), end};
}

/// The life of an agent in its thread.
inline void live(const std::shared_ptr<const PreparedScenario>& prepared, AgentId id,
                 std::uint64_t seed, Handover& way) {
  static const Catalog catalog;
  remote::Order first;
  if (!way.wait_for(first) || first.kind == remote::OrderKind::dismiss) return;
  const bool ledgers = prepared->scenario.record.ledger == "on";
  remote::RemoteWorld world(
      way, first, {.ledgers = ledgers, .subjects = static_cast<int>(prepared->subjects.size())});
  Solo solo(
      prepared, catalog, world,
      {.id = id, .seed = seed, .now = first.now, .tap = &world.tap(), .plans = &world.plans()});
  if (!world.serve(
          {solo.simulation(), solo.agent(), solo.receiver(), solo.reporter(), solo.riders()})) {
    way.hang_up();
  }
}

inline Result elsewhere(const std::shared_ptr<const PreparedScenario>& prepared,
                        std::uint64_t seed) {
  std::vector<std::unique_ptr<Handover>> ways;
  std::vector<std::thread> threads;
  Run::Options options{.seed = seed};
  options.elsewhere = [&](Context& context, const remote::Belongings& world) {
    Handover& way = *ways[static_cast<std::size_t>(context.id())];
    return std::make_unique<remote::RemoteAgent>(context, way, world,
                                                 remote_options(*prepared, context.id()));
  };
  for (std::size_t i = 0; i < prepared->specs.size(); ++i) {
    ways.push_back(std::make_unique<Handover>());
    threads.emplace_back([&prepared, &way = *ways.back(), i, seed] {
      live(prepared, static_cast<AgentId>(i), seed, way);
    });
  }
  const Result result = result_of(prepared, options);
  for (const auto& way : ways) way->tell({.kind = remote::OrderKind::dismiss});
  for (std::thread& thread : threads) thread.join();
  return result;
}

/// Every seed gives the same digests and events here and elsewhere.
inline void expect_same(const std::shared_ptr<const PreparedScenario>& prepared) {
  for (const std::uint64_t seed : {1u, 7u}) {
    const Result here = result_of(prepared, {.seed = seed});
    const Result there = elsewhere(prepared, seed);
    ASSERT_TRUE(here.end.ok()) << here.end.message;
    EXPECT_TRUE(there.end.ok()) << there.end.message;
    EXPECT_GT(here.run.size(), 1000u);
    EXPECT_TRUE(here.run == there.run);
    EXPECT_TRUE(here.ledger == there.ledger);
    EXPECT_EQ(here.end.events, there.end.events);
  }
}

}  // namespace hearsay
