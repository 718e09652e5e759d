// Pairing: the same packets are lost under every fusion rule, whatever its messages are. Whole
// scenarios, compared packet by packet.
//
// More targets make longer messages. Without an MTU a packet is one frame, so lengths do not matter
// to a loss a frame; with one, a longer packet has more frames and meets the draws of the shorter
// and then some more: it is lost wherever the shorter one is. The same holds where length matters
// by itself, under log-distance.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <tuple>

#include "scenarios/run.hpp"
#include "tests/scenarios/temp_files.hpp"

namespace hearsay {
namespace {

// By sender, receiver and the time of the talk.
using Fates = std::map<std::tuple<AgentId, AgentId, std::int64_t>, std::string>;

struct Table {
  Fates fates;
  std::uint32_t bytes = 0;  // of a message
};

class Pairing : public InTempDirectory {
 protected:
  static Table run(const std::string& radio, const std::string& rule, int targets,
                   std::uint64_t seed = 3, const std::string& talk = "period_s = 1") {
    std::string world;
    for (int t = 0; t < targets; ++t) {
      world += "{ position_m = [" + std::to_string(10 * t) + ", 300] }, ";
    }
    write("s.toml", "duration_s = 200\nworld = { targets = [" + world + "] }\n[radio]\n" + radio +
                        R"(
[record]
messages = "all"
[[agents]]
count = 5
circle = { radius_m = 60 }
sensor = { kind = "position", sigma_along_m = 5, sigma_across_m = 1 }
estimator = { fusion = ")" +
                        rule + "\" }\ntalk = { " + talk + " }\n");
    const Catalog catalog;
    LogCache logs;
    hearsay::Run run(prepare(load_scenario("s.toml", {}, known_names(catalog)), catalog, logs),
                     catalog, {.seed = seed});
    const RunEnd end = run.run();
    EXPECT_TRUE(end.ok()) << end.message;
    Table table;
    for (const MessageRow& row : run.record().messages()) {
      table.fates[{row.sender, row.receiver, row.sent.nanoseconds()}] = run.record().text(row.fate);
      table.bytes = std::max(table.bytes, row.bytes);
    }
    return table;
  }
  static int count(const Table& table, const std::string& fate) {
    int n = 0;
    for (const auto& [key, f] : table.fates) n += f == fate ? 1 : 0;
    return n;
  }
};

const char* const rules[] = {"naive",  "channel",  "channel-robust",
                             "ci-det", "ci-trace", "local-update"};

const std::map<std::string, std::string> losses = {
    {"bernoulli", "loss = { model = \"bernoulli\", probability = 0.3 }\n"},
    {"bursts", "loss = { model = \"gilbert-elliott\", probability = 0.3, mean_burst = 5 }\n"},
    {"links",
     "loss = { model = \"bernoulli\", probability = 0.1, "
     "links = [{ from = 0, to = 1, probability = 0.8 }] }\n"}};

TEST_F(Pairing, AllRulesMeetTheSameLossesWhateverTheirMessagesAre) {
  for (const auto& [name, loss] : losses) {
    SCOPED_TRACE(name);
    const std::string radio = "topology = \"ring\"\nlatency_s = 0.01\n" + loss;
    const Table reference = run(radio, "naive", 1);
    EXPECT_GT(count(reference, "lost"), 200);
    EXPECT_GT(count(reference, "delivered"), 1000);
    for (const char* const rule : rules) {
      for (const int targets : {1, 3}) {
        SCOPED_TRACE(testing::Message() << rule << ", " << targets << " targets");
        const Table table = run(radio, rule, targets);
        EXPECT_EQ(table.fates, reference.fates);
        EXPECT_TRUE(targets == 1 || table.bytes > 2 * reference.bytes) << "equally long";
      }
    }
    EXPECT_NE(run(radio, "naive", 1, 4).fates, reference.fates) << "seeds do not matter";
  }
}

TEST_F(Pairing, AcknowledgedTalkMeetsTheSameLossesUnderAllRules) {
  // Repetitions have draws of their own, so the first attempts are not shifted by them.
  const std::string radio =
      "topology = \"ring\"\nlatency_s = 0.001\nloss = { model = \"bernoulli\", probability = 0.5 "
      "}\nacknowledgement = { attempts_max = 2 }\n";
  const auto acknowledged = [&](const std::string& rule, int targets) {
    return run(radio, rule, targets, 3, "period_s = 1, service = \"acknowledged\"");
  };
  const Table reference = acknowledged("naive", 1);
  EXPECT_GT(count(reference, "lost"), 200);
  for (const char* const rule : {"channel", "ci-det"}) {
    EXPECT_EQ(acknowledged(rule, 3).fates, reference.fates);
  }
}

// Where the shorter message was lost the longer one is, too.
void expect_superset(const Table& shorter, const Table& longer, int more_at_least) {
  ASSERT_GT(longer.bytes, shorter.bytes);
  ASSERT_EQ(longer.fates.size(), shorter.fates.size());
  int more = 0;
  for (const auto& [key, fate] : shorter.fates) {
    const std::string& other = longer.fates.at(key);
    EXPECT_TRUE(fate != "lost" || other == "lost") << "it is " << other;
    if (fate == "delivered" && other == "lost") ++more;
  }
  EXPECT_GE(more, more_at_least);
}

TEST_F(Pairing, WithAnMtuLongerMessagesLoseThoseOfShorterOnesAndMore) {
  for (const auto& [name, loss] : losses) {
    SCOPED_TRACE(name);
    const std::string radio = "topology = \"ring\"\nmtu_bytes = 80\n" + loss;
    const Table one = run(radio, "naive", 1);
    // In the bad state of these bursts all frames are lost, in the good one none: no more for more.
    expect_superset(one, run(radio, "channel", 3), name == "bursts" ? 0 : 50);
    EXPECT_EQ(run(radio, "channel-robust", 3).fates, run(radio, "ci-det", 3).fates);
  }
}

TEST_F(Pairing, UnderLogDistanceLongerMessagesLoseThoseOfShorterOnesAndMore) {
  const std::string radio =
      "topology = \"by-position\"\npropagation = { model = \"log-distance\", exponent = 3, "
      "transmit_dbm = 5, noise_dbm = -106, shadowing_sigma_db = 3, range_m = 300 }\n";
  const Table one = run(radio, "naive", 1);
  EXPECT_GT(count(one, "lost"), 100);
  EXPECT_GT(count(one, "delivered"), 100);
  expect_superset(one, run(radio, "channel", 3), 20);
  EXPECT_EQ(run(radio, "channel-robust", 1).fates, one.fates);
}

}  // namespace
}  // namespace hearsay
