// Links that come and go, in whole runs, against brute force over every instant.
//
// A nanosecond is a byte: a packet is on its way from its first bit to its arrival, both included,
// and gets through if its link is allowed at each of these instants.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "net/link_plan.hpp"
#include "tests/net/bed.hpp"
#include "tests/net/link_causes.hpp"

namespace hearsay {
namespace {

constexpr int agents = 6, last = 400;

// What was handed over, and when it is on the air.
struct Handed {
  AgentId to;
  Time begin, end;
};

class Storm {
 public:
  Storm(LinkPlan plan, const RadioOptions& options, std::uint64_t seed)
      : simulation_({.seed = seed, .record = {.keep_messages = true}}),
        radio_(simulation_,
               Reach{.topology = std::move(plan.topology), .changes = std::move(plan.changes)},
               options) {
    Dice dice(seed + 1000);
    std::map<std::pair<Time, AgentId>, bool> taken;  // each is known by when it was handed over
    for (int n = 0; n < 120; ++n) {
      const auto from = static_cast<AgentId>(dice.below(agents));
      const Time at = dice.instant(last);
      const int bytes = 1 + dice.below(9), to = dice.below(2 * agents);
      if (!std::exchange(taken[{at, from}], true)) {
        talks_[at].push_back({from, bytes, to < agents ? to : no_agent});
      }
    }
    for (const auto& talks : talks_) {
      simulation_.schedule(talks.first, Phase::act, [this, &talks] {
        for (const Talk& talk : talks.second) {
          const std::string text(static_cast<std::size_t>(talk.bytes), 'x');
          radio_.send(talk.from, {.bytes = bytes_of(text), .receiver = talk.to});
        }
      });
    }
    simulation_.run();
    radio_.finish();
  }

  // When each was on the air, worked out from what was handed over alone.
  std::map<std::pair<Time, AgentId>, Handed> handed() const {
    std::map<std::pair<Time, AgentId>, Handed> all;
    std::map<AgentId, Time> free;
    for (const auto& [at, talks] : talks_) {
      for (const Talk& talk : talks) {
        const Time begin = std::max(at, free[talk.from]);
        free[talk.from] = begin + Duration::nanoseconds(talk.bytes);
        all[{at, talk.from}] = {talk.to, begin, free[talk.from]};
      }
    }
    return all;
  }
  const Simulation& simulation() const { return simulation_; }
  Radio& radio() { return radio_; }

 private:
  struct Talk {
    AgentId from;
    int bytes;
    AgentId to;
  };
  std::map<Time, std::vector<Talk>> talks_;
  Simulation simulation_;
  Radio radio_;
};

// Checks each row; `up(a, b, time)` says whether the link is there. Returns how many of each fate.
template <class Up>
std::map<std::string, int> expect_rows(const Storm& storm, const Topology& graph, Up up) {
  std::map<std::string, int> seen;
  std::map<std::pair<Time, AgentId>, std::map<AgentId, int>> fates;
  const auto handed = storm.handed();
  for (const MessageRow& row : storm.simulation().record().messages()) {
    const Handed& packet = handed.at({row.sent, row.sender});
    EXPECT_GE(row.arrived, packet.end);
    bool always = graph.link(row.sender, row.receiver) >= 0;
    for (Time t = packet.begin; t <= row.arrived; t = t + 1_ns) {
      always = always && up(row.sender, row.receiver, t);
    }
    const std::string& fate = storm.simulation().record().text(row.fate);
    EXPECT_EQ(fate, always ? "delivered" : "out_of_range")
        << row.sender << " → " << row.receiver << ", " << packet.begin.nanoseconds() << " … "
        << row.arrived.nanoseconds() << " ns";
    ++seen[fate];
    EXPECT_EQ(++(fates[{row.sent, row.sender}][row.receiver]), 1) << "a second fate";
  }
  for (const auto& [key, packet] : handed) {
    const std::size_t potential = packet.to != no_agent ? 1 : graph.neighbours(key.second).size();
    const auto found = fates.find(key);
    EXPECT_EQ(found == fates.end() ? 0 : found->second.size(), potential);
  }
  return seen;
}

RadioOptions options_of(std::uint64_t seed) {
  RadioOptions options{.rate_bps = 8e9, .queue = {.packets_max = 1000}, .latency = 4_ns};
  if (seed % 3 == 1) options.jitter = {.law = JitterOptions::Law::uniform, .spread = 30_ns};
  if (seed % 3 == 2) {
    options.jitter = {.law = JitterOptions::Law::exponential, .spread = 10_ns, .reordering = false};
  }
  options.half_duplex = false;
  return options;
}

TEST(RadioPartition, StormsOfCausesDeliverWhatBruteForceAllows) {
  std::map<std::string, int> seen;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const LinkCauses causes = random_causes(agents, last, dice);
    const Topology graph = seed % 2 ? Topology::full(agents) : Topology::ring(agents);
    const Storm storm(plan_links(graph, causes), options_of(seed), seed);
    for (const auto& [fate, n] : expect_rows(storm, graph, [&](AgentId a, AgentId b, Time t) {
           return allowed(causes, a, b, t);
         })) {
      seen[fate] += n;
    }
  }
  EXPECT_GT(seen["delivered"], 3000);
  EXPECT_GT(seen["out_of_range"], 3000);
}

TEST(RadioPartition, StormsOfContactsDeliverWhatBruteForceAllows) {
  std::map<std::string, int> seen;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const std::vector<LinkChange> trace = random_trace(agents, last, dice);
    const LinkCauses causes = seed % 4 == 0 ? random_causes(agents, last, dice) : LinkCauses{};
    LinkPlan plan = plan_contacts(agents, trace, causes);
    const Topology graph = plan.topology;
    const Storm storm(std::move(plan), options_of(seed), seed);
    for (const auto& [fate, n] : expect_rows(storm, graph, [&](AgentId a, AgentId b, Time t) {
           return in_contact(trace, a, b, t) && allowed(causes, a, b, t);
         })) {
      seen[fate] += n;
    }
  }
  EXPECT_GT(seen["delivered"], 1500);
  EXPECT_GT(seen["out_of_range"], 1500);
}

TEST(RadioPartition, NothingCrossesAPartitionHoweverItIsSent) {
  // All ways to share the air, broadcasts and acknowledged packets: what is heard comes from the
  // hearer's own group, and the groups disturb each other as little as if they were apart.
  for (const Sharing sharing :
       {Sharing::none, Sharing::slotted_aloha, Sharing::carrier_sense, Sharing::tdma}) {
    SCOPED_TRACE(static_cast<int>(sharing));
    LinkCauses causes;
    causes.partitions = {{.groups = {{0, 1, 2}, {3, 4, 5}}}};
    RadioOptions options{.rate_bps = 8e6,
                         .queue = {.packets_max = 1000},
                         .half_duplex = sharing != Sharing::none,
                         .access = {.sharing = sharing,
                                    .slot = sharing == Sharing::carrier_sense ? 10_us : 150_us,
                                    .send_probability = 0.4,
                                    .interframe = 20_us,
                                    .interframe_garbled = 30_us},
                         .acknowledgement = {.bytes = 10, .interframe = 10_us, .attempts_max = 4}};
    const auto run = [&](const Topology& graph, const LinkCauses& why, AgentId senders) {
      LinkPlan plan = plan_links(graph, why);
      Simulation simulation({.seed = 3, .record = {.keep_messages = true}});
      Radio radio(simulation,
                  Reach{.topology = std::move(plan.topology), .changes = std::move(plan.changes)},
                  options);
      Dice dice(9);
      for (int n = 0; n < 600; ++n) {
        const AgentId from = dice.below(agents), to = dice.below(2 * agents);
        const bool safely = to < agents && dice.below(2) == 0;
        const Time at = Time::at(10_us * dice.below(20'000));
        if (from >= senders) continue;
        simulation.schedule(at, Phase::act, [&radio, from, to, safely] {
          radio.send(from, {.bytes = bytes_of("eighty bytes of text would be a long sentence"),
                            .receiver = to < agents ? to : no_agent,
                            .acknowledged = safely && to != from});
        });
      }
      simulation.run();
      radio.finish();
      // Who heard what when, of the first group.
      std::vector<std::string> heard;
      for (const MessageRow& row : simulation.record().messages()) {
        const bool delivered = simulation.record().text(row.fate) == "delivered";
        EXPECT_TRUE(!delivered || row.sender / 3 == row.receiver / 3) << "across";
        if (row.sender > 2 || row.receiver > 2) continue;
        heard.push_back(std::to_string(row.sender) + ">" + std::to_string(row.receiver) + "@" +
                        std::to_string(row.arrived.nanoseconds()) + " " +
                        simulation.record().text(row.fate));
      }
      return heard;
    };
    const std::vector<std::string> both = run(Topology::full(agents), causes, agents);
    EXPECT_GT(both.size(), 200u);
    EXPECT_EQ(both, run(Topology::full(agents), causes, 3)) << "the other group disturbs";
  }
}

}  // namespace
}  // namespace hearsay
