#include "net/faults.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

constexpr double sigmas = 4.0;
constexpr std::int64_t never = INT64_MAX;

Time ns(std::int64_t n) { return Time::nanoseconds(n); }
Time s(double seconds) { return Time::at(Duration::seconds(seconds)); }
Outage outage(std::int64_t from, std::int64_t until, bool forgets = false, AgentId agent = 0) {
  return {.agent = agent, .from = ns(from), .until = ns(until), .forgets = forgets};
}

std::vector<Outage> all_of(Dropouts& dropouts, AgentId agent, std::size_t at_most = 100'000) {
  std::vector<Outage> outages;
  while (outages.size() < at_most) {
    const auto next = dropouts.next(agent);
    if (!next) break;
    outages.push_back(*next);
  }
  return outages;
}

template <class Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Outages, ThatOverlapOrTouchAreOne) {
  EXPECT_EQ(merged({outage(5, 9), outage(1, 3)}), (std::vector{outage(1, 3), outage(5, 9)}));
  EXPECT_EQ(merged({outage(1, 3), outage(3, 4)}), (std::vector{outage(1, 4)}));
  EXPECT_EQ(merged({outage(1, 9), outage(2, 4)}), (std::vector{outage(1, 9)}));
  EXPECT_EQ(merged({outage(1, 3), outage(3, 4, false, 1)}),
            (std::vector{outage(1, 3), outage(3, 4, false, 1)}));
}

TEST(Outages, ForgetIfOneOfThemDoesAndEndWithTheLatest) {
  EXPECT_EQ(merged({outage(1, 5), outage(2, 3, true)}), (std::vector{outage(1, 5, true)}));
  EXPECT_EQ(merged({outage(1, 5), outage(2, never)}), (std::vector{outage(1, never)}));
  EXPECT_EQ(merged({outage(1, never), outage(2, 3, true), outage(7, 8)}),
            (std::vector{outage(1, never, true)}));
}

// Plans of a few short outages, told from brute force: every nanosecond is looked at.
TEST(Outages, AreThoseOfABruteForceOverEveryNanosecond) {
  constexpr int span = 60;
  Stream draws(3, Purpose("plans"), Entity::agent(0));
  for (int plan = 0; plan < 3000; ++plan) {
    std::vector<Outage> outages;
    std::vector<bool> away(span + 1, false), forgets(span + 1, false);
    for (std::uint64_t n = draws.below(7); n > 0; --n) {
      const auto from = static_cast<std::int64_t>(draws.below(span - 1));
      const auto length = static_cast<std::int64_t>(1 + draws.below(12));
      const std::int64_t until = std::min<std::int64_t>(span, from + length);
      outages.push_back(outage(from, until, draws.bernoulli(0.3)));
      for (std::int64_t t = from; t < until; ++t) {
        away[static_cast<std::size_t>(t)] = true;
        if (outages.back().forgets) forgets[static_cast<std::size_t>(t)] = true;
      }
    }
    std::vector<Outage> expected;
    for (std::size_t t = 0; t < span; ++t) {
      if (!away[t]) continue;
      const auto at = static_cast<std::int64_t>(t);
      if (t == 0 || !away[t - 1]) expected.push_back(outage(at, at));
      expected.back().until = ns(at + 1);
      if (forgets[t]) expected.back().forgets = true;
    }
    EXPECT_EQ(merged(outages), expected);
    Dropouts dropouts({.schedule = outages});
    EXPECT_EQ(all_of(dropouts, 0), expected);
  }
}

TEST(Dropouts, OfNobodyAreNone) {
  Dropouts none;
  EXPECT_TRUE(none.agents().empty());
  EXPECT_EQ(none.next(0), std::nullopt);
}

TEST(Dropouts, ComeToWhomTheyAreDue) {
  Dropouts dropouts({.seed = 4,
                     .schedule = {outage(7, 9, false, 5), outage(1, 2, true, 2)},
                     .rates = {{.agent = 3, .mean_up_s = 1.0, .mean_down_s = 1.0}}});
  EXPECT_TRUE(std::ranges::equal(dropouts.agents(), std::vector<AgentId>{2, 3, 5}));
  EXPECT_EQ(all_of(dropouts, 2), (std::vector{outage(1, 2, true, 2)}));
  EXPECT_EQ(all_of(dropouts, 5), (std::vector{outage(7, 9, false, 5)}));
  EXPECT_EQ(all_of(dropouts, 4).size(), 0u);
  EXPECT_EQ(all_of(dropouts, 3, 10).size(), 10u);
}

TEST(Dropouts, AreKeyedByAgentAndNumber) {
  const OutageRate rate{.mean_up_s = 3.0, .mean_down_s = 2.0, .forgets = true};
  std::vector<OutageRate> rates(4, rate);
  for (AgentId a = 0; a < 4; ++a) rates[static_cast<std::size_t>(a)].agent = a;
  Dropouts dropouts({.seed = 8, .rates = rates});
  Time up_since;
  for (std::uint64_t k = 0; k < 50; ++k) {
    Stream draws = Stream::at(8, Purpose("dropout"), Entity::agent(2), k);
    const Time from = up_since + Duration::seconds(draws.exponential(1.0 / 3.0));
    const Time until = from + Duration::seconds(draws.exponential(1.0 / 2.0));
    EXPECT_EQ(dropouts.next(2), (Outage{2, from, until, true}));
    up_since = until;
  }
  // Whoever else is asked, or fails at all, changes nothing.
  Dropouts alone({.seed = 8, .rates = {rates[1]}});
  EXPECT_EQ(all_of(alone, 1, 30), all_of(dropouts, 1, 30));
}

TEST(Dropouts, DieOnceAndAreNotHeardOfAgain) {
  Dropouts dropouts({.schedule = {outage(1, 2), outage(5, never), outage(9, 12, true)}});
  EXPECT_EQ(all_of(dropouts, 0), (std::vector{outage(1, 2), outage(5, never, true)}));
  Dropouts random({.rates = {{.agent = 0, .mean_up_s = 1.0},
                             {.agent = 0, .mean_up_s = 1e-3, .mean_down_s = 1e-3}}});
  const auto outages = all_of(random, 0);
  ASSERT_GT(outages.size(), 10u);
  EXPECT_EQ(outages.back().until, Time::never());
  EXPECT_EQ(random.next(0), std::nullopt);
}

TEST(Dropouts, EndWithTheRunOrTheirNumber) {
  const OutageRate rate{.agent = 0, .mean_up_s = 1.0, .mean_down_s = 1.0};
  Dropouts endless({.rates = {rate}});
  Dropouts bounded({.end = s(100.0),
                    .schedule = {{0, s(99.0), s(200.0)}, {0, s(250.0), s(300.0)}},
                    .rates = {rate}});
  const auto before = all_of(bounded, 0);
  EXPECT_LT(before.back().from, s(100.0));
  EXPECT_EQ(before.back().until, s(200.0));
  const auto same = all_of(endless, 0, before.size() - 1);
  for (std::size_t i = 0; i + 1 < before.size(); ++i) EXPECT_EQ(before[i], same[i]);

  OutageRate few = rate;
  few.outages_max = 3;
  Dropouts counted({.rates = {few}});
  EXPECT_EQ(all_of(counted, 0).size(), 3u);
}

TEST(Dropouts, JoinScheduleAndSeveralCausesAsABruteForceDoes) {
  const std::vector<OutageRate> rates = {
      {.agent = 1, .mean_up_s = 5.0, .mean_down_s = 2.0},
      {.agent = 1, .mean_up_s = 20.0, .mean_down_s = 3.0, .forgets = true}};
  std::vector<Outage> plan;
  for (int k = 0; k < 20; ++k) plan.push_back({1, s(50.0 * k), s(50.0 * k + 10.0), k % 5 == 0});
  Dropouts together({.seed = 6, .end = s(1000.0), .schedule = plan, .rates = rates});
  // Each cause alone; the second one under the key of a second cause.
  Dropouts first({.seed = 6, .end = s(1000.0), .rates = {rates[0]}});
  std::vector<Outage> parts = all_of(first, 1);
  Time up_since;
  for (std::uint64_t k = 0; up_since < s(1000.0); ++k) {
    Stream draws = Stream::at(6, Purpose("dropout"), Entity::sensor(1, 1), k);
    const Time from = up_since + Duration::seconds(draws.exponential(1.0 / 20.0));
    up_since = from + Duration::seconds(draws.exponential(1.0 / 3.0));
    if (from < s(1000.0)) parts.push_back({1, from, up_since, true});
  }
  parts.insert(parts.end(), plan.begin(), plan.end());
  EXPECT_EQ(all_of(together, 1), merged(parts));
}

// √n times the largest distance between the sample's distribution and the exponential one
// (Kolmogorov–Smirnov); beyond 2.23 with probability 1e-4.
double distance(std::vector<double> values, double mean) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double p = -std::expm1(-values[i] / mean);
    largest = std::max({largest, std::fabs(p - static_cast<double>(i) / n),
                        std::fabs(static_cast<double>(i + 1) / n - p)});
  }
  return std::sqrt(n) * largest;
}

TEST(Dropouts, HaveExponentialUpAndDownTimes) {
  std::vector<double> up, down;
  for (AgentId a = 0; a < 40; ++a) {
    Dropouts dropouts({.seed = 2, .rates = {{.agent = a, .mean_up_s = 30.0, .mean_down_s = 7.0}}});
    Time up_since;
    for (const Outage& o : all_of(dropouts, a, 500)) {
      up.push_back((o.from - up_since).seconds());
      down.push_back((o.until - o.from).seconds());
      up_since = o.until;
    }
  }
  EXPECT_LT(distance(up, 30.0), 2.23);
  EXPECT_LT(distance(down, 7.0), 2.23);
  // Independent of each other: the products of deviations have variance 30² · 7².
  double covariance = 0.0;
  for (std::size_t i = 0; i < up.size(); ++i) covariance += (up[i] - 30.0) * (down[i] - 7.0);
  const auto n = static_cast<double>(up.size());
  EXPECT_NEAR(covariance / n, 0.0, sigmas * 30.0 * 7.0 / std::sqrt(n));
}

// A renewal process that starts up is up at t with probability
// (λ_d + λ_u exp(−(λ_u + λ_d) t))/(λ_u + λ_d), where λ_u = 1/mean_up and λ_d = 1/mean_down.
TEST(Dropouts, AreAvailableAsInClosedForm) {
  constexpr int agents = 6000;
  std::vector<OutageRate> rates;
  for (AgentId a = 0; a < agents; ++a) {
    rates.push_back({.agent = a, .mean_up_s = 12.0, .mean_down_s = 4.0});
  }
  for (const double t_s : {0.5, 2.0, 6.0, 200.0}) {
    Dropouts dropouts({.seed = 3, .end = s(t_s + 1.0), .rates = rates});
    int up = 0;
    for (AgentId a = 0; a < agents; ++a) {
      const auto outages = all_of(dropouts, a);
      up += std::none_of(outages.begin(), outages.end(),
                         [&](const Outage& o) { return o.from <= s(t_s) && s(t_s) < o.until; });
    }
    const double away = 1.0 / 12.0, back = 1.0 / 4.0;
    const double p = (back + away * std::exp(-(away + back) * t_s)) / (away + back);
    EXPECT_NEAR(up, agents * p, sigmas * std::sqrt(agents * p * (1.0 - p))) << t_s << " s";
    if (t_s > 100.0) {
      EXPECT_NEAR(p, 12.0 / (12.0 + 4.0), 1e-12);  // mean_up/(mean_up + mean_down)
    }
  }
}

TEST(Dropouts, SurviveTimesBeyondTheClock) {
  Dropouts dropouts({.rates = {{.agent = 0, .mean_up_s = 1e300, .mean_down_s = 1e300}}});
  Time before;
  for (const Outage& o : all_of(dropouts, 0, 10)) {
    EXPECT_GT(o.from, before);
    EXPECT_GT(o.until, o.from);
    before = o.until;
  }
}

TEST(Dropouts, RefuseTimesThatAreNone) {
  const auto planned = [](const Outage& of) {
    return error_of([&] { Dropouts({.schedule = {of}}); });
  };
  EXPECT_EQ(planned({2, s(-1.0), s(3.0)}),
            "dropouts of agent 2: from_s must be at least 0, not -1");
  EXPECT_EQ(planned({2, s(4.0), s(4.0)}),
            "dropouts of agent 2: until_s must be after from_s (4), not 4");
  const auto random = [](const OutageRate& of) {
    return error_of([&] { Dropouts({.rates = {of}}); });
  };
  EXPECT_EQ(random({.agent = 1}),
            "dropouts of agent 1: mean_up_s must be positive and finite, not 0");
  EXPECT_EQ(random({.agent = 1, .mean_up_s = std::numeric_limits<double>::infinity()}),
            "dropouts of agent 1: mean_up_s must be positive and finite, not inf");
  EXPECT_EQ(random({.agent = 1, .mean_up_s = 1.0, .mean_down_s = -2.0}),
            "dropouts of agent 1: mean_down_s must be positive and finite, not -2");
  EXPECT_EQ(random({.agent = 1, .mean_up_s = 1.0, .outages_max = ~std::uint64_t{0}}),
            "dropouts of agent 1: outages_max must be at most 2^47, not 18446744073709551615");
}

Jammer near_origin() {
  Jammer jammer;
  jammer.radius_m = 10.0;
  return jammer;
}

TEST(Jammers, JamWhoIsWithinTheRadius) {
  const Jammers jammers({near_origin()});
  EXPECT_FALSE(jammers.none());
  EXPECT_TRUE(jammers.jams({6.0, 8.0, 0.0}, s(1.0), s(2.0)));
  EXPECT_FALSE(jammers.jams({6.0, 8.01, 0.0}, s(1.0), s(2.0)));
  EXPECT_FALSE(jammers.jams({0.0, 8.0, 6.1}, s(1.0), s(2.0)));
  EXPECT_TRUE(Jammers().none());
  EXPECT_FALSE(Jammers().jams({}, s(1.0), s(2.0)));
}

TEST(Jammers, AreOnAtTheNanosecondsOfABruteForce) {
  Stream draws(3, Purpose("jammers"), Entity::agent(0));
  for (int trial = 0; trial < 4000; ++trial) {
    Jammer jammer = near_origin();
    const auto from = static_cast<std::int64_t>(draws.below(30));
    const auto until = from + 1 + static_cast<std::int64_t>(draws.below(60));
    jammer.from = ns(from);
    jammer.until = draws.bernoulli(0.3) ? Time::never() : ns(until);
    const auto period = static_cast<std::int64_t>(draws.below(4) ? 1 + draws.below(20) : 0);
    const auto pulse =
        period > 0 ? 1 + static_cast<std::int64_t>(draws.below(static_cast<std::uint64_t>(period)))
                   : 0;
    jammer.period = Duration::nanoseconds(period);
    if (period > 0) jammer.duty = static_cast<double>(pulse) / static_cast<double>(period);
    const auto begin = static_cast<std::int64_t>(draws.below(90));
    const auto end = begin + static_cast<std::int64_t>(draws.below(15));
    bool expected = false;
    for (std::int64_t t = begin; t < std::max(end, begin + 1); ++t) {
      const bool pulsed = period == 0 || (t - from) % period < pulse;
      expected |= t >= from && ns(t) < jammer.until && pulsed;
    }
    EXPECT_EQ(is_on(jammer, ns(begin), ns(end)), expected)
        << "on " << from << "…" << jammer.until.nanoseconds() << ", " << pulse << " of " << period
        << "; asked " << begin << "…" << end;
    EXPECT_EQ(Jammers({jammer}).jams({1.0, 1.0, 1.0}, ns(begin), ns(end)), expected);
  }
}

TEST(Jammers, WithAPowerAddUpAtTheReceiver) {
  const Propagation path = Propagation::log_distance(
      {.exponent = 2.0, .reference_loss_db = 40.0, .noise_dbm = -100.0, .range_m = 1000.0});
  Jammer strong;
  strong.power_dbm = 20.0;
  strong.position_m = {100.0, 0.0, 0.0};
  Jammer late = strong;
  late.power_dbm = 10.0;
  late.from = s(5.0);
  const Jammers jammers({strong, late, near_origin()});
  const Point here{0.0, 0.0, 0.0};
  // 20 dBm − 40 dB − 20 log10(100) dB = −60 dBm.
  EXPECT_NEAR(jammers.interference_mw(here, s(1.0), s(2.0), path), 1e-6, 1e-15);
  EXPECT_NEAR(jammers.interference_mw(here, s(4.0), s(6.0), path), 1.1e-6, 1e-15);
  EXPECT_EQ(Jammers({near_origin()}).interference_mw(here, s(1.0), s(2.0), Propagation()), 0.0);
  EXPECT_THROW(jammers.interference_mw(here, s(1.0), s(2.0), Propagation()), BrokenInvariant);
  const double jammed_mw = jammers.interference_mw(here, s(1.0), s(2.0), path);
  // The signal comes with −60 dBm, too, and the noise is negligible: 0 dB.
  EXPECT_NEAR(path.quality(10.0, 0.0, jammed_mw).snr_db, 0.0, 1e-3);
}

TEST(Jammers, RefuseWhatCannotBe) {
  const auto refused = [](auto change) {
    Jammer jammer = near_origin();
    change(jammer);
    return error_of([&] { Jammers({jammer}); });
  };
  EXPECT_EQ(refused([](Jammer&) {}), "no error");
  EXPECT_EQ(refused([](Jammer& j) { j.radius_m.reset(); }),
            "jammer 0: needs either radius_m or power_dbm");
  EXPECT_EQ(refused([](Jammer& j) { j.power_dbm = 3.0; }),
            "jammer 0: needs either radius_m or power_dbm");
  EXPECT_EQ(refused([](Jammer& j) { j.radius_m = 0.0; }),
            "jammer 0: radius_m must be positive and finite, not 0");
  EXPECT_EQ(refused([](Jammer& j) {
              j.radius_m.reset();
              j.power_dbm = 300.0;
            }),
            "jammer 0: power_dbm must be between -200 and 200, not 300");
  EXPECT_EQ(refused([](Jammer& j) { j.position_m[1] = std::nan(""); }),
            "jammer 0: position_m must be finite, not nan");
  EXPECT_EQ(refused([](Jammer& j) { j.from = s(-1.0); }),
            "jammer 0: from_s must be at least 0, not -1");
  EXPECT_EQ(refused([](Jammer& j) { j.until = j.from; }),
            "jammer 0: until_s must be after from_s (0), not 0");
  EXPECT_EQ(refused([](Jammer& j) { j.period = -1_s; }),
            "jammer 0: period_s must be at least 0, not -1");
  EXPECT_EQ(refused([](Jammer& j) { j.duty = 0.0; }), "jammer 0: duty must be in (0, 1], not 0");
}

}  // namespace
}  // namespace hearsay
