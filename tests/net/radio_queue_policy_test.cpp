// What a full queue does with packets, and what becomes of those that wait too long.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>

#include "sim/kernel/error.hpp"
#include "tests/net/bed.hpp"

namespace hearsay {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

constexpr double byte_a_second = 8.0;

// Text and fate of each packet at its receiver, in the order of the record.
std::vector<std::pair<std::string, std::string>> sizes_and_fates(const Bed& bed) {
  std::vector<std::pair<std::string, std::string>> found;
  for (const MessageRow& row : bed.simulation.record().messages()) {
    found.emplace_back(std::to_string(row.bytes), bed.fate_of(row));
  }
  return found;
}
std::vector<std::string> texts(const Bed& bed) {
  std::vector<std::string> found;
  for (const Heard& h : bed.heard) found.push_back(h.text);
  return found;
}
RadioOptions with(const QueueOptions& queue) { return {.rate_bps = byte_a_second, .queue = queue}; }

TEST(RadioQueuePolicy, DropNewRefusesWhoeverFindsTheQueueFull) {
  Bed bed(Topology::line(2), {.radio = with({.packets_max = 3})});
  bed.at(0_s, [&] {
    EXPECT_TRUE(bed.send(0, "a"));  // being sent
    EXPECT_TRUE(bed.send(0, "bb"));
    EXPECT_TRUE(bed.send(0, "ccc"));
    EXPECT_FALSE(bed.send(0, "dddd"));
  });
  bed.at(1500_ms, [&] {
    EXPECT_TRUE(bed.send(0, "eeeee"));
    EXPECT_FALSE(bed.send(0, "ffffff"));
  });
  bed.run();
  EXPECT_THAT(texts(bed), ElementsAre("a", "bb", "ccc", "eeeee"));
  EXPECT_EQ(bed.count(0, Fate::queue_full), 2u);
}

TEST(RadioQueuePolicy, DropOldestMakesRoomAtTheHeadButNotOnTheAir) {
  Bed bed(Topology::line(2),
          {.radio = with({.packets_max = 3, .policy = QueuePolicy::drop_oldest})});
  bed.at(0_s, [&] {
    for (const char* text : {"a", "bb", "ccc", "dddd", "eeeee"}) EXPECT_TRUE(bed.send(0, text));
  });
  bed.run();
  EXPECT_THAT(texts(bed), ElementsAre("a", "dddd", "eeeee"));
  EXPECT_THAT(sizes_and_fates(bed),
              ElementsAre(std::pair("2", "queue_full"), std::pair("3", "queue_full"),
                          std::pair("1", "delivered"), std::pair("4", "delivered"),
                          std::pair("5", "delivered")));
}

TEST(RadioQueuePolicy, DropOldestCannotMakeRoomWhereAllIsOnTheAir) {
  Bed bed(Topology::line(2),
          {.radio = with({.packets_max = 1, .policy = QueuePolicy::drop_oldest})});
  bed.at(0_s, [&] {
    EXPECT_TRUE(bed.send(0, "a"));
    EXPECT_FALSE(bed.send(0, "b"));
  });
  bed.run();
  EXPECT_THAT(texts(bed), ElementsAre("a"));
  EXPECT_EQ(bed.count(0, Fate::queue_full), 1u);
}

TEST(RadioQueuePolicy, BytesAreBoundedWithHeadersOfEveryFrame) {
  // Frames of at most 4 bytes and a header of 2: "aaaaa" takes 5 + 2·2 = 9 bytes.
  for (const std::uint64_t bytes_max : {17u, 18u}) {
    RadioOptions radio = with({.bytes_max = bytes_max});
    radio.header_bytes = 2;
    radio.mtu_bytes = 4;
    Bed bed(Topology::line(2), {.radio = radio});
    bed.at(0_s, [&] {
      EXPECT_TRUE(bed.send(0, "aaaaa"));  // being sent, and counted
      EXPECT_EQ(bed.send(0, "bbbbb"), bytes_max == 18);
      EXPECT_FALSE(bed.send(0, "ccccc"));
    });
    bed.run();
  }
}

TEST(RadioQueuePolicy, DropOldestDropsAsManyAsALargePacketNeeds) {
  Bed bed(Topology::line(2),
          {.radio = with({.bytes_max = 10, .policy = QueuePolicy::drop_oldest})});
  bed.at(0_s, [&] {
    for (const char* text : {"a", "bb", "ccc", "dddd"}) EXPECT_TRUE(bed.send(0, text));
    EXPECT_TRUE(bed.send(0, "eeeee"));        // 1 + 4 + 5: b and c go
    EXPECT_FALSE(bed.send(0, "ffffffffff"));  // 1 + 10: all that wait go, and it does not fit
  });
  bed.run();
  EXPECT_THAT(texts(bed), ElementsAre("a"));
  EXPECT_EQ(bed.count(0, Fate::queue_full), 5u);
}

TEST(RadioQueuePolicy, APacketLargerThanTheQueueIsBadInput) {
  RadioOptions radio = with({.bytes_max = 6});
  radio.header_bytes = 2;
  Bed bed(Topology::line(2), {.radio = radio});
  bed.at(0_s, [&] {
    EXPECT_TRUE(bed.send(0, "four"));
    try {
      bed.send(0, "fives");
      FAIL() << "nothing thrown";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(),
                  HasSubstr("7 bytes with headers does not fit into a queue of queue_bytes_max = "
                            "6"));
    }
  });
  bed.run();
  EXPECT_EQ(bed.radio->counts(0).packets, 1u);
}

TEST(RadioQueuePolicy, NewsTakesThePlaceOfWhatWaitsOnTheSameThing) {
  Bed bed(Topology::line(4), {.radio = with({.policy = QueuePolicy::replace})});
  const NameId other = bed.simulation.record().name("other");
  const auto send = [&](const char* text, NameId kind, AgentId to, std::uint64_t subject) {
    EXPECT_TRUE(bed.radio->send(
        1, {.kind = kind, .bytes = bytes_of(text), .receiver = to, .subject = subject}));
  };
  bed.at(0_s, [&] {
    send("air", bed.kind, no_agent, 1);  // being sent: not replaced
    send("old", bed.kind, no_agent, 1);
    send("kind", other, no_agent, 1);
    send("subject", bed.kind, no_agent, 2);
    send("receiver", bed.kind, 2, 1);
  });
  bed.at(1_s, [&] { send("new", bed.kind, no_agent, 1); });
  bed.at(2_s, [&] { send("newest", bed.kind, no_agent, 1); });
  bed.run();
  std::vector<std::string> at_2;
  for (const Heard& h : bed.heard) {
    if (h.receiver == 2) at_2.push_back(h.text);
  }
  EXPECT_THAT(at_2, ElementsAre("air", "newest", "kind", "subject", "receiver"));
  EXPECT_EQ(bed.count(1, Fate::replaced), 4u);  // two packets at two hearers
  const auto rows = bed.simulation.record().messages();
  EXPECT_EQ(bed.fate_of(rows[0]), "replaced");
  EXPECT_EQ(rows[0].arrived, Time::at(1_s));
  EXPECT_EQ(rows[0].sent, Time());
}

TEST(RadioQueuePolicy, NewsFindsItsPlaceInAFullQueueAndOthersDoNot) {
  Bed bed(Topology::line(2), {.radio = with({.packets_max = 3, .policy = QueuePolicy::replace})});
  const auto send = [&](const char* text, std::uint64_t subject) {
    return bed.radio->send(0, {.kind = bed.kind, .bytes = bytes_of(text), .subject = subject});
  };
  bed.at(0_s, [&] {
    EXPECT_TRUE(send("air", 0));
    EXPECT_TRUE(send("one", 1));
    EXPECT_TRUE(send("two", 2));
    EXPECT_FALSE(send("three", 3));
    EXPECT_TRUE(send("uno", 1));
    EXPECT_FALSE(send("aire", 0));  // what is on the air does not wait
  });
  bed.run();
  EXPECT_THAT(texts(bed), ElementsAre("air", "uno", "two"));
  EXPECT_EQ(bed.count(0, Fate::replaced), 1u);
  EXPECT_EQ(bed.count(0, Fate::queue_full), 2u);
}

TEST(RadioQueuePolicy, ReplacedBytesAreNotCountedTwice) {
  Bed bed(Topology::line(2), {.radio = with({.bytes_max = 12, .policy = QueuePolicy::replace})});
  const auto send = [&](const char* text, std::uint64_t subject) {
    return bed.radio->send(0, {.kind = bed.kind, .bytes = bytes_of(text), .subject = subject});
  };
  bed.at(0_s, [&] {
    EXPECT_TRUE(send("air", 0));
    EXPECT_TRUE(send("123456", 1));
    EXPECT_FALSE(send("1234", 2));
    EXPECT_TRUE(send("12", 1));
    EXPECT_TRUE(send("1234567", 2));
    EXPECT_FALSE(send("1", 3));
  });
  bed.run();
  EXPECT_THAT(texts(bed), ElementsAre("air", "12", "1234567"));
}

TEST(RadioQueuePolicy, WhatHasWaitedLongerThanItMayExpires) {
  Bed bed(Topology::line(2), {.radio = with({.wait_max = 5_s})});
  bed.at(0_s, [&] {
    bed.send(0, "12345");  // until 5 s
    bed.send(0, "1");      // waits exactly 5 s
    bed.send(0, "12");     // would wait 6 s
  });
  bed.at(1_s, [&] { bed.send(0, "1234"); });  // waits exactly 5 s
  bed.run();
  EXPECT_THAT(texts(bed), ElementsAre("12345", "1", "1234"));
  EXPECT_THAT(sizes_and_fates(bed),
              UnorderedElementsAre(std::pair("5", "delivered"), std::pair("1", "delivered"),
                                   std::pair("2", "expired"), std::pair("4", "delivered")));
  EXPECT_EQ(bed.radio->counts(0).begun, 3u);
}

TEST(RadioQueuePolicy, WhatHasExpiredLeavesItsRoomToOthers) {
  for (const QueuePolicy policy : {QueuePolicy::drop_new, QueuePolicy::replace}) {
    Bed bed(Topology::line(2),
            {.radio = with({.packets_max = 3, .policy = policy, .wait_max = 5_s})});
    const auto send = [&](const char* text, std::uint64_t subject) {
      return bed.radio->send(0, {.kind = bed.kind, .bytes = bytes_of(text), .subject = subject});
    };
    bed.at(0_s, [&] {
      EXPECT_TRUE(send("123456789", 0));  // until 9 s
      EXPECT_TRUE(send("one", 1));
      EXPECT_TRUE(send("two", 2));
    });
    bed.at(4_s, [&] { EXPECT_EQ(send("uno", 1), policy == QueuePolicy::replace); });
    // Now "two" has expired, behind the news on 1 that is in front of it.
    bed.at(8_s, [&] { EXPECT_TRUE(send("three", 3)); });
    bed.run();
    if (policy == QueuePolicy::replace) {
      EXPECT_THAT(texts(bed), ElementsAre("123456789", "uno", "three"));
      EXPECT_EQ(bed.count(0, Fate::expired), 1u);
    } else {
      EXPECT_THAT(texts(bed), ElementsAre("123456789", "three"));
      EXPECT_EQ(bed.count(0, Fate::expired), 2u);
    }
  }
}

// The queue of one sender as plainly as can be said: everything is looked at each time.
class PlainQueue {
 public:
  explicit PlainQueue(const RadioOptions& options) : options_(options) {}

  struct Item {
    std::size_t number;
    std::int64_t bytes, sent_ns;
    std::uint64_t subject;
  };
  std::vector<Fate> fates;
  std::int64_t waited_ns = 0;

  void send(const Item& item) {
    advance(item.sent_ns);
    fates.push_back(Fate::in_flight_at_end);
    if (waiting_.empty() && free_at_ns_ <= item.sent_ns) return begin(item, item.sent_ns);
    expire(item.sent_ns);
    if (options_.queue.policy == QueuePolicy::replace) {
      for (Item& old : waiting_) {
        if (old.subject != item.subject) continue;
        fates[old.number] = Fate::replaced;
        old = item;
        return;
      }
    }
    const bool sending = free_at_ns_ > item.sent_ns;
    const auto full = [&] {
      std::int64_t bytes = item.bytes + (sending ? on_air_bytes_ : 0);
      for (const Item& old : waiting_) bytes += old.bytes;
      return waiting_.size() + (sending ? 1 : 0) >= options_.queue.packets_max ||
             (options_.queue.bytes_max &&
              bytes > static_cast<std::int64_t>(*options_.queue.bytes_max));
    };
    while (options_.queue.policy == QueuePolicy::drop_oldest && full() && !waiting_.empty()) {
      fates[waiting_.front().number] = Fate::queue_full;
      waiting_.pop_front();
    }
    if (full()) {
      fates.back() = Fate::queue_full;
    } else {
      waiting_.push_back(item);
    }
  }
  // To just before `now`.
  void advance(std::int64_t now_ns) {
    while (!waiting_.empty() && free_at_ns_ < now_ns) {
      expire(free_at_ns_);
      if (waiting_.empty()) return;
      const Item first = waiting_.front();
      waiting_.pop_front();
      begin(first, free_at_ns_);
    }
  }

 private:
  void expire(std::int64_t now_ns) {
    if (!options_.queue.wait_max) return;
    std::erase_if(waiting_, [&](const Item& item) {
      const bool old = now_ns - item.sent_ns > options_.queue.wait_max->nanoseconds();
      if (old) fates[item.number] = Fate::expired;
      return old;
    });
  }
  void begin(const Item& item, std::int64_t now_ns) {
    fates[item.number] = Fate::delivered;
    waited_ns += now_ns - item.sent_ns;
    on_air_bytes_ = item.bytes;
    free_at_ns_ = now_ns + item.bytes * 1'000'000;
  }

  RadioOptions options_;
  std::deque<Item> waiting_;
  std::int64_t on_air_bytes_ = 0;
  std::int64_t free_at_ns_ = 0;
};

TEST(RadioQueuePolicy, EveryCombinationDoesWhatAPlainQueueDoes) {
  std::map<Fate, int> met;
  std::uint64_t seed = 0;
  for (const QueuePolicy policy :
       {QueuePolicy::drop_new, QueuePolicy::drop_oldest, QueuePolicy::replace}) {
    for (const std::uint32_t packets_max : {1u, 2u, 5u, 1000u}) {
      for (const std::uint64_t bytes_max : {0u, 30u, 90u}) {
        for (const Duration wait_max : {Duration(), 15_ms, 60_ms}) {
          SCOPED_TRACE(++seed);
          QueueOptions queue{.packets_max = packets_max, .policy = policy};
          if (bytes_max > 0) queue.bytes_max = bytes_max;
          if (wait_max > Duration()) queue.wait_max = wait_max;
          // A millisecond a byte.
          const RadioOptions radio{.rate_bps = 8000.0, .header_bytes = 2, .queue = queue};
          Bed bed(Topology::line(2), {.radio = radio});
          PlainQueue plain(radio);
          Stream draw(seed, Purpose("load"), Entity{0});
          Duration time;
          std::map<std::int64_t, std::size_t> number;
          for (std::size_t n = 0; n < 150; ++n) {
            time = time +
                   Duration::nanoseconds(1 + static_cast<std::int64_t>(
                                                 draw.below(n % 50 < 25 ? 12 : 30) * 1'000'000 / 2 +
                                                 draw.below(499'999)));
            const std::size_t bytes = draw.below(20);
            const std::uint64_t subject = draw.below(4);
            number[time.nanoseconds()] = n;
            bed.at(time, [&bed, bytes, subject] {
              const std::string text(bytes, 'x');
              bed.radio->send(0, {.kind = bed.kind, .bytes = bytes_of(text), .subject = subject});
            });
            plain.send({n, static_cast<std::int64_t>(bytes) + 2, time.nanoseconds(), subject});
          }
          plain.advance(INT64_MAX);
          bed.run();
          std::size_t rows = 0;
          for (const MessageRow& row : bed.simulation.record().messages()) {
            const std::size_t n = number.at(row.sent.nanoseconds());
            ASSERT_EQ(bed.fate_of(row), to_string(plain.fates[n])) << "packet " << n;
            ++met[plain.fates[n]];
            ++rows;
          }
          EXPECT_EQ(rows, 150u);
          EXPECT_EQ(bed.radio->counts(0).expected, 150u);
          EXPECT_EQ(bed.radio->counts(0).queue_delay.nanoseconds(), plain.waited_ns);
        }
      }
    }
  }
  for (const Fate fate : {Fate::delivered, Fate::queue_full, Fate::replaced, Fate::expired}) {
    EXPECT_GT(met[fate], 200) << to_string(fate) << " is hardly put to the test";
  }
}

}  // namespace
}  // namespace hearsay
