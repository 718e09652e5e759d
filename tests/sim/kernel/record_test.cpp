#include "sim/kernel/record.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Keeps the bytes themselves, so that tests see what a digest sees.
class Bytes : public DigestSink {
 public:
  void update(std::span<const std::byte> bytes) override {
    all.insert(all.end(), bytes.begin(), bytes.end());
    largest = std::max(largest, bytes.size());
  }
  std::vector<std::byte> all;
  std::size_t largest = 0;
};

// The run's bytes of whatever `fill` records.
template <class Fill>
std::vector<std::byte> run_bytes(Fill fill, std::vector<std::byte>* ledger = nullptr) {
  Bytes run;
  Bytes beside;
  Record record({.digest = &run, .ledger_digest = &beside});
  fill(record);
  record.finish();
  if (ledger != nullptr) *ledger = beside.all;
  return run.all;
}

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

TEST(Record, KeepsWhatWasRecordedInOrder) {
  Record record({.keep_messages = true});
  record.agent(0, "uav1", "static-gaussian");
  const NameId error = record.name("rms_error_m");
  const NameId target = record.name("target");
  record.series(Time::at(1_s), 0, target, error, 2.5);
  record.series(Time::at(2_s), 0, target, error, nan);
  record.scalar(0, error, 1.5);
  record.message(
      {Time::at(1_s), Time::at(2_s), 0, 1, record.name("belief"), 60, record.name("lost")});
  record.event(Time::at(3_s), no_agent, "note", "nothing to see");
  record.finish();

  ASSERT_EQ(record.agents().size(), 1u);
  EXPECT_EQ(record.agents()[0].name, "uav1");
  EXPECT_EQ(record.agents()[0].kind, "static-gaussian");
  ASSERT_EQ(record.series().size(), 2u);
  EXPECT_EQ(record.series()[0].time, Time::at(1_s));
  EXPECT_EQ(record.series()[0].value, 2.5);
  EXPECT_EQ(record.text(record.series()[0].subject), "target");
  EXPECT_TRUE(std::isnan(record.series()[1].value));
  ASSERT_EQ(record.scalars().size(), 1u);
  EXPECT_EQ(record.scalars()[0].value, 1.5);
  ASSERT_EQ(record.messages().size(), 1u);
  EXPECT_EQ(record.text(record.messages()[0].fate), "lost");
  EXPECT_EQ(record.messages()[0].bytes, 60u);
  ASSERT_EQ(record.events().size(), 1u);
  EXPECT_EQ(record.text(record.events()[0].kind), "note");
  EXPECT_EQ(record.events()[0].detail, "nothing to see");
}

TEST(Record, EqualTextsAreEqualNames) {
  Record record({});
  EXPECT_EQ(record.name("a"), 0);
  EXPECT_EQ(record.name("b"), 1);
  EXPECT_EQ(record.name("a"), 0);
  EXPECT_EQ(record.text(1), "b");
  EXPECT_EQ(record.names().size(), 2u);
}

TEST(Record, RefusesMoreNamesThanItHasIdsFor) {
  Record record({});
  for (int i = 0; i < 65'535; ++i) (void)record.name(std::to_string(i));
  EXPECT_EQ(record.name("0"), 0);
  EXPECT_THROW((void)record.name("one more"), BrokenInvariant);
}

TEST(Record, ARowIsItsTagAndItsFieldsInLittleEndian) {
  const auto bytes = run_bytes([](Record& record) { record.scalar(-1, record.name("a"), 1.0); });
  // FNV-1a of "a" is af63dc4c8601ec8c; 1.0 is 3ff0000000000000.
  EXPECT_EQ(bytes, bytes_of({'C',  0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff,  //
                             0x8c, 0xec, 0x01, 0x86, 0x4c, 0xdc, 0x63, 0xaf,        //
                             0,    0,    0,    0,    0,    0,    0xf0, 0x3f}));
}

TEST(Record, TextGoesInWithItsLength) {
  const auto bytes = run_bytes([](Record& record) { record.agent(2, "ab", "c"); });
  EXPECT_EQ(bytes, bytes_of({'A', 2, 0, 0, 0, 0, 0, 0, 0,  2, 0, 0, 0, 0, 0, 0, 0, 'a', 'b',  //
                             1,   0, 0, 0, 0, 0, 0, 0, 'c'}));
}

TEST(Record, ZerosOfBothSignsAreOneAndSoAreAllNans) {
  const auto with = [](double value) {
    return run_bytes([&](Record& record) { record.scalar(0, record.name("x"), value); });
  };
  EXPECT_EQ(with(0.0), with(-0.0));
  EXPECT_EQ(with(nan), with(-nan));
  EXPECT_EQ(with(nan), with(std::nan("77")));
  EXPECT_NE(with(0.0), with(std::numeric_limits<double>::denorm_min()));
  EXPECT_NE(with(1.0), with(-1.0));
  EXPECT_NE(with(nan), with(0.0));
}

TEST(Record, EveryFieldOfEveryRowChangesTheBytes) {
  const auto message = [](const MessageRow& row) {
    return run_bytes([&](Record& record) {
      (void)record.name("belief");
      (void)record.name("lost");
      (void)record.name("other");
      record.message(row);
    });
  };
  const MessageRow row{Time::at(1_s), Time::at(2_s), 0, 1, 0, 60, 1};
  std::vector<MessageRow> changed(7, row);
  changed[0].sent = Time::at(3_s);
  changed[1].arrived = Time::at(3_s);
  changed[2].sender = 5;
  changed[3].receiver = 5;
  changed[4].kind = 2;
  changed[5].bytes = 61;
  changed[6].fate = 2;
  for (const MessageRow& other : changed) EXPECT_NE(message(row), message(other));

  const auto series = [](Time time, AgentId agent, const char* subject, const char* name,
                         double value) {
    return run_bytes([&](Record& record) {
      record.series(time, agent, record.name(subject), record.name(name), value);
    });
  };
  const auto base = series(Time::at(1_s), 0, "a", "b", 1.0);
  EXPECT_NE(base, series(Time::at(2_s), 0, "a", "b", 1.0));
  EXPECT_NE(base, series(Time::at(1_s), 1, "a", "b", 1.0));
  EXPECT_NE(base, series(Time::at(1_s), 0, "b", "a", 1.0));
  EXPECT_NE(base, series(Time::at(1_s), 0, "a", "b", 2.0));

  const auto event = [](Time time, AgentId agent, const char* kind, const char* detail) {
    return run_bytes([&](Record& record) { record.event(time, agent, kind, detail); });
  };
  const auto first = event(Time::at(1_s), 0, "k", "d");
  EXPECT_NE(first, event(Time::at(2_s), 0, "k", "d"));
  EXPECT_NE(first, event(Time::at(1_s), 1, "k", "d"));
  EXPECT_NE(first, event(Time::at(1_s), 0, "l", "d"));
  EXPECT_NE(first, event(Time::at(1_s), 0, "k", "e"));
}

TEST(Record, TheLedgerChangesNothingInTheDigestOfTheRun) {
  const auto fill = [](bool ledger) {
    return [ledger](Record& record) {
      if (ledger) {
        const NameId weight = record.name("multiplicity_mean");
        record.scalar(0, weight, 3.0, Origin::ledger);
        record.series(Time::at(1_s), 0, record.name("x"), weight, 1.0, Origin::ledger);
      }
      record.series(Time::at(1_s), 0, record.name("target"), record.name("rms_error_m"), 2.0);
    };
  };
  std::vector<std::byte> with;
  std::vector<std::byte> without;
  EXPECT_EQ(run_bytes(fill(true), &with), run_bytes(fill(false), &without));
  EXPECT_FALSE(with.empty());
  EXPECT_TRUE(without.empty());
}

TEST(Record, MessagesAreDigestedEvenIfTheyAreNotKept) {
  std::vector<std::byte> digested[2];
  for (const bool keep : {false, true}) {
    Bytes bytes;
    Record record({.keep_messages = keep, .digest = &bytes});
    record.message(
        {Time::at(1_s), Time::at(2_s), 0, 1, record.name("belief"), 60, record.name("lost")});
    record.finish();
    EXPECT_EQ(record.messages().size(), keep ? 1u : 0u);
    digested[keep ? 1 : 0] = bytes.all;
  }
  EXPECT_FALSE(digested[0].empty());
  EXPECT_EQ(digested[0], digested[1]);
}

TEST(Record, EventsBeyondTheLimitAreDigestedAndCounted) {
  std::vector<std::byte> digested[2];
  for (const std::size_t limit : {2u, 100u}) {
    Bytes bytes;
    Record record({.events_max = limit, .digest = &bytes});
    for (int i = 0; i < 5; ++i) record.event(Time::at(1_s * i), 0, "kind", std::to_string(i));
    record.finish();
    EXPECT_EQ(record.events().size(), std::min<std::size_t>(limit, 5));
    EXPECT_EQ(record.events_not_kept(), limit == 2 ? 3u : 0u);
    digested[limit == 2 ? 0 : 1] = bytes.all;
  }
  EXPECT_EQ(digested[0], digested[1]);
}

TEST(Record, ManyRowsReachTheDigestInPiecesWithoutLoss) {
  Bytes bytes;
  Record record({.digest = &bytes});
  const NameId name = record.name("x");
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i) {
    values.push_back(i + 0.5);
    record.scalar(0, name, values.back());
  }
  record.event(Time(), 0, "long", std::string(10'000, 'y'));
  record.finish();
  ASSERT_EQ(bytes.all.size(), 1000u * 25 + 1 + 8 + 8 + 8 + 8 + 10'000);
  EXPECT_LE(bytes.largest, 4096u);
  for (int i = 0; i < 1000; ++i) {
    double value = 0;
    std::memcpy(&value, bytes.all.data() + i * 25 + 17, sizeof value);
    EXPECT_EQ(value, values[i]);
  }
}

TEST(Record, RowsOfAllSizesCrossTheEndsOfPiecesUnchanged) {
  // The bytes as the header says them, one at a time.
  std::vector<std::byte> expected;
  const auto number = [&](std::uint64_t value) {
    for (int i = 0; i < 8; ++i) expected.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
  };
  const auto text = [&](const std::string& value) {
    number(value.size());
    for (const char c : value) expected.push_back(static_cast<std::byte>(c));
  };
  constexpr std::uint64_t hash_of_a = 0xaf63dc4c8601ec8c;
  Bytes bytes;
  Record record({.digest = &bytes});
  const NameId a = record.name("a");
  for (int n = 0; n < 2000; ++n) {
    const auto u = static_cast<std::uint64_t>(n);
    record.message({Time::at(1_s * n), Time::at(1_s * n + 1_ns), n, -n, a, 7, a});
    expected.push_back(std::byte{'M'});
    for (const std::uint64_t value : {u * 1'000'000'000, u * 1'000'000'000 + 1, u, 0 - u, hash_of_a,
                                      std::uint64_t{7}, hash_of_a}) {
      number(value);
    }
    if (n % 3 != 0) continue;
    const std::string detail(static_cast<std::size_t>(n) % 97 * 67, 'x');
    record.event(Time::at(1_ns), n, "a", detail);
    expected.push_back(std::byte{'E'});
    for (const std::uint64_t value : {std::uint64_t{1}, u, hash_of_a}) number(value);
    text(detail);
  }
  record.finish();
  EXPECT_EQ(bytes.all, expected);
  EXPECT_EQ(bytes.largest, 4096u);
}

TEST(Record, TakesNothingAfterItIsFinished) {
  Record record({});
  const NameId name = record.name("x");
  record.finish();
  EXPECT_THROW(record.scalar(0, name, 1.0), BrokenInvariant);
  EXPECT_THROW(record.event(Time(), 0, "late", ""), BrokenInvariant);
  EXPECT_THROW(record.finish(), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
