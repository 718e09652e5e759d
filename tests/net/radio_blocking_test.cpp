// The transmitter as a queue with room for K packets, the one being sent among them: what share of
// Poisson arrivals finds it full.
//
// M/M/1/K: (1 − ρ)ρ^K/(1 − ρ^(K+1)). M/D/1/K: with π the law of what a departure leaves behind,
// found from the Poisson numbers of arrivals during a service, 1 − 1/(π₀ + ρ) (L. Kleinrock,
// Queueing systems I, 1975, chapters 3 and 5). Besides, a queue of departure times, packet by
// packet.
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <vector>

#include "net/radio.hpp"
#include "tests/net/graphs.hpp"

namespace hearsay {
namespace {

constexpr double mean_s = 1e-3;
constexpr std::size_t mean_bytes = 200;
constexpr Duration byte_time = 5_us;  // at 1.6 Mbit/s
constexpr int batches = 40;

enum class Sizes { equal, geometric };

struct Case {
  double load;
  std::uint32_t room;  // K
  Sizes sizes;
  QueuePolicy policy = QueuePolicy::drop_new;
};

double m_m_1_k(double load, int room) {
  return (1.0 - load) * std::pow(load, room) / (1.0 - std::pow(load, room + 1));
}

double m_d_1_k(double load, int room) {
  std::vector<double> arrivals(static_cast<std::size_t>(room) + 1);
  arrivals[0] = std::exp(-load);
  for (std::size_t k = 1; k < arrivals.size(); ++k) {
    arrivals[k] = arrivals[k - 1] * load / static_cast<double>(k);
  }
  // π(j+1) from π(j) = π(0) a(j) + Σ π(i) a(j − i + 1), i = 1 … j + 1; j < K − 1.
  std::vector<double> pi{1.0};
  double sum = 1.0;
  for (std::size_t j = 0; j + 1 < static_cast<std::size_t>(room); ++j) {
    double next = pi[j] - pi[0] * arrivals[j];
    for (std::size_t i = 1; i <= j; ++i) next -= pi[i] * arrivals[j - i + 1];
    pi.push_back(next / arrivals[0]);
    sum += pi.back();
  }
  return 1.0 - 1.0 / (1.0 / sum + load);
}

class Server {
 public:
  explicit Server(const Case& c)
      : case_(c),
        simulation_({.end = Time::at(batch * batches)}),
        radio_(simulation_, Topology::line(2),
               {.rate_bps = 1.6e6, .queue = {.packets_max = c.room, .policy = c.policy}}),
        draw_(23, Purpose("arrivals"), Entity{0}),
        payload_(40 * mean_bytes) {
    next();
    for (int b = 1; b <= batches; ++b) {
      simulation_.schedule(Time::at(batch * b), Phase::observe, [this] {
        const auto full = static_cast<double>(dropped() - dropped_before_);
        share.add(full / static_cast<double>(radio_.counts(0).packets - packets_before_));
        dropped_before_ = dropped();
        packets_before_ = radio_.counts(0).packets;
      });
    }
    simulation_.run();
    radio_.finish();
  }
  std::uint64_t dropped() const {
    return radio_.counts(0).fates[static_cast<std::size_t>(Fate::queue_full)];
  }

  Average share;                 // of arrivals that are dropped, a batch
  std::uint64_t found_full = 0;  // by departure times

 private:
  static constexpr Duration batch = 4_s;  // 4000 services
  void next() {
    const Duration gap = Duration::seconds(draw_.exponential(case_.load / mean_s));
    simulation_.schedule(simulation_.now() + gap, Phase::act, [this] { arrive(); });
  }
  void arrive() {
    const double p = 1.0 / static_cast<double>(mean_bytes);
    const double exact = draw_.exponential(-std::log1p(-p));
    const bool equal = case_.sizes == Sizes::equal;
    const auto size = equal ? mean_bytes : static_cast<std::size_t>(exact) + 1;
    ASSERT_LE(size, payload_.size());
    const Time now = simulation_.now();
    while (!departures_.empty() && departures_.front() <= now) departures_.pop_front();
    if (departures_.size() >= case_.room) {
      ++found_full;
    } else {
      const Time begin = departures_.empty() ? now : departures_.back();
      departures_.push_back(begin + byte_time * static_cast<std::int64_t>(size));
    }
    radio_.send(0, {.bytes = std::span(payload_).first(size)});
    next();
  }

  Case case_;
  Simulation simulation_;
  Radio radio_;
  Stream draw_;
  std::vector<std::byte> payload_;
  std::deque<Time> departures_;
  std::uint64_t dropped_before_ = 0, packets_before_ = 0;
};

void expect_theory(const Case& c, double expected) {
  SCOPED_TRACE(testing::Message() << "load " << c.load << ", room for " << c.room);
  const Server server(c);
  EXPECT_NEAR(server.share.mean(), expected, 4.0 * server.share.error());
  EXPECT_LT(server.share.error(), 0.1 * expected) << "the test is too weak";
  EXPECT_TRUE(c.policy != QueuePolicy::drop_new || server.dropped() == server.found_full);
}

TEST(RadioBlocking, EqualSizesFindTheQueueFullAsInMD1K) {
  for (const double load : {0.5, 0.9, 1.5}) {
    for (const std::uint32_t room : {1u, 2u, 4u}) {
      const double expected = m_d_1_k(load, static_cast<int>(room));
      expect_theory({load, room, Sizes::equal}, expected);
      // With equal sizes it does not matter for how many which packet goes.
      if (room > 1) expect_theory({load, room, Sizes::equal, QueuePolicy::drop_oldest}, expected);
    }
  }
}

TEST(RadioBlocking, ExponentialSizesFindTheQueueFullAsInMM1K) {
  // Sizes are whole bytes: geometric with the same mean, as good as exponential at 200 bytes.
  for (const double load : {0.5, 0.9, 1.5}) {
    for (const std::uint32_t room : {1u, 2u, 4u}) {
      expect_theory({load, room, Sizes::geometric}, m_m_1_k(load, static_cast<int>(room)));
    }
  }
}

TEST(RadioBlocking, TheFormulasAgreeWithErlangWhereNothingWaits) {
  // Room for one: Erlang's loss formula ρ/(1 + ρ), whatever the law of sizes.
  for (const double load : {0.2, 0.9, 3.0}) {
    EXPECT_NEAR(m_d_1_k(load, 1), load / (1.0 + load), 1e-12);
    EXPECT_NEAR(m_m_1_k(load, 1), load / (1.0 + load), 1e-12);
  }
}

}  // namespace
}  // namespace hearsay
