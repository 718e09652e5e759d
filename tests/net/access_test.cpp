// Who may send when, as the radios ask: slots, time division, back-off and its freezing.
#include "net/access.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Desk final : private AccessUser {
 public:
  explicit Desk(const AccessOptions& options, std::uint64_t seed = 1, int radios = 4)
      : simulation_({.seed = seed, .end = Time::at(100'000_s), .record = {}}),
        access_(make_access(options, simulation_, radios, *this)) {}

  template <class What>
  void at(Duration time, What what) {
    todo_.push_back(std::move(what));
    simulation_.schedule(Time::at(time), Phase::update,
                         [this, n = todo_.size() - 1] { todo_[n](); });
  }
  void ask(Duration time, AgentId radio, int repetition = 0, Duration earliest = {}) {
    at(time, [this, radio, repetition, earliest] {
      access_->request(radio, repetition, Time::at(earliest));
    });
  }
  void run() {
    const RunEnd end = simulation_.run();
    EXPECT_TRUE(end.ok()) << end.message;
  }
  Access& access() { return *access_; }
  AirListener& air() { return *access_->listener(); }
  Time now() const { return simulation_.now(); }

  struct Grant {
    AgentId radio;
    Duration at;
    bool operator==(const Grant&) const = default;
  };
  std::vector<Grant> grants;
  std::function<void(AgentId)> reaction;

 private:
  void granted(AgentId radio) override {
    grants.push_back({radio, simulation_.now().since_start()});
    if (reaction) reaction(radio);
  }
  Simulation simulation_;
  std::unique_ptr<Access> access_;
  std::deque<std::function<void()>> todo_;
};
using Grant = Desk::Grant;

constexpr AccessOptions aloha{.sharing = Sharing::slotted_aloha, .slot = 10_ms};
constexpr AccessOptions carrier_sense{.sharing = Sharing::carrier_sense,
                                      .slot = 1_ms,
                                      .interframe = 3_ms,
                                      .interframe_garbled = 20_ms,
                                      .window_min = 16,
                                      .window_max = 64};

TEST(Access, WithoutSharingThereIsNothingToAsk) {
  Simulation simulation({.end = Time::at(1_s), .record = {}});
  struct Nobody final : AccessUser {
    void granted(AgentId) override {}
  } nobody;
  EXPECT_EQ(make_access({}, simulation, 3, nobody), nullptr);
}

TEST(Access, AlohaGrantsTheNextSlot) {
  Desk desk(aloha);
  desk.ask(1_ms, 0);
  desk.ask(10_ms, 1);  // at the begin of a slot: this one
  desk.ask(10_ms + 1_ns, 2);
  desk.ask(12_ms, 3, 0, 41_ms);  // sends something else until then
  desk.run();
  EXPECT_THAT(desk.grants,
              ElementsAre(Grant{0, 10_ms}, Grant{1, 10_ms}, Grant{2, 20_ms}, Grant{3, 50_ms}));
}

TEST(Access, AWithdrawnRequestIsNotGranted) {
  for (const AccessOptions& options : {aloha, carrier_sense}) {
    Desk desk(options);
    desk.ask(1_ms, 0);
    desk.ask(1_ms, 1);
    desk.at(2_ms, [&] {
      desk.access().withdraw(0);
      desk.access().withdraw(2);  // never asked
    });
    if (options.sharing == Sharing::carrier_sense) {
      desk.at(3_ms, [&] { desk.air().air_taken(0); });
      desk.at(4_ms, [&] { desk.air().air_free(0, false); });
    }
    desk.run();
    ASSERT_EQ(desk.grants.size(), 1u);
    EXPECT_EQ(desk.grants[0].radio, 1);
  }
}

TEST(Access, AlohaLetsSlotsPassByAGeometricLaw) {
  // One asks again as soon as it is granted; slots between follow P(k) = p(1 − p)^k.
  constexpr double p = 0.2;
  constexpr int n = 20'000;
  AccessOptions options = aloha;
  options.send_probability = p;
  std::vector<Duration> alone;
  for (const bool others : {false, true}) {
    Desk desk(options, 7);
    std::vector<Duration> times;
    desk.reaction = [&](AgentId radio) {
      if (radio != 0) return desk.access().request(radio, 0, desk.now() + 1_ns);
      times.push_back(desk.now().since_start());
      if (times.size() < n) return desk.access().request(0, 0, desk.now() + 1_ns);
      for (AgentId other : {1, 2}) desk.access().withdraw(other);
    };
    desk.ask(0_s, 0);
    if (others) {
      desk.ask(0_s, 1);
      desk.ask(0_s, 2);
    }
    desk.run();
    ASSERT_EQ(times.size(), static_cast<std::size_t>(n));
    if (others) {
      EXPECT_EQ(times, alone) << "what one draws depends on the others";
      break;
    }
    alone = times;
    std::map<std::int64_t, int> passed;
    for (std::size_t i = 1; i < times.size(); ++i) {
      const Duration gap = times[i] - times[i - 1];
      ASSERT_EQ(gap % (10_ms), Duration());
      ++passed[gap / (10_ms) - 1];
    }
    double share = p;
    for (std::int64_t k = 0; k < 12; ++k) {
      const double sigma = std::sqrt(share * (1.0 - share) * n);
      EXPECT_NEAR(passed[k], share * n, 4.0 * sigma) << k << " slots passed over";
      share *= 1.0 - p;
    }
  }
}

TEST(Access, TimeDivisionGrantsTheNextSlotOfOnesOwn) {
  for (const int slots : {0, 1, 3, 7}) {
    AccessOptions options = aloha;
    options.sharing = Sharing::tdma;
    options.slots = slots;
    const int cycle = slots > 0 ? slots : 5;
    Desk desk(options, 1, 5);
    std::vector<Grant> expected;
    for (int n = 0; n < 200; ++n) {
      const AgentId radio = n % 5;
      const Duration time = 1_s * n + 1_ms * (n * 37 % 300) + 1_ns * (n % 2);
      desk.ask(time, radio);
      std::int64_t slot = 0;  // by trying
      while (10_ms * slot < time || slot % cycle != radio % cycle) ++slot;
      expected.push_back({radio, 10_ms * slot});
    }
    desk.run();
    EXPECT_EQ(desk.grants, expected) << slots << " slots";
  }
}

// The number of slots that each of n requests of radio 0 waits, undisturbed.
std::vector<std::int64_t> back_offs(int repetition, int n, std::uint64_t seed = 1) {
  Desk desk(carrier_sense, seed);
  std::vector<std::int64_t> slots;
  Duration asked;
  desk.reaction = [&](AgentId) {
    const Duration waited = desk.now().since_start() - asked - 3_ms;
    EXPECT_EQ(waited % (1_ms), Duration());
    slots.push_back(waited / (1_ms));
    asked = desk.now().since_start();
    if (slots.size() < static_cast<std::size_t>(n)) desk.access().request(0, repetition, {});
  };
  desk.ask(0_s, 0, repetition);
  desk.run();
  return slots;
}

TEST(Access, TheBackOffIsUniformInAWindowThatDoubles) {
  constexpr int n = 20'000;
  for (const auto& [repetition, window] : {std::pair{0, 16}, {1, 32}, {2, 64}, {3, 64}, {99, 64}}) {
    SCOPED_TRACE(repetition);
    std::vector<int> counts(static_cast<std::size_t>(window), 0);
    for (const std::int64_t slots : back_offs(repetition, n)) {
      ASSERT_GE(slots, 0);
      ASSERT_LT(slots, window);
      ++counts[static_cast<std::size_t>(slots)];
    }
    // χ² with window − 1 degrees of freedom: mean window − 1, variance 2(window − 1).
    const double expected = static_cast<double>(n) / window;
    double chi2 = 0.0;
    for (const int count : counts) chi2 += (count - expected) * (count - expected) / expected;
    EXPECT_NEAR(chi2, window - 1.0, 4.0 * std::sqrt(2.0 * (window - 1.0)));
  }
}

TEST(Access, ARadioThatAsksWhileTheAirIsTakenWaitsForItsEnd) {
  const std::int64_t slots = back_offs(0, 1)[0];
  for (const bool garbled : {false, true}) {
    Desk desk(carrier_sense);
    desk.at(1_ms, [&] { desk.air().air_taken(0); });
    desk.ask(2_ms, 0);
    desk.at(50_ms, [&] { desk.air().air_free(0, garbled); });
    desk.run();
    const Duration space = garbled ? 23_ms : 3_ms;
    EXPECT_THAT(desk.grants, ElementsAre(Grant{0, 50_ms + space + 1_ms * slots}));
  }
}

TEST(Access, AGrantDueAtTheInstantAtWhichTheAirIsTakenIsGivenOnce) {
  const Duration due = 3_ms + 1_ms * back_offs(0, 1)[0];
  for (const bool free_at_once : {false, true}) {
    Desk desk(carrier_sense);
    desk.at(due, [&, free_at_once] {  // scheduled first, so told first
      desk.air().air_taken(0);
      if (free_at_once) desk.air().air_free(0, false);
    });
    desk.ask(0_s, 0);
    desk.at(due + 100_ms, [&, free_at_once] {
      if (!free_at_once) desk.air().air_free(0, false);
    });
    desk.run();
    EXPECT_THAT(desk.grants, ElementsAre(Grant{0, due}));
  }
}

TEST(Access, ABackOffIsFrozenWhileTheAirIsTakenAndItsSlotsAreCountedOnce) {
  int frozen = 0;
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    SCOPED_TRACE(seed);
    const std::int64_t slots = back_offs(2, 1, seed)[0];
    // Busy times at half slots or whole ones; the last leaves the air free for good.
    Stream draw(seed, Purpose("busy"), Entity{0});
    struct Busy {
      Duration begin, end;
      bool garbled;
    };
    std::vector<Busy> busy;
    Duration time;
    for (int n = 0; n < 12; ++n) {
      const Duration begin = time + 500_us * static_cast<std::int64_t>(1 + draw.below(40));
      time = begin + 500_us * static_cast<std::int64_t>(1 + draw.below(10));
      busy.push_back({begin, time, draw.bernoulli(0.3)});
    }
    Desk desk(carrier_sense, seed);
    desk.ask(0_s, 0, 2);
    for (const Busy& b : busy) {
      desk.at(b.begin, [&desk] { desk.air().air_taken(0); });
      desk.at(b.end, [&desk, b] { desk.air().air_free(0, b.garbled); });
    }
    desk.run();
    // By slots: each counts if it was free to its end, after the interframe space.
    std::int64_t left = slots;
    Duration slot_begin = 3_ms;
    std::size_t next = 0;
    while (true) {
      // The radio sends at the begin of the slot after those it lets pass, unless the air was
      // taken before.
      if (left == 0 && (next == busy.size() || slot_begin <= busy[next].begin)) break;
      if (next < busy.size() && slot_begin + 1_ms > busy[next].begin) {
        slot_begin = busy[next].end + 3_ms + (busy[next].garbled ? 20_ms : 0_ms);
        ++next;
        ++frozen;
        continue;
      }
      --left;
      slot_begin = slot_begin + 1_ms;
    }
    EXPECT_THAT(desk.grants, ElementsAre(Grant{0, slot_begin}));
  }
  EXPECT_GT(frozen, 1000);
}

TEST(Access, ASlotBeyondTheLastInstantIsNeverGranted) {
  AccessOptions options = aloha;
  options.slot = Duration::seconds(9e9);
  options.send_probability = 0.001;
  Desk slotted(options);
  slotted.ask(1_s, 0);
  slotted.run();
  EXPECT_THAT(slotted.grants, IsEmpty());
  options = carrier_sense;
  options.slot = options.interframe = Duration::seconds(9e9);
  Desk listening(options);
  listening.ask(1_s, 0, 9);
  listening.run();
  EXPECT_THAT(listening.grants, IsEmpty());
}

TEST(Access, OptionsOutsideTheirRangesAreRefusedByName) {
  const auto message = [](AccessOptions options) {
    try {
      const Desk desk(options);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing thrown");
  };
  AccessOptions o = aloha;
  o.slot = Duration();
  EXPECT_THAT(message(o), HasSubstr("slot_s must be greater than 0, not 0"));
  o = aloha;
  o.send_probability = 0.0;
  EXPECT_THAT(message(o), HasSubstr("send_probability must be in [0.001, 1], not 0"));
  o.send_probability = std::nan("");
  EXPECT_THAT(message(o), HasSubstr("send_probability"));
  o = aloha;
  o.slots = -1;
  EXPECT_THAT(message(o), HasSubstr("slots must be at least 1, not -1"));
  o = carrier_sense;
  o.interframe = -1_ns;
  EXPECT_THAT(message(o), HasSubstr("interframe_s must be at least 0"));
  o = carrier_sense;
  o.interframe_garbled = -1_ns;
  EXPECT_THAT(message(o), HasSubstr("interframe_garbled_s must be at least 0"));
  o = carrier_sense;
  o.window_min = 0;
  EXPECT_THAT(message(o), HasSubstr("window_min must be in [1, 65536], not 0"));
  o = carrier_sense;
  o.window_max = 15;
  EXPECT_THAT(message(o), HasSubstr("window_max must be in [window_min, 65536], not 15"));
}

}  // namespace
}  // namespace hearsay
