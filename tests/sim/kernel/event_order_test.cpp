#include "sim/kernel/event_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <queue>
#include <vector>

#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

bool operator==(const EventKey& a, const EventKey& b) {
  return a.time_ns == b.time_ns && a.order == b.order;
}

struct Later {
  bool operator()(const EventKey& a, const EventKey& b) const {
    return a.time_ns != b.time_ns ? a.time_ns > b.time_ns : a.order > b.order;
  }
};

// The order beside a heap of the standard library: both must hand out the same keys.
class Pair {
 public:
  // Of keys of one instant those of a lower phase (0 … 7) come first, then the older ones.
  void push(std::int64_t time_ns, std::uint64_t phase = 3) {
    const EventKey key{time_ns, (phase << 61) | next_++};
    order_.push(key);
    heap_.push(key);
  }

  bool pop() {
    EXPECT_EQ(order_.size(), heap_.size());
    const EventKey expected = heap_.top();
    heap_.pop();
    const bool seen = order_.front() == expected;
    const EventKey key = order_.pop();
    now_ns_ = key.time_ns;
    EXPECT_TRUE(seen && key == expected)
        << "key " << popped_ << " is " << key.time_ns << " ns, " << key.order << ", not "
        << expected.time_ns << " ns, " << expected.order;
    ++popped_;
    return seen && key == expected;
  }

  void pop_all() {
    while (!heap_.empty()) {
      if (!pop()) return;
    }
    EXPECT_EQ(order_.size(), 0u);
  }

  void retain(const std::function<bool(const EventKey&)>& keep) {
    order_.retain(keep);
    std::vector<EventKey> kept;
    for (; !heap_.empty(); heap_.pop()) {
      if (keep(heap_.top())) kept.push_back(heap_.top());
    }
    for (const EventKey& key : kept) heap_.push(key);
    EXPECT_EQ(order_.size(), heap_.size());
  }

  std::int64_t now_ns() const { return now_ns_; }
  std::size_t size() const { return heap_.size(); }

 private:
  EventOrder order_;
  std::priority_queue<EventKey, std::vector<EventKey>, Later> heap_;
  std::uint64_t next_ = 0;
  std::uint64_t popped_ = 0;
  std::int64_t now_ns_ = 0;
};

Stream draws(std::uint64_t n) { return Stream(n, Purpose("event order test"), Entity{0}); }

// `pending` keys; then each one that comes out is followed by another, ahead_ns(stream) later.
template <class Ahead>
void hold(Pair& pair, int pending, int turns, Stream stream, const Ahead& ahead_ns) {
  for (int i = 0; i < pending; ++i) pair.push(ahead_ns(stream), stream.below(8));
  for (int i = 0; i < turns; ++i) {
    if (!pair.pop()) return;
    pair.push(pair.now_ns() + ahead_ns(stream), stream.below(8));
  }
  pair.pop_all();
}

std::int64_t exponential_ns(Stream& stream) {
  return static_cast<std::int64_t>(stream.exponential(1.0) * 1e9);
}

TEST(EventOrder, AgreesWithAHeapWhateverTheNumberOfKeys) {
  for (const int pending : {1, 2, 47, 48, 49, 96, 1000, 30'000}) {
    SCOPED_TRACE(pending);
    Pair pair;
    hold(pair, pending, 3 * pending + 1000, draws(1), exponential_ns);
  }
}

TEST(EventOrder, AgreesWithAHeapOnWholeSeconds) {
  Pair pair;
  hold(pair, 20'000, 100'000, draws(2),
       [](Stream& stream) { return exponential_ns(stream) / second_ns * second_ns; });
}

TEST(EventOrder, AgreesWithAHeapOnBimodalSpans) {
  Pair pair;
  hold(pair, 10'000, 100'000, draws(3), [](Stream& stream) {
    return static_cast<std::int64_t>(stream.bernoulli(0.9) ? stream.below(1000)
                                                           : stream.below(100 * second_ns));
  });
}

TEST(EventOrder, AgreesWithAHeapOnSpansOverManyDecades) {
  Pair pair;
  hold(pair, 5000, 50'000, draws(4), [](Stream& stream) {
    return static_cast<std::int64_t>(std::uint64_t{1} << stream.below(50));
  });
}

TEST(EventOrder, AgreesWithAHeapOnRegularPeriods) {
  Pair pair;
  hold(pair, 3000, 60'000, draws(5), [](Stream&) { return second_ns; });
}

TEST(EventOrder, ABurstIntoAWideBucketIsSpreadAnew) {
  Pair pair;
  Stream stream = draws(6);
  // A quiet window of hours …
  for (int i = 0; i < 100; ++i) pair.push(i * 3600 * second_ns);
  ASSERT_TRUE(pair.pop());
  // … into whose first bucket a hundred thousand keys fall, in falling order of time at first.
  for (int i = 0; i < 20'000; ++i) pair.push(second_ns - i);
  for (int i = 0; i < 80'000; ++i) {
    pair.push(static_cast<std::int64_t>(stream.below(10 * second_ns)));
    if (i % 4 == 0) {
      ASSERT_TRUE(pair.pop());
    }
  }
  pair.pop_all();
}

TEST(EventOrder, KeysMayComeInBeforeTheLastOneThatCameOut) {
  Pair pair;
  Stream stream = draws(7);
  for (int i = 0; i < 20'000; ++i) {
    pair.push(static_cast<std::int64_t>(stream.below(1'000'000)) - 500'000);
    if (i % 3 == 0) {
      ASSERT_TRUE(pair.pop());
    }
  }
  pair.pop_all();
}

TEST(EventOrder, TheLastInstantOfAllIsAnInstantLikeOthers) {
  Pair pair;
  Stream stream = draws(8);
  for (int i = 0; i < 1000; ++i) {
    pair.push(i % 2 == 0 ? INT64_MAX : static_cast<std::int64_t>(stream.below(1000)));
    pair.push(INT64_MAX - static_cast<std::int64_t>(stream.below(3)));
    pair.push(INT64_MIN + static_cast<std::int64_t>(stream.below(3)));
    if (i % 5 == 0) {
      ASSERT_TRUE(pair.pop());
    }
  }
  pair.pop_all();
}

TEST(EventOrder, AtOneInstantForeverItNeedsNoMoreRoom) {
  Pair pair;
  for (int i = 0; i < 10; ++i) pair.push(0);
  for (int i = 0; i < 100'000; ++i) {
    ASSERT_TRUE(pair.pop());
    pair.push(0);
  }
  pair.pop_all();
}

TEST(EventOrder, KeysAreThrownOutWhereverTheyStand) {
  Pair pair;
  Stream stream = draws(9);
  for (int round = 0; round < 20; ++round) {
    for (int i = 0; i < 2000; ++i) pair.push(pair.now_ns() + exponential_ns(stream));
    for (int i = 0; i < 500; ++i) {
      ASSERT_TRUE(pair.pop());
      pair.push(pair.now_ns() + exponential_ns(stream) / 1000);
    }
    pair.retain([round](const EventKey& key) { return key.order % 3 != round % 3u; });
  }
  pair.retain([](const EventKey&) { return false; });
  EXPECT_EQ(pair.size(), 0u);
  pair.push(5);
  pair.pop_all();
}

TEST(EventOrder, WhatIsAheadIsWhatComesOutNext) {
  EventOrder order;
  Stream stream = draws(10);
  for (std::uint64_t i = 0; i < 5000; ++i) order.push({exponential_ns(stream), i});
  int told = 0;
  while (order.size() > 0) {
    (void)order.front();
    if (!order.looks_ahead()) {
      order.pop();
      continue;
    }
    ++told;
    EXPECT_FALSE(order.looks_ahead()) << "told twice";
    const EventOrder::Ahead ahead = order.ahead();
    const std::vector<EventKey> next(ahead.next.begin(), ahead.next.end());
    std::vector<EventKey> after(ahead.after.begin(), ahead.after.end());
    for (const EventKey& key : next) ASSERT_TRUE(order.pop() == key);
    std::sort(after.begin(), after.end());
    if (!after.empty()) {
      // The bucket may have more than is told of it.
      EXPECT_FALSE(after.front() < order.front());
    }
  }
  EXPECT_GT(told, 100);
}

}  // namespace
}  // namespace hearsay
