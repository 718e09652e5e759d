// Everything at once: random radios with whatever can be switched on, random traffic, failures and
// replies; and what must hold all the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "net/link_plan.hpp"
#include "net/movement.hpp"
#include "tests/net/fleet.hpp"
#include "tests/net/link_causes.hpp"

namespace hearsay {
namespace {

constexpr int agents = 7;
constexpr int last_us = 20'000;
constexpr std::size_t bytes_max = 60;
constexpr motion::Rectangle field{{0.0, 0.0}, {300.0, 300.0}};

Time at_us(int us) { return Time::at(1_us * us); }

Propagation random_propagation(Dice& dice, bool powers) {
  const int kind = powers ? 2 : dice.below(3);
  if (kind == 0) return Propagation::disk(120.0);
  if (kind == 1) return Propagation::grey_zone({.inner_m = 60.0, .outer_m = 150.0});
  return Propagation::log_distance({.shadowing_sigma_db = 4.0, .range_m = 150.0});
}

Loss random_loss(Dice& dice) {
  switch (dice.below(3)) {
    case 0:
      return {};
    case 1:
      return Loss::bernoulli(0.2, {{0, 1, 0.9}, {2, 1, 0.0}});
    default:
      return Loss::gilbert_elliott(chain_of({.loss_rate = 0.3, .mean_burst = 4.0}));
  }
}

// How a transmitter queues, and what it makes of a packet.
void choose_transmitter(RadioOptions& options, Dice& dice) {
  options.rate_bps = 8e6;  // a byte a µs
  options.header_bytes = static_cast<std::uint32_t>(dice.below(3));
  if (options.access.sharing != Sharing::none || dice.below(2)) options.mtu_bytes = 25;
  constexpr QueuePolicy policies[] = {QueuePolicy::drop_new, QueuePolicy::drop_oldest,
                                      QueuePolicy::replace};
  options.queue.policy = policies[dice.below(3)];
  options.queue.packets_max = static_cast<std::uint32_t>(1 + dice.below(5));
  if (dice.below(3) == 0) options.queue.bytes_max = bytes_max + 6 + dice.below(60);
  if (dice.below(3) == 0) options.queue.wait_max = 1_us * (50 + dice.below(300));
}

RadioOptions random_options(Dice& dice, bool placed) {
  RadioOptions options;
  options.access.sharing = static_cast<Sharing>(dice.below(4));
  const bool carrier_sense = options.access.sharing == Sharing::carrier_sense;
  options.access.slot = carrier_sense ? 5_us : 30_us;
  options.access.send_probability = dice.below(2) ? 1.0 : 0.4;
  options.access.slots = dice.below(3) * 4;
  options.access.interframe = 1_us * dice.below(9);
  options.access.interframe_garbled = 1_us * dice.below(20);
  options.access.window_min = 1 << dice.below(4);
  options.access.window_max = options.access.window_min << dice.below(4);
  choose_transmitter(options, dice);
  options.half_duplex = dice.below(3) > 0;
  options.latency = 1_us * dice.below(20);
  const int law = dice.below(3);
  options.jitter = {.law = static_cast<JitterOptions::Law>(law),
                    .spread = 1_us * (law ? 1 + dice.below(60) : 0),
                    .reordering = dice.below(2) == 0};
  options.loss = random_loss(dice);
  options.acknowledgement = {.bytes = static_cast<std::uint32_t>(1 + dice.below(9)),
                             .interframe = 1_us * dice.below(5),
                             .attempts_max = 1 + dice.below(5)};
  options.count_links = dice.below(2) == 0;
  if (!placed) return options;
  const bool power = dice.below(2) == 0;
  options.propagation = random_propagation(dice, power);
  if (dice.below(2)) options.propagation_m_per_s = 1e8;
  if (dice.below(2)) options.capture_db = 3.0;
  Jammer jammer{.position_m = {100.0, 100.0, 0.0}, .from = at_us(dice.below(last_us))};
  if (power) {
    jammer.power_dbm = -10.0;
  } else {
    jammer.radius_m = 70.0;
  }
  if (dice.below(2)) {
    jammer.period = 1_ms;
    jammer.duty = 0.4;
  }
  options.jammers = {jammer};
  return options;
}

// One run, and all that was seen of it.
class Storm {
 public:
  explicit Storm(std::uint64_t seed)
      : dice_(seed),
        placed_(dice_.below(2) == 0),
        options_(random_options(dice_, placed_)),
        end_(at_us(last_us - dice_.below(3) * 300)),
        simulation_(
            {.seed = seed, .end = end_, .record = {.keep_messages = true, .digest = &digest}}) {
    build(seed);
    for (AgentId a = 0; a < agents; ++a) {
      ears_.push_back(std::make_unique<Ear>(*this));
      radio->attach(a, *ears_.back());
      downs_.emplace_back();
    }
    plan_traffic();
    plan_failures();
    const RunEnd ended = simulation_.run();
    EXPECT_TRUE(ended.ok()) << ended.message;
    radio->finish();
    simulation_.record().finish();
  }

  void expect_all_sound() {
    expect_one_fate_each();
    expect_counts();
    expect_heard();
    expect_outcomes();
    expect_order();
  }

  FnvDigest digest;
  std::map<std::string, int> seen;  // fates

 private:
  using Key = std::pair<Time, AgentId>;  // a packet by when and by whom it was handed over
  struct Handed {
    AgentId to;
    std::string text;
    bool acknowledged;
  };
  class Ear final : public Receiver {
   public:
    explicit Ear(Storm& storm) : storm_(storm) {}
    void on_packet(const Packet& p) override { storm_.hear(p); }
    void on_outcome(const Packet& p, bool acknowledged) override { storm_.told(p, acknowledged); }

   private:
    Storm& storm_;
  };

  void build(std::uint64_t seed) {
    Reach reach{.topology = Topology::full(agents)};
    if (placed_) {
      motions_ = std::make_unique<Motions>(agents, [&](AgentId a) {
        return motion::make(motion::GaussMarkov{.area = field,
                                                .speed_mean_m_per_s = 3000.0,
                                                .speed_sigma_m_per_s = 500.0,
                                                .direction_sigma_rad = 2.0,
                                                .alpha = 0.5,
                                                .update_period = 3_ms},
                            seed, a);
      });
      places_ = std::make_unique<Places>(agents, options_.propagation.reach_m(), 20.0);
      movement_ = std::make_unique<Movement>(simulation_, *places_, *motions_);
      reach = {.topology = Topology::edges(agents, {}), .places = places_.get(), .by_place = true};
    } else if (dice_.below(3)) {
      LinkCauses causes;
      causes.partitions = {{.groups = random_groups(agents, dice_),
                            .from = at_us(dice_.below(last_us)),
                            .until = at_us(last_us)}};
      causes.outages = {{0, 1, at_us(100), at_us(dice_.below(last_us) + 101)}};
      causes.rotations = {{.groups = random_groups(agents, dice_),
                           .period = 1_us * 1500,
                           .cut = 1_us * (1 + dice_.below(1500)),
                           .until = at_us(last_us)}};
      LinkPlan plan = plan_links(Topology::ring(agents), causes);
      reach = {.topology = std::move(plan.topology), .changes = std::move(plan.changes)};
    }
    radio = std::make_unique<Radio>(simulation_, std::move(reach), options_);
  }
  void plan_traffic() {
    const int packets = 100 + dice_.below(300);
    for (int n = 0; n < packets; ++n) {
      const auto from = static_cast<AgentId>(dice_.below(agents));
      simulation_.schedule(at_us(dice_.below(last_us)), Phase::act, [this, from] { send(from); });
    }
  }
  void plan_failures() {
    for (int n = dice_.below(12); n > 0; --n) {
      const auto agent = static_cast<AgentId>(dice_.below(agents));
      const int from = dice_.below(last_us), until = from + 1 + dice_.below(2000);
      // (Two of one agent may overlap: the first that ends brings it back.)
      simulation_.schedule(at_us(from), Phase::world, [this, agent] { set_up(agent, false); });
      simulation_.schedule(at_us(until), Phase::world, [this, agent] { set_up(agent, true); });
    }
  }
  void set_up(AgentId agent, bool up) {
    auto& spans = downs_[static_cast<std::size_t>(agent)];
    if (up == radio->up(agent)) return;
    if (up) {
      spans.back().second = simulation_.now();
    } else {
      spans.emplace_back(simulation_.now(), Time::never());
    }
    radio->set_up(agent, up);
  }
  bool down_at(AgentId agent, Time time) const {
    const auto& spans = downs_[static_cast<std::size_t>(agent)];
    return std::any_of(spans.begin(), spans.end(),
                       [&](const auto& span) { return span.first <= time && time < span.second; });
  }

  void send(AgentId from) {
    const Key key{simulation_.now(), from};
    if (handed_.contains(key)) return;
    const int receiver = dice_.below(2 * agents);
    Handed packet{receiver < agents ? receiver : no_agent, "", false};
    packet.acknowledged = packet.to != no_agent && dice_.below(2) == 0;
    packet.text = std::to_string(key.first.nanoseconds()) + "/" + std::to_string(from) + ":";
    packet.text.resize(packet.text.size() + static_cast<std::size_t>(dice_.below(30)), 'x');
    ASSERT_LE(packet.text.size(), bytes_max);
    std::optional<std::uint64_t> tick;
    if (dice_.below(2)) tick = handed_.size() / 3;
    handed_[key] = packet;
    radio->send(from, {.bytes = bytes_of(packet.text),
                       .receiver = packet.to,
                       .tick = tick,
                       .subject = static_cast<std::uint64_t>(dice_.below(2)),
                       .acknowledged = packet.acknowledged});
  }
  void hear(const Packet& p) {
    const Key key{p.sent, p.sender};
    ASSERT_TRUE(handed_.contains(key));
    EXPECT_EQ(text_of(p.bytes), handed_[key].text);
    EXPECT_FALSE(down_at(p.receiver, simulation_.now())) << "the dead hear";
    EXPECT_TRUE(heard_[key].emplace(p.receiver, simulation_.now()).second) << "heard twice";
    if (dice_.below(4) == 0) send(p.receiver);
  }
  void told(const Packet& p, bool acknowledged) {
    const Key key{p.sent, p.sender};
    EXPECT_TRUE(handed_.at(key).acknowledged);
    EXPECT_TRUE(outcomes_.emplace(key, acknowledged).second) << "told twice";
    EXPECT_TRUE(!acknowledged || heard_[key].contains(p.receiver)) << "acknowledged but not heard";
    if (dice_.below(4) == 0) send(p.sender);
  }

  const std::string& text(NameId name) const { return simulation_.record().text(name); }

  void expect_one_fate_each() {
    for (const MessageRow& row : simulation_.record().messages()) {
      const Key key{row.sent, row.sender};
      ASSERT_TRUE(handed_.contains(key));
      EXPECT_EQ(row.bytes, handed_[key].text.size());
      EXPECT_TRUE(rows_[key].emplace(row.receiver, &row).second) << "a second fate";
      ++seen[text(row.fate)];
    }
    for (const auto& [key, packet] : handed_) {
      std::set<AgentId> expected, got;
      for (const auto& [receiver, row] : rows_[key]) got.insert(receiver);
      if (packet.to != no_agent) {
        expected = {packet.to};
      } else if (placed_) {  // who was near when it left
        EXPECT_FALSE(got.contains(key.second));
        continue;
      } else {
        const auto neighbours = radio->topology().neighbours(key.second);
        expected = {neighbours.begin(), neighbours.end()};
      }
      EXPECT_EQ(got, expected);
    }
  }
  void expect_counts() {
    std::map<std::pair<AgentId, std::string>, std::uint64_t> by_sender;
    std::map<std::pair<AgentId, AgentId>, std::map<std::string, std::uint64_t>> by_link, links;
    std::map<AgentId, std::uint64_t> packets;
    for (const auto& [key, packet] : handed_) ++packets[key.second];
    for (const MessageRow& row : simulation_.record().messages()) {
      ++by_sender[{row.sender, text(row.fate)}];
      const bool link = placed_ || radio->topology().link(row.sender, row.receiver) >= 0;
      if (link) ++by_link[{row.sender, row.receiver}][text(row.fate)];
    }
    for (AgentId a = 0; a < agents; ++a) {
      const SenderCounts& counts = radio->counts(a);
      EXPECT_EQ(counts.packets, packets[a]);
      EXPECT_LE(counts.air_time, end_ - Time());
      EXPECT_GE(counts.air_time, Duration());
      EXPECT_LE(counts.begun, counts.packets);
      for (int f = 0; f < fate_count; ++f) {
        const std::string name = to_string(static_cast<Fate>(f));
        EXPECT_EQ(counts.fates[static_cast<std::size_t>(f)], (by_sender[{a, name}])) << name;
      }
    }
    if (!options_.count_links) return;
    radio->visit_links([&](AgentId from, AgentId to, const FateCounts& fates) {
      for (int f = 0; f < fate_count; ++f) {
        const std::uint64_t n = fates[static_cast<std::size_t>(f)];
        if (n > 0) links[{from, to}][to_string(static_cast<Fate>(f))] = n;
      }
    });
    EXPECT_EQ(links, by_link);
  }
  void expect_heard() {
    for (const auto& [key, receivers] : rows_) {
      for (const auto& [receiver, row] : receivers) {
        const bool delivered = text(row->fate) == "delivered";
        EXPECT_EQ(heard_[key].contains(receiver), delivered);
        if (!delivered) continue;
        EXPECT_EQ(heard_[key].at(receiver), row->arrived);
        EXPECT_FALSE(down_at(key.second, key.first)) << "the dead speak";
      }
    }
    for (const auto& [key, receivers] : heard_) {
      for (const auto& [receiver, at] : receivers) EXPECT_TRUE(rows_[key].contains(receiver));
    }
  }
  // Whoever wants an acknowledgement is told once of what was sent, unless the run ended first.
  void expect_outcomes() {
    for (const auto& [key, packet] : handed_) {
      if (!packet.acknowledged) continue;
      const auto outcome = outcomes_.find(key);
      const std::string& fate = text(rows_.at(key).at(packet.to)->fate);
      if (fate == "queue_full" || fate == "replaced" || fate == "expired" ||
          fate == "in_flight_at_end") {
        EXPECT_EQ(outcome, outcomes_.end()) << fate;
      } else if (fate != "delivered" && fate != "sender_down") {
        EXPECT_TRUE(outcome != outcomes_.end() && !outcome->second) << fate;
      }
    }
  }
  // In order, what a link delivers comes as it left; a queue that replaces sends newer news first.
  void expect_order() {
    const bool jitter = options_.jitter.law != JitterOptions::Law::none;
    if (jitter ? options_.jitter.reordering : placed_) return;
    if (options_.queue.policy == QueuePolicy::replace) return;
    std::map<std::pair<AgentId, AgentId>, Time> last;
    for (const auto& [key, receivers] : rows_) {
      for (const auto& [receiver, row] : receivers) {
        if (text(row->fate) != "delivered") continue;
        const auto [before, first] = last.emplace(std::pair{key.second, receiver}, row->arrived);
        EXPECT_TRUE(first || before->second < row->arrived) << "out of order";
        before->second = row->arrived;
      }
    }
  }

  Dice dice_;
  bool placed_;
  RadioOptions options_;
  Time end_;
  Simulation simulation_;
  std::unique_ptr<Motions> motions_;
  std::unique_ptr<Places> places_;
  std::unique_ptr<Movement> movement_;
  std::vector<std::unique_ptr<Ear>> ears_;
  std::vector<std::vector<std::pair<Time, Time>>> downs_;
  std::map<Key, Handed> handed_;
  std::map<Key, std::map<AgentId, Time>> heard_;
  std::map<Key, bool> outcomes_;
  std::map<Key, std::map<AgentId, const MessageRow*>> rows_;
  std::unique_ptr<Radio> radio;
};

TEST(RadioStorm, WhateverIsSwitchedOnEachPacketHasItsFatesAndRunsRepeat) {
  std::map<std::string, int> seen;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Storm storm(seed);
    storm.expect_all_sound();
    EXPECT_EQ(storm.digest.hash, Storm(seed).digest.hash) << "two runs differ";
    for (const auto& [fate, n] : storm.seen) seen[fate] += n;
    if (HasFailure()) return;
  }
  for (int f = 0; f < fate_count; ++f) {
    const char* const fate = to_string(static_cast<Fate>(f));
    EXPECT_GT(seen[fate], 50) << fate << " is not put to the test";
  }
}

}  // namespace
}  // namespace hearsay
