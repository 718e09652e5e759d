// Transmitters and ways to share the channel that cannot be: refused with file, line, key, value
// and what is allowed, before anything runs.
#include <gtest/gtest.h>

#include <string>

#include "tests/scenarios/temp_files.hpp"

namespace hearsay {
namespace {

class TransmitterChecks : public InTempDirectory {
 protected:
  // Lines of [radio] begin on line 3. Four agents on a circle that measure one target; their
  // messages have 76 bytes.
  static std::string error(const std::string& radio, const std::string& agent = "") {
    write("s.toml", "duration_s = 10\n[radio]\n" + radio + R"(
[world]
targets = [{ position_m = [0, 50] }]
[[agents]]
name = "a"
count = 4
circle = { radius_m = 10 }
sensor = { kind = "position", sigma_m = 5 }
estimator = { fusion = "naive" }
)" + agent);
    return error_of([] { load_scenario("s.toml", {}, {}); });
  }
  static inline const std::string acknowledged = "talk = { service = \"acknowledged\" }\n";
};

TEST_F(TransmitterChecks, AQueueHoldsAPacket) {
  EXPECT_EQ(error("queue_bytes_max = 75"),
            "s.toml:3: radio.queue_bytes_max = 75: smaller than one packet: a message of all "
            "beliefs, or a summary, takes 76 bytes with headers");
  EXPECT_EQ(error("queue_bytes_max = 76"), "no error");
  EXPECT_EQ(error("mtu_bytes = 20\nheader_bytes = 10\nqueue_bytes_max = 115"),
            "s.toml:5: radio.queue_bytes_max = 115: smaller than one packet: a message of all "
            "beliefs, or a summary, takes 116 bytes with headers");
  EXPECT_EQ(error("mtu_bytes = 20\nheader_bytes = 10\nqueue_bytes_max = 116"), "no error");
  EXPECT_EQ(error("queue_packets_max = 0"),
            "s.toml:3: radio.queue_packets_max = 0: must be between 1 and 1000000");
}

TEST_F(TransmitterChecks, WhoSensesTheAirWaitsForAcknowledgements) {
  const auto sensing = [](const std::string& space) {
    return "latency_s = 0.001\nacknowledgement = { interframe_s = 0.002 }\n"
           "sharing = { model = \"carrier-sense\", slot_s = 1e-5, interframe_s = " +
           space + " }";
  };
  EXPECT_EQ(error(sensing("0.003"), acknowledged),
            "s.toml:5: radio.sharing.interframe_s = 0.003: with acknowledged packets must be above "
            "acknowledgement.interframe_s + latency_s (0.003), or others begin before the "
            "acknowledgement");
  EXPECT_EQ(error(sensing("0.00301"), acknowledged), "no error");
  EXPECT_EQ(error(sensing("0.0")), "no error");
}

TEST_F(TransmitterChecks, ASlotHoldsAFrame) {
  const std::string frame = "rate_bps = 1e6\nheader_bytes = 25\nmtu_bytes = 100\n";  // 1 ms
  for (const std::string model : {"slotted-aloha", "tdma"}) {
    const auto slot = [&](const std::string& s, const std::string& more = "") {
      return more + frame + "sharing = { model = \"" + model + "\", slot_s = " + s + " }";
    };
    EXPECT_EQ(error(slot("0.000999")),
              "s.toml:6: radio.sharing.slot_s = 0.000999: shorter than a frame, which takes 0.001 "
              "s");
    EXPECT_EQ(error(slot("0.000999999")),
              "s.toml:6: radio.sharing.slot_s = 0.000999999: shorter than a frame, which takes "
              "0.001 s");
    EXPECT_EQ(error(slot("0.001")), "no error");
    // 5 ms until it arrives, 2 ms of jitter at most, 1 ms of silence, 2 ms of answer.
    const std::string answer =
        "latency_s = 0.005\njitter = { law = \"uniform\", spread_s = 0.002 }\n"
        "acknowledgement = { bytes = 250, interframe_s = 0.001 }\n";
    EXPECT_EQ(error(slot("0.01", answer), acknowledged),
              "s.toml:9: radio.sharing.slot_s = 0.01: shorter than a frame, which takes 0.011 s "
              "with latency and acknowledgement");
    EXPECT_EQ(error(slot("0.011", answer), acknowledged), "no error");
    EXPECT_EQ(error(slot("0.001", answer)), "no error");
    EXPECT_EQ(error("sharing = { model = \"" + model + "\", slot_s = 1 }"),
              "s.toml:3: radio.sharing.model: \"" + model +
                  "\" needs radio.mtu_bytes, which says how long a frame can be");
    EXPECT_EQ(error("mtu_bytes = 100\nsharing = { model = \"" + model + "\" }"),
              "s.toml:4: radio.sharing.slot_s: model = \"" + model + "\" needs a slot above 0 s");
  }
}

TEST_F(TransmitterChecks, AWayOfSharingHasItsOwnKeys) {
  const auto sharing = [](const std::string& model, const std::string& key) {
    const std::string slot = model == "none" ? "" : ", slot_s = 0.1";
    return error("mtu_bytes = 100\nsharing = { model = \"" + model + "\"" + slot + ", " + key +
                 " }");
  };
  struct Key {
    std::string name, value, model;
  };
  for (const Key& key :
       {Key{"send_probability", "0.5", "slotted-aloha"}, Key{"slots", "9", "tdma"},
        Key{"interframe_s", "0.1", "carrier-sense"}, Key{"window_min", "8", "carrier-sense"},
        Key{"window_max", "64", "carrier-sense"}}) {
    for (const std::string model : {"none", "slotted-aloha", "carrier-sense", "tdma"}) {
      EXPECT_EQ(sharing(model, key.name + " = " + key.value),
                model == key.model
                    ? "no error"
                    : "s.toml:4: radio.sharing." + key.name + ": only for model = \"" + key.model +
                          "\"; found \"" + model + "\"");
    }
  }
  EXPECT_EQ(error("sharing = { slot_s = 1 }"),
            "s.toml:3: radio.sharing.slot_s: without effect; set radio.sharing.model, too");
  EXPECT_EQ(sharing("carrier-sense", "window_min = 64, window_max = 32"),
            "s.toml:4: radio.sharing.window_max: must not be below window_min (64)");
}

TEST_F(TransmitterChecks, CaptureNeedsPlaces) {
  const std::string capture =
      "sharing = { model = \"carrier-sense\", slot_s = 1e-5, capture_db = 6 }\n";
  EXPECT_EQ(error("topology = \"ring\"\n" + capture),
            "s.toml:4: radio.sharing.capture_db: only for topology = \"disk\", \"by-position\" or "
            "\"random-geometric\", which know how strong a frame is; found \"ring\"");
  EXPECT_EQ(error("topology = \"disk\"\nrange_m = 9\n" + capture), "no error");
  EXPECT_EQ(error("sharing = { capture_db = 6 }"),
            "s.toml:3: radio.sharing.capture_db: without effect: with sharing.model = \"none\" "
            "frames do not meet");
}

TEST_F(TransmitterChecks, KeysWithoutEffectAreRefused) {
  EXPECT_EQ(error("topology = \"ring\"\nrange_m = 5"),
            "s.toml:4: radio.range_m: only for topology = \"disk\" or \"random-geometric\"; found "
            "\"ring\"");
  EXPECT_EQ(error("jitter = { spread_s = 1 }"),
            "s.toml:3: radio.jitter.spread_s: without effect; set radio.jitter.law, too");
  EXPECT_EQ(
      error("topology = \"line\"\n"
            "loss = { model = \"bernoulli\", links = [{ from = 0, to = 1, probability = 1 },\n"
            "  { from = \"a3\", to = 1, probability = 0.5 }] }"),
      "s.toml:5: radio.loss.links[1] = { from = \"a3\", to = 1, probability = 0.5 }: there "
      "is no such link in the topology \"line\"");
}

}  // namespace
}  // namespace hearsay
