#include "sim/kernel/event_queue.hpp"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

// The queue beside an ordered map: both are asked the same, and must agree on every answer.
class Pair {
 public:
  int push(Time time, Phase phase) {
    const int number = next_number_++;
    const EventId id = queue_.push(time, phase, [this, number] { called_ = number; });
    reference_[{time, phase, number}] = id;
    ids_.push_back({time, phase, id});
    EXPECT_TRUE(known_.insert(id.name).second) << "an id came twice";
    return number;
  }

  // Returns what the queue said.
  bool cancel(int number) {
    const auto& [time, phase, id] = ids_[number];
    const bool expected = reference_.erase({time, phase, number}) == 1;
    const bool said = queue_.cancel(id);
    EXPECT_EQ(said, expected) << "cancelling event " << number;
    return said;
  }

  // False if something differs.
  bool pop() {
    const auto [time, phase, number] = reference_.begin()->first;
    reference_.erase(reference_.begin());
    EXPECT_EQ(queue_.next_time(), time);
    EventQueue::Event event = queue_.pop();
    called_ = -1;
    event.callback();
    now_ = event.time;
    EXPECT_EQ(event.time, time);
    EXPECT_EQ(event.phase, phase);
    EXPECT_EQ(called_, number);
    EXPECT_EQ(queue_.size(), reference_.size());
    EXPECT_EQ(queue_.empty(), reference_.empty());
    return called_ == number && queue_.size() == reference_.size();
  }

  void pop_all() {
    while (!reference_.empty()) {
      if (!pop()) return;
    }
  }

  Time now() const { return now_; }
  std::size_t size() const { return reference_.size(); }
  int pushed() const { return next_number_; }

 private:
  EventQueue queue_;
  std::map<std::tuple<Time, Phase, int>, EventId> reference_;
  std::vector<std::tuple<Time, Phase, EventId>> ids_;
  std::set<std::uint64_t> known_;
  int next_number_ = 0;
  int called_ = -1;
  Time now_;
};

Stream draws(std::uint64_t n) { return Stream(n, Purpose("event queue test"), Entity{0}); }

Phase some_phase(Stream& stream) { return static_cast<Phase>(stream.below(5)); }

TEST(EventQueue, EventsComeInOrderOfTime) {
  Pair pair;
  Stream stream = draws(1);
  for (int i = 0; i < 5000; ++i) {
    pair.push(Time::nanoseconds(static_cast<std::int64_t>(stream.below(1'000'000))), Phase::act);
  }
  pair.pop_all();
}

TEST(EventQueue, EventsOfOneInstantComeInOrderOfPhaseAndThenOfInsertion) {
  Pair pair;
  Stream stream = draws(2);
  for (int i = 0; i < 3000; ++i) {
    pair.push(Time::at(Duration::seconds(static_cast<double>(stream.below(3)))),
              some_phase(stream));
  }
  pair.pop_all();
}

TEST(EventQueue, AHoldLoadAgreesWithAReferenceEventByEvent) {
  Pair pair;
  Stream stream = draws(3);
  const auto ahead = [&] { return Duration::seconds(stream.exponential(1.0)); };
  for (int i = 0; i < 1000; ++i) pair.push(Time::at(ahead()), some_phase(stream));
  for (int i = 0; i < 20'000 && pair.pop(); ++i) {
    pair.push(pair.now() + ahead(), some_phase(stream));
  }
  pair.pop_all();
}

TEST(EventQueue, ALoadOnWholeSecondsAgreesWithAReference) {
  Pair pair;
  Stream stream = draws(4);
  for (int i = 0; i < 2000; ++i) pair.push(Time::at(1_s), Phase::act);
  for (int i = 0; i < 20'000 && pair.pop(); ++i) {
    pair.push(pair.now() + 1_s * static_cast<std::int64_t>(stream.below(3)), Phase::act);
  }
  pair.pop_all();
}

TEST(EventQueue, ABimodalLoadAgreesWithAReference) {
  Pair pair;
  Stream stream = draws(5);
  const auto ahead = [&] {
    return stream.bernoulli(0.9) ? Duration::seconds(stream.uniform(0, 1e-3))
                                 : Duration::seconds(stream.uniform(100, 1000));
  };
  for (int i = 0; i < 1000; ++i) pair.push(Time::at(ahead()), some_phase(stream));
  for (int i = 0; i < 20'000 && pair.pop(); ++i) pair.push(pair.now() + ahead(), Phase::update);
  pair.pop_all();
}

TEST(EventQueue, ACancellingLoadAgreesWithAReference) {
  Pair pair;
  Stream stream = draws(6);
  for (int i = 0; i < 500; ++i) {
    pair.push(Time::at(Duration::seconds(stream.exponential(1.0))), Phase::act);
  }
  for (int i = 0; i < 30'000; ++i) {
    if (pair.size() > 0 && !pair.pop()) return;
    pair.push(pair.now() + Duration::seconds(stream.exponential(1.0)), some_phase(stream));
    // A time-out three seconds ahead that is taken back, and any event of any age.
    const int timeout = pair.push(pair.now() + 3_s, Phase::act);
    if (stream.bernoulli(0.9)) pair.cancel(timeout);
    if (stream.bernoulli(0.3)) pair.cancel(static_cast<int>(stream.below(pair.pushed())));
  }
  pair.pop_all();
}

TEST(EventQueue, CancellingNearlyEverythingLeavesTheRestInOrder) {
  Pair pair;
  Stream stream = draws(7);
  for (int i = 0; i < 10'000; ++i) {
    pair.push(Time::nanoseconds(static_cast<std::int64_t>(stream.below(1000))), Phase::act);
  }
  for (int i = 0; i < 10'000; ++i) {
    if (i % 100 != 0) pair.cancel(i);
  }
  EXPECT_EQ(pair.size(), 100u);
  pair.pop_all();
}

TEST(EventQueue, AnIdStaysUniqueAfterItsPlaceIsUsedAgain) {
  EventQueue queue;
  const EventId first = queue.push(Time::at(1_s), Phase::act, [] {});
  (void)queue.pop();
  EXPECT_FALSE(queue.cancel(first));
  const EventId second = queue.push(Time::at(2_s), Phase::act, [] {});
  EXPECT_EQ(second.name & EventQueue::pending_max,
            first.name & EventQueue::pending_max);  // else this test tests nothing
  EXPECT_FALSE(queue.cancel(first));
  EXPECT_EQ(queue.size(), 1u);
  EXPECT_TRUE(queue.cancel(second));
  EXPECT_FALSE(queue.cancel(second));
  EXPECT_TRUE(queue.empty());
}

TEST(EventQueue, CancellingNoEventDoesNothing) {
  EventQueue queue;
  EXPECT_FALSE(queue.cancel(EventId()));
  (void)queue.push(Time(), Phase::act, [] {});
  EXPECT_FALSE(queue.cancel(EventId()));
  EXPECT_EQ(queue.size(), 1u);
}

TEST(EventQueue, ACancelledCallbackIsDestroyedAtOnce) {
  EventQueue queue;
  const auto held = std::make_shared<int>(0);
  const EventId id = queue.push(Time::at(1_s), Phase::act, [held] {});
  EXPECT_EQ(held.use_count(), 2);
  queue.cancel(id);
  EXPECT_EQ(held.use_count(), 1);
}

// Cancels another event when it is destroyed, as a callback that owns a process does.
struct Canceller {
  EventQueue* queue = nullptr;
  EventId other;
  Canceller(EventQueue* q, EventId o) : queue(q), other(o) {}
  Canceller(Canceller&& from) noexcept
      : queue(std::exchange(from.queue, nullptr)), other(from.other) {}
  Canceller& operator=(Canceller&&) = delete;
  ~Canceller() {
    if (queue == nullptr) return;
    queue->cancel(other);
    for (int i = 0; i < 100; ++i) (void)queue->push(Time::at(3_s), Phase::act, [] {});
  }
  void operator()() {}
};

TEST(EventQueue, ACallbackMayComeBackToTheQueueWhenItIsDestroyed) {
  EventQueue queue;
  const EventId first = queue.push(Time::at(1_s), Phase::act, [] {});
  const EventId second = queue.push(Time::at(2_s), Phase::act, Canceller(&queue, first));
  EXPECT_TRUE(queue.cancel(second));
  EXPECT_EQ(queue.size(), 100u);
  EXPECT_EQ(queue.next_time(), Time::at(3_s));
}

TEST(EventQueue, AnEmptyQueueHasNoFirstEvent) {
  EventQueue queue;
  EXPECT_THROW((void)queue.pop(), BrokenInvariant);
  EXPECT_THROW((void)queue.next_time(), BrokenInvariant);
  EXPECT_THROW((void)queue.push(Time(), Phase::act, Callback()), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
