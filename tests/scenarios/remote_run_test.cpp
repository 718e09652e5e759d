// Agents that live elsewhere, in lockstep with their world, do what they do within one process: the
// same digest. Here each agent is a thread; what passes between them passes as bytes.
#include <gtest/gtest.h>

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <span>
#include <thread>
#include <utility>

#include "agents/remote/remote_agent.hpp"
#include "agents/remote/remote_world.hpp"
#include "scenarios/solo.hpp"
#include "tests/scenarios/run_values.hpp"

namespace hearsay {
namespace {

using remote::Answer;
using remote::AnswerKind;
using remote::Order;
using remote::OrderKind;

/// Two threads that hand each other bytes, in turn.
class Handover final : public remote::Line, public remote::Superior {
 public:
  bool exchange(const Order& order, Answer& answer) override {
    tell(order);
    std::unique_lock lock(mutex_);
    turn_.wait(lock, [this] { return has_answer_ || hung_up_; });
    if (hung_up_) return false;
    has_answer_ = false;
    return unpack(bytes_, answer);
  }
  void tell(const Order& order) override {
    const std::scoped_lock lock(mutex_);
    pack(order, bytes_);
    has_order_ = true;
    turn_.notify_all();
  }
  bool exchange(const Answer& answer, Order& order) override {
    {
      const std::scoped_lock lock(mutex_);
      pack(answer, bytes_);
      has_answer_ = true;
      turn_.notify_all();
    }
    return wait_for(order);
  }
  bool wait_for(Order& order) {
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

std::shared_ptr<const PreparedScenario> prepared_of(const std::string& file,
                                                    const std::vector<Override>& set = {}) {
  static const Catalog catalog;
  LogCache logs;
  return prepare(load_scenario(file, set, known_names(catalog)), catalog, logs);
}

struct Result {
  std::string run, ledger;
  RunEnd end;
};

Result result_of(const std::shared_ptr<const PreparedScenario>& prepared, Run::Options options) {
  static const Catalog catalog;
  DigestedBytes digest, ledger;
  options.digest = &digest;
  options.ledger_digest = &ledger;
  Run run(prepared, catalog, options);
  const RunEnd end = run.run();
  return {std::move(digest.all), std::move(ledger.all), end};
}

/// The life of an agent in its thread.
void live(const std::shared_ptr<const PreparedScenario>& prepared, AgentId id, std::uint64_t seed,
          Handover& way) {
  static const Catalog catalog;
  Order first;
  if (!way.wait_for(first) || first.kind == OrderKind::dismiss) return;
  const bool ledgers = prepared->scenario.record.ledger == "on";
  remote::RemoteWorld world(
      way, first, {.ledgers = ledgers, .subjects = static_cast<int>(prepared->subjects.size())});
  Solo solo(
      prepared, catalog, world, world,
      {.id = id, .seed = seed, .now = first.now, .tap = &world.tap(), .plans = &world.plans()});
  if (!world.serve({solo.simulation(), solo.agent(), solo.receiver()})) way.hang_up();
}

Result elsewhere(const std::shared_ptr<const PreparedScenario>& prepared, std::uint64_t seed) {
  std::vector<std::unique_ptr<Handover>> ways;
  std::vector<std::thread> threads;
  Run::Options options{.seed = seed};
  options.elsewhere = [&](Context& context, EstimatorWitness* witness) {
    Handover& way = *ways[static_cast<std::size_t>(context.id())];
    return std::make_unique<remote::RemoteAgent>(context, way, witness,
                                                 remote_options(*prepared, context.id()));
  };
  for (std::size_t i = 0; i < prepared->specs.size(); ++i) {
    ways.push_back(std::make_unique<Handover>());
    threads.emplace_back([&prepared, &way = *ways.back(), i, seed] {
      live(prepared, static_cast<AgentId>(i), seed, way);
    });
  }
  const Result result = result_of(prepared, options);
  for (const auto& way : ways) way->tell({.kind = OrderKind::dismiss});
  for (std::thread& thread : threads) thread.join();
  return result;
}

void expect_same(const std::string& file, const std::vector<Override>& set = {}) {
  const auto prepared = prepared_of(std::string(HEARSAY_SOURCE_DIR) + "/" + file, set);
  for (const std::uint64_t seed : {1u, 7u}) {
    const Result here = result_of(prepared, {.seed = seed});
    const Result there = elsewhere(prepared, seed);
    ASSERT_TRUE(here.end.ok()) << here.end.message;
    EXPECT_TRUE(there.end.ok()) << there.end.message;
    EXPECT_GT(here.run.size(), 1000u);
    EXPECT_TRUE(here.run == there.run) << file;
    EXPECT_TRUE(here.ledger == there.ledger) << file;
    EXPECT_EQ(here.end.events, there.end.events) << file;
  }
}

using Set = std::vector<Override>;

TEST(RemoteRun, HasTheDigestOfTheRunInOneProcess) {
  for (const char* rule : {"\"naive\"", "\"channel-robust\"", "\"ci-det\"", "\"split-ci\"",
                           "\"hybrid-consensus\"", "\"ci-batch\"", "\"none\""}) {
    SCOPED_TRACE(rule);
    expect_same("scenarios/rumour/rumour.toml",
                Set{{"duration_s", "40.0"}, {"agents.estimator.fusion", rule}});
  }
}

TEST(RemoteRun, HasItForStatesThatMoveAndForTrajectoriesWithTheirLedgers) {
  expect_same("scenarios/merino/ch3-track.toml", Set{{"duration_s", "30.0"}});
  expect_same("scenarios/merino/ch3-window.toml", Set{{"duration_s", "60.0"}});
  expect_same("scenarios/merino/ch3-track.toml",
              Set{{"duration_s", "30.0"},
                  {"agents.estimator.kind", "\"moving-gaussian\""},
                  {"agents.estimator.fusion", "\"ci-det\""}});
}

TEST(RemoteRun, HasItWhereAgentsMoveAndTalkByStoreAndForward) {
  expect_same("scenarios/rumour/mule.toml", Set{{"duration_s", "120.0"}});
  expect_same("scenarios/rumour/mule.toml",
              Set{{"duration_s", "120.0"}, {"agents.talk.service", "\"store-and-forward\""}});
}

TEST(RemoteRun, HasItWhereAgentsFailAndComeBack) {
  for (const char* kind : {"sleep", "reboot"}) {
    const std::string dropouts =
        "[{ kind = \"" + std::string(kind) + "\", mean_up_s = 10.0, mean_down_s = 5.0 }]";
    expect_same("scenarios/rumour/rumour.toml",
                Set{{"duration_s", "40.0"}, {"dropouts", dropouts}});
  }
}

TEST(RemoteRun, HasItForSourcesThatWantToKnowWhenTheirQueueIsEmpty) {
  expect_same("scenarios/radio/shared.toml", Set{{"duration_s", "2.0"}});
  expect_same("scenarios/radio/delay.toml", Set{{"duration_s", "2.0"}});
}

}  // namespace
}  // namespace hearsay
