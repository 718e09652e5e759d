#include "net/live/messages.hpp"

#include <gtest/gtest.h>
#include <hearsay/idl/live.h>

#include <cstring>
#include <limits>

#include "sim/kernel/error.hpp"
#include "tests/net/live/cyclone.hpp"

namespace hearsay::live {
namespace {

constexpr Purpose content("live messages");
constexpr int draws = 100;

template <class T>
Bytes encoded(const T& message) {
  Bytes bytes;
  encode(message, bytes);
  return bytes;
}

bool equal(const gaussian::Belief& a, const gaussian::Belief& b) {
  return a.xi == b.xi && a.omega == b.omega;
}

Hello some_hello(Stream& random) {
  return {.protocol = word(random),
          .agent = word(random),
          .process = random.bits(),
          .scenario = some_text(random, random.below(40)),
          .version = some_text(random, random.below(9)),
          .remembers = random.bernoulli(0.5)};
}
Welcome some_welcome(Stream& random) {
  return {.agent = word(random),
          .process = random.bits(),
          .accepted = random.bernoulli(0.5),
          .lockstep = random.bernoulli(0.5),
          .seed = random.bits(),
          .now_ns = stamp(random),
          .speed = random.normal(),
          .reason = some_text(random, random.below(100))};
}
Frame some_frame(Stream& random) {
  Frame frame{.agent = word(random), .number = random.bits(), .content = {}};
  frame.content.resize(random.below(100));
  for (std::byte& octet : frame.content) octet = static_cast<std::byte>(random.bits());
  return frame;
}
Clock some_clock(Stream& random) {
  return {.now_ns = stamp(random),
          .end_ns = stamp(random),
          .speed = random.normal(),
          .state = static_cast<Clock::State>(random.below(3)),
          .reason = some_text(random, random.below(30))};
}
Measurement some_measurement(Stream& random) {
  return {.agent = word(random),
          .subject = word(random),
          .number = random.bits(),
          .now_ns = stamp(random),
          .information = some_belief(random, 1 + static_cast<int>(random.below(6)))};
}
Truth some_truth(Stream& random) {
  Truth truth{.now_ns = stamp(random), .subject = word(random), .state = {}};
  truth.state.resize(random.below(7));
  for (double& value : truth.state) value = random.normal();
  return truth;
}
Report some_report(Stream& random) {
  Report report{.agent = word(random),
                .now_ns = stamp(random),
                .last = random.bernoulli(0.5),
                .missed = random.bits(),
                .counts = {random.bits(), random.bits(), random.bits(), random.bits(),
                           random.bits(), random.normal()},
                .beliefs = {},
                .rows = {}};
  for (std::uint64_t i = random.below(4); i-- > 0;) {
    const int n = 1 + static_cast<int>(random.below(6));
    report.beliefs.push_back({word(random), some_belief(random, n)});
  }
  for (std::uint64_t i = random.below(5); i-- > 0;) {
    report.rows.push_back({.kind = static_cast<Row::Kind>(random.below(3)),
                           .now_ns = stamp(random),
                           .name = some_text(random, random.below(20)),
                           .text = some_text(random, random.below(20)),
                           .value = random.normal()});
  }
  return report;
}

/// Of a message: no prefix and nothing longer is one, and nothing spoilt ends badly.
template <class T>
void expect_exact(const Bytes& bytes, Stream& random) {
  T out;
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    ASSERT_FALSE(decode(std::span(bytes).first(length), out)) << length;
  }
  Bytes other = bytes;
  other.push_back(std::byte{0});
  EXPECT_FALSE(decode(other, out));
  other = bytes;
  other[1] = std::byte{0};  // big-endian
  EXPECT_FALSE(decode(other, out));
  for (int i = 0; i < 50; ++i) {
    other = bytes;
    other[4 + random.below(bytes.size() - 4)] = static_cast<std::byte>(random.bits());
    (void)decode(other, out);
  }
}

TEST(LiveMessages, HelloIsCyclones) {
  for (std::uint64_t i = 0; i < draws; ++i) {
    Stream random = Stream::at(1, content, {1}, i);
    const Hello m = some_hello(random);
    Pool pool;
    const hearsay_Hello c{m.protocol,           m.agent,    m.process, pool.text(m.scenario),
                          pool.text(m.version), m.remembers};
    const Bytes bytes = encoded(m);
    expect_same(hearsay_Hello_desc, &c, bytes);
    Hello back;
    ASSERT_TRUE(decode(bytes, back));
    EXPECT_EQ(back, m);
    expect_exact<Hello>(bytes, random);
  }
}

TEST(LiveMessages, WelcomeIsCyclones) {
  for (std::uint64_t i = 0; i < draws; ++i) {
    Stream random = Stream::at(1, content, {2}, i);
    const Welcome m = some_welcome(random);
    Pool pool;
    const hearsay_Welcome c{m.agent, m.process, m.accepted, m.lockstep,
                            m.seed,  m.now_ns,  m.speed,    pool.text(m.reason)};
    const Bytes bytes = encoded(m);
    expect_same(hearsay_Welcome_desc, &c, bytes);
    Welcome back;
    ASSERT_TRUE(decode(bytes, back));
    EXPECT_EQ(back, m);
    expect_exact<Welcome>(bytes, random);
  }
}

TEST(LiveMessages, FrameIsCyclones) {
  for (std::uint64_t i = 0; i < draws; ++i) {
    Stream random = Stream::at(1, content, {3}, i);
    const Frame m = some_frame(random);
    Pool pool;
    hearsay_Frame c{m.agent, m.number, {}};
    pool.octets(c.content, m.content);
    const Bytes bytes = encoded(m);
    expect_same(hearsay_Frame_desc, &c, bytes);
    Frame back;
    ASSERT_TRUE(decode(bytes, back));
    EXPECT_EQ(back, m);
    expect_exact<Frame>(bytes, random);
  }
}

TEST(LiveMessages, ClockIsCyclones) {
  for (std::uint64_t i = 0; i < draws; ++i) {
    Stream random = Stream::at(1, content, {4}, i);
    const Clock m = some_clock(random);
    Pool pool;
    const hearsay_Clock c{m.now_ns, m.end_ns, m.speed, static_cast<std::uint8_t>(m.state),
                          pool.text(m.reason)};
    const Bytes bytes = encoded(m);
    expect_same(hearsay_Clock_desc, &c, bytes);
    Clock back;
    ASSERT_TRUE(decode(bytes, back));
    EXPECT_EQ(back, m);
    expect_exact<Clock>(bytes, random);
  }
}

TEST(LiveMessages, MeasurementIsCyclones) {
  for (std::uint64_t i = 0; i < draws; ++i) {
    Stream random = Stream::at(1, content, {5}, i);
    const Measurement m = some_measurement(random);
    Pool pool;
    hearsay_Measurement c{m.agent, m.subject, m.number, m.now_ns, {}, {}};
    pool.copy(c.information_vector, m.information.xi);
    pool.triangle(c.information_matrix, m.information.omega);
    const Bytes bytes = encoded(m);
    expect_same(hearsay_Measurement_desc, &c, bytes);
    Measurement back;
    ASSERT_TRUE(decode(bytes, back));
    EXPECT_EQ(back.agent, m.agent);
    EXPECT_EQ(back.subject, m.subject);
    EXPECT_EQ(back.number, m.number);
    EXPECT_EQ(back.now_ns, m.now_ns);
    EXPECT_TRUE(equal(back.information, m.information));
    expect_exact<Measurement>(bytes, random);
  }
}

TEST(LiveMessages, TruthIsCyclones) {
  for (std::uint64_t i = 0; i < draws; ++i) {
    Stream random = Stream::at(1, content, {6}, i);
    const Truth m = some_truth(random);
    Pool pool;
    hearsay_Truth c{m.now_ns, m.subject, {}};
    pool.copy(c.state, m.state);
    const Bytes bytes = encoded(m);
    expect_same(hearsay_Truth_desc, &c, bytes);
    Truth back;
    ASSERT_TRUE(decode(bytes, back));
    EXPECT_EQ(back, m);
    expect_exact<Truth>(bytes, random);
  }
}

TEST(LiveMessages, ReportIsCyclones) {
  for (std::uint64_t i = 0; i < draws; ++i) {
    Stream random = Stream::at(1, content, {7}, i);
    const Report m = some_report(random);
    Pool pool;
    const Counts& n = m.counts;
    hearsay_Report c{m.agent,
                     m.now_ns,
                     m.last,
                     m.missed,
                     {n.measurements, n.fusions, n.skipped, n.refused, n.late, n.fusion_gain_max},
                     {},
                     {}};
    const auto beliefs = pool.resize(c.beliefs, m.beliefs.size());
    for (std::size_t k = 0; k < beliefs.size(); ++k) {
      beliefs[k].subject = m.beliefs[k].subject;
      pool.copy(beliefs[k].information_vector, m.beliefs[k].belief.xi);
      pool.triangle(beliefs[k].information_matrix, m.beliefs[k].belief.omega);
    }
    const auto rows = pool.resize(c.rows, m.rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const Row& row = m.rows[k];
      rows[k] = {static_cast<std::uint8_t>(row.kind), row.now_ns, pool.text(row.name),
                 pool.text(row.text), row.value};
    }
    const Bytes bytes = encoded(m);
    expect_same(hearsay_Report_desc, &c, bytes);
    Report back;
    ASSERT_TRUE(decode(bytes, back));
    EXPECT_EQ(back.agent, m.agent);
    EXPECT_EQ(back.now_ns, m.now_ns);
    EXPECT_EQ(back.last, m.last);
    EXPECT_EQ(back.missed, m.missed);
    EXPECT_EQ(back.counts, m.counts);
    EXPECT_EQ(back.rows, m.rows);
    ASSERT_EQ(back.beliefs.size(), m.beliefs.size());
    for (std::size_t k = 0; k < m.beliefs.size(); ++k) {
      EXPECT_EQ(back.beliefs[k].subject, m.beliefs[k].subject);
      EXPECT_TRUE(equal(back.beliefs[k].belief, m.beliefs[k].belief));
    }
    expect_exact<Report>(bytes, random);
  }
}

// Cyclone takes any length; what is beyond the bounds must be refused here.
TEST(LiveMessages, WhatIsOversizeIsRefused) {
  Pool pool;
  const hearsay_Hello name{1,    2, 3, pool.text(std::string(name_bytes_max, 'a')), pool.text(""),
                           false};
  Hello hello;
  EXPECT_FALSE(decode(cyclone_bytes(hearsay_Hello_desc, &name), hello));

  const hearsay_Clock text{1, 2, 1.0, 0, pool.text(std::string(text_bytes_max, 'a'))};
  Clock clock;
  EXPECT_FALSE(decode(cyclone_bytes(hearsay_Clock_desc, &text), clock));

  hearsay_Frame long_frame{1, 2, {}};
  pool.resize(long_frame.content, content_bytes_max + 1);
  Frame frame;
  EXPECT_FALSE(decode(cyclone_bytes(hearsay_Frame_desc, &long_frame), frame));
  pool.resize(long_frame.content, content_bytes_max);
  EXPECT_TRUE(decode(cyclone_bytes(hearsay_Frame_desc, &long_frame), frame));

  hearsay_Truth long_truth{1, 2, {}};
  pool.resize(long_truth.state, numbers_max + 1);
  Truth truth;
  EXPECT_FALSE(decode(cyclone_bytes(hearsay_Truth_desc, &long_truth), truth));

  hearsay_Measurement big{1, 2, 3, 4, {}, {}};
  pool.resize(big.information_vector, gaussian::dimension_max + 1);
  pool.resize(big.information_matrix, 45);
  Measurement measurement;
  EXPECT_FALSE(decode(cyclone_bytes(hearsay_Measurement_desc, &big), measurement));
  pool.resize(big.information_vector, 3);
  pool.resize(big.information_matrix, 5);  // not 6
  EXPECT_FALSE(decode(cyclone_bytes(hearsay_Measurement_desc, &big), measurement));
}

TEST(LiveMessages, AReportHasNoMoreRowsThanAllowed) {
  const std::size_t count_at = encoded(Report{}).size() - 4;
  Bytes bytes = encoded(Report{.rows = std::vector<Row>(rows_max)});
  Report report;
  ASSERT_TRUE(decode(bytes, report));
  constexpr std::size_t row = 40;  // from a multiple of 8 to the next
  const Bytes last(bytes.end() - row, bytes.end());
  bytes.insert(bytes.end(), last.begin(), last.end());
  gaussian::cdr::store(bytes.data() + count_at, static_cast<std::uint32_t>(rows_max + 1));
  EXPECT_TRUE(cyclone_takes(hearsay_Report_desc, bytes));
  EXPECT_FALSE(decode(bytes, report));
}

TEST(LiveMessages, AChoiceThatThereIsNotIsRefused) {
  Pool pool;
  const hearsay_Clock c{1, 2, 1.0, 3, pool.text("")};
  Clock clock;
  EXPECT_FALSE(decode(cyclone_bytes(hearsay_Clock_desc, &c), clock));
  Hello hello;
  Bytes bytes = encoded(Hello{});
  bytes.back() = std::byte{2};  // a boolean
  EXPECT_FALSE(decode(bytes, hello));
}

TEST(LiveMessages, NumbersAreTakenAsTheyAre) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Measurement m{.information = gaussian::Belief::unknown(2)};
  m.information.xi(1) = nan;
  Measurement back;
  ASSERT_TRUE(decode(encoded(m), back));
  EXPECT_NE(back.information.xi(1), back.information.xi(1));
}

TEST(LiveMessages, WhatCannotBeReadIsNotWritten) {
  EXPECT_THROW(encoded(Hello{.scenario = std::string(name_bytes_max, 'a')}), BrokenInvariant);
  EXPECT_THROW(encoded(Hello{.scenario = std::string("a\0b", 3)}), BrokenInvariant);
  EXPECT_THROW(encoded(Truth{.state = std::vector<double>(numbers_max + 1)}), BrokenInvariant);
  EXPECT_THROW(encoded(Measurement{}), BrokenInvariant);
  EXPECT_THROW(encoded(Clock{.state = static_cast<Clock::State>(3)}), BrokenInvariant);
}

TEST(LiveMessages, TheProtocolIsTheOneOfTheIdl) { EXPECT_EQ(protocol, hearsay_PROTOCOL); }

}  // namespace
}  // namespace hearsay::live
