// The transmitter as a queue: Poisson arrivals, one server, first come first served.
//
// Two second sources: Lindley's recursion on the very arrivals of the run, exact to the nanosecond,
// and the closed forms for the mean wait before the first bit, with ρ = λ/μ:
//   M/D/1  ρ/(2μ(1 − ρ)),   M/M/1  ρ/(μ − λ).
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "net/radio.hpp"

namespace hearsay {
namespace {

constexpr double rate_bps = 1.6e6;
constexpr Duration byte_time = 5_us;
constexpr std::size_t mean_bytes = 200;
constexpr double mean_s = 1e-3;
constexpr int batches = 50;

enum class Sizes { equal, geometric };

// An agent that gets packets to send at random times, and what must become of each.
class Server {
 public:
  Server(double load, Sizes sizes, Duration batch)
      : load_(load),
        sizes_(sizes),
        end_(Time::at(batch * batches)),
        simulation_({.end = end_, .record = {.keep_messages = false}}),
        radio_(simulation_, Topology::line(2),
               {.rate_bps = rate_bps, .queue = {.packets_max = 1'000'000'000}}),
        draw_(17, Purpose("arrivals"), Entity{0}),
        payload_(100 * mean_bytes) {
    next();
    for (int b = 1; b <= batches; ++b) {
      simulation_.schedule(Time::at(batch * b), Phase::observe,
                           [this] { snapshots_.push_back(counts()); });
    }
    simulation_.run();
    radio_.finish();
  }
  const SenderCounts& counts() const { return radio_.counts(0); }
  double seconds() const { return end_.seconds(); }

  // Mean wait of those that begin in a batch, in s.
  std::vector<double> batch_means_s() const {
    std::vector<double> means;
    for (std::size_t b = 1; b < snapshots_.size(); ++b) {  // the first lets the queue fill
      const SenderCounts& before = snapshots_[b - 1];
      const Duration wait = snapshots_[b].queue_delay - before.queue_delay;
      means.push_back(wait.seconds() / static_cast<double>(snapshots_[b].begun - before.begun));
    }
    return means;
  }

  // Lindley: what begins by the end of the run.
  Duration waited, busy;
  std::uint64_t begun = 0, bytes = 0;

 private:
  void next() {
    const Duration gap = Duration::seconds(draw_.exponential(load_ / mean_s));
    simulation_.schedule(simulation_.now() + gap, Phase::act, [this] { arrive(); });
  }
  void arrive() {
    // Exponential sizes, rounded up to bytes: geometric with the mean 1/p.
    const double p = 1.0 / static_cast<double>(mean_bytes);
    const double exact = draw_.exponential(-std::log1p(-p));
    const auto size = sizes_ == Sizes::equal ? mean_bytes : static_cast<std::size_t>(exact) + 1;
    const Time begin = std::max(free_at_, simulation_.now());
    const Duration service = byte_time * static_cast<std::int64_t>(size);
    free_at_ = begin + service;
    if (begin <= end_) {
      ++begun;
      bytes += size;
      waited += begin - simulation_.now();
      busy += std::min(free_at_, end_) - begin;
    }
    ASSERT_LE(size, payload_.size());
    radio_.send(0, {.bytes = std::span(payload_).first(size)});
    next();
  }

  double load_;
  Sizes sizes_;
  Time end_, free_at_;
  Simulation simulation_;
  Radio radio_;
  Stream draw_;
  std::vector<std::byte> payload_;
  std::vector<SenderCounts> snapshots_;
};

// The mean wait lies within 4 standard errors of theory, found from batches much longer than the
// queue remembers: (1 − √ρ)^−2 services, 380 at ρ = 0.9.
void expect_theory(double load, Sizes sizes, double expected_s, Duration batch) {
  const Server server(load, sizes, batch);
  EXPECT_EQ(server.counts().begun, server.begun);
  EXPECT_EQ(server.counts().bytes_sent, server.bytes);
  EXPECT_EQ(server.counts().queue_delay, server.waited);
  EXPECT_EQ(server.counts().air_time, server.busy);

  const std::vector<double> means = server.batch_means_s();
  const auto n = static_cast<double>(means.size());
  double mean = 0.0, square = 0.0;
  for (const double m : means) mean += m / n;
  for (const double m : means) square += (m - mean) * (m - mean) / (n - 1.0);
  const double error = std::sqrt(square / n);
  EXPECT_NEAR(mean, expected_s, 4.0 * error);
  EXPECT_LT(error, 0.05 * expected_s) << "the test is too weak";

  // The work that arrives in T is a compound Poisson sum: variance λ T E[S²].
  const double square_service = (sizes == Sizes::equal ? 1.0 : 2.0) * mean_s * mean_s;
  const double sigma = std::sqrt(load / mean_s * square_service / server.seconds());
  EXPECT_NEAR(server.counts().air_time.seconds() / server.seconds(), load, 4.0 * sigma);
}

double m_d_1_s(double load) { return load * mean_s / (2.0 * (1.0 - load)); }

// With geometric sizes E[S²] = (2 − p) E[S]², p = 1/200, where exponential ones have 2: the wait
// is that of M/M/1, ρ/(μ − λ), times 1 − p/2 (Pollaczek–Khinchine).
double m_m_1_s(double load) {
  const double mu = 1.0 / mean_s;
  const double rounding = 1.0 - 0.5 / static_cast<double>(mean_bytes);
  return rounding * load / (mu - load * mu);
}

TEST(RadioQueueTheory, FixedSizesWaitAsInMD1AtLowLoad) {
  expect_theory(0.3, Sizes::equal, m_d_1_s(0.3), 10_s);
}
TEST(RadioQueueTheory, FixedSizesWaitAsInMD1AtMiddleLoad) {
  expect_theory(0.6, Sizes::equal, m_d_1_s(0.6), 12_s);
}
TEST(RadioQueueTheory, FixedSizesWaitAsInMD1AtHighLoad) {
  expect_theory(0.9, Sizes::equal, m_d_1_s(0.9), 12_s);
}
TEST(RadioQueueTheory, ExponentialSizesWaitAsInMM1AtLowLoad) {
  expect_theory(0.3, Sizes::geometric, m_m_1_s(0.3), 10_s);
}
TEST(RadioQueueTheory, ExponentialSizesWaitAsInMM1AtMiddleLoad) {
  expect_theory(0.6, Sizes::geometric, m_m_1_s(0.6), 12_s);
}
TEST(RadioQueueTheory, ExponentialSizesWaitAsInMM1AtHighLoad) {
  expect_theory(0.9, Sizes::geometric, m_m_1_s(0.9), 12_s);
}

}  // namespace
}  // namespace hearsay
