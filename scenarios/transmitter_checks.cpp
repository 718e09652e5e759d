// What must fit together in the transmitter, and in how the channel is shared.
#include <algorithm>
#include <optional>
#include <string>

#include "net/link_draw.hpp"
#include "scenarios/estimators.hpp"
#include "scenarios/scenario_under_check.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {
namespace {

// The largest message of the built-in agents, in bytes, that of a trajectory of one instant
// counted; 0 if there are none.
std::size_t message_bytes_max(const Scenario& scenario) {
  const bool estimates = std::any_of(scenario.agents.begin(), scenario.agents.end(),
                                     [](const AgentSpec& a) { return a.kind == "estimator"; });
  if (!estimates || scenario.world.targets.empty()) return 0;
  std::size_t most = 0;
  for (const AgentSpec& agent : scenario.agents) {
    if (agent.kind != "estimator") continue;
    const bool moves = agent.estimator.kind != "static-gaussian";
    const std::size_t size =
        gaussian::encoded_size(message_form_of(agent), scenario.world.targets.size(), moves ? 4 : 2,
                               agent.talk.bits.value_or(8));
    most = std::max(most, moves ? size + gaussian::stamp_bytes : size);
  }
  return most;
}

// The largest packet of a forager that talks, in bytes; 0 if there are none.
std::size_t crumbs_bytes_max(const Scenario& scenario) {
  int most = 0;
  for (const AgentSpec& agent : scenario.agents) {
    if (!agent.trails || agent.talk.policy == "never") continue;
    most = std::max(most, agent.trails->packet_bytes_max);
  }
  return static_cast<std::size_t>(most);
}

// What a service makes of a message of so many bytes; its summaries are packets, too.
std::size_t carried_bytes_max(const Scenario& scenario, std::size_t message) {
  const std::string& service = scenario.agents.front().talk.service;  // as all others have
  if (!is_gossip(service)) return message;
  const auto summary = static_cast<std::size_t>(scenario.radio.gossip.summary_bytes_max);
  return std::max(summary, message + gossip_header_bytes);
}

[[noreturn]] void refuse(const ScenarioUnderCheck& file, const KeyPath& path,
                         const std::string& why) {
  reject(file.locate(path), path, why);
}

void check_queue(const ScenarioUnderCheck& file, const KeyPath& path) {
  const RadioSpec& radio = file.scenario.radio;
  if (!radio.queue_bytes_max) return;
  const std::size_t crumbs = crumbs_bytes_max(file.scenario);
  const std::size_t message =
      std::max(crumbs, carried_bytes_max(file.scenario, message_bytes_max(file.scenario)));
  const auto mtu = static_cast<std::size_t>(radio.mtu_bytes.value_or(1 << 30));
  const std::size_t frames = message == 0 ? 1 : (message - 1) / mtu + 1;
  const std::size_t packet = message + frames * static_cast<std::size_t>(radio.header_bytes);
  if (static_cast<std::size_t>(*radio.queue_bytes_max) >= packet) return;
  refuse(file, path["queue_bytes_max"],
         std::string("smaller than one packet: ") +
             (crumbs > 0 ? "one of packet_bytes_max of a forager"
                         : "a message of all beliefs, or a summary,") +
             " takes " + std::to_string(packet) + " bytes with headers");
}

// A packet has at most frames_max frames.
void check_frames(const ScenarioUnderCheck& file, const KeyPath& path) {
  const std::size_t message = carried_bytes_max(file.scenario, message_bytes_max(file.scenario));
  const std::size_t least = (message + frames_max - 1) / frames_max;
  const std::optional<int>& mtu_bytes = file.scenario.radio.mtu_bytes;
  if (!mtu_bytes || static_cast<std::size_t>(*mtu_bytes) >= least) return;
  refuse(file, path["mtu_bytes"],
         "must be at least " + std::to_string(least) + ": a message of all beliefs takes " +
             std::to_string(message) + " bytes, and a packet has at most " +
             std::to_string(frames_max) + " frames");
}

// Keys of other models would be without effect.
void check_sharing_keys(const ScenarioUnderCheck& file, const KeyPath& path) {
  const SharingSpec& sharing = file.scenario.radio.sharing;
  const SharingSpec plain;
  struct Key {
    const char* key;
    bool given;
    const char* model;
  };
  const Key keys[] = {
      {"send_probability", sharing.send_probability != plain.send_probability, "slotted-aloha"},
      {"slots", sharing.slots != plain.slots, "tdma"},
      {"interframe_s", sharing.interframe_s != plain.interframe_s, "carrier-sense"},
      {"window_min", sharing.window_min != plain.window_min, "carrier-sense"},
      {"window_max", sharing.window_max != plain.window_max, "carrier-sense"}};
  for (const Key& key : keys) {
    if (!key.given || sharing.model == key.model) continue;
    file.fail(path[key.key], std::string("only for model = \"") + key.model + "\"; found \"" +
                                 sharing.model + "\"");
  }
}

// How long an answered frame takes until the last bit of its answer has left, without the way.
double answer_s(const RadioSpec& radio) {
  const double jitter_s = radio.jitter.law == "uniform" ? radio.jitter.spread_s : 0.0;
  return radio.latency_s + jitter_s + radio.acknowledgement.interframe_s +
         8.0 * radio.acknowledgement.bytes / radio.rate_bps;
}

bool is_acknowledged(const AgentSpec& agent) {
  return agent.talk.service == "acknowledged" ||
         (agent.traffic && agent.traffic->service == "acknowledged");
}

// Who senses the air must wait longer than an acknowledgement takes to begin.
void check_interframe(const ScenarioUnderCheck& file, const KeyPath& path) {
  const RadioSpec& radio = file.scenario.radio;
  const double answer_begins_s = radio.acknowledgement.interframe_s + radio.latency_s;
  if (radio.sharing.interframe_s > answer_begins_s) return;
  refuse(file, path["interframe_s"],
         "with acknowledged packets must be above acknowledgement.interframe_s + latency_s (" +
             to_toml(answer_begins_s) + "), or others begin before the acknowledgement");
}

void check_slots(const ScenarioUnderCheck& file, const KeyPath& path) {
  const RadioSpec& radio = file.scenario.radio;
  const SharingSpec& sharing = radio.sharing;
  if (sharing.slot_s <= 0.0) {
    file.fail(path["slot_s"], "model = \"" + sharing.model + "\" needs a slot above 0 s");
  }
  const bool acknowledged =
      std::any_of(file.scenario.agents.begin(), file.scenario.agents.end(), is_acknowledged);
  if (sharing.model == "carrier-sense") {
    if (acknowledged) check_interframe(file, path);
    return;
  }
  if (!radio.mtu_bytes) {
    file.fail(path["model"], "\"" + sharing.model +
                                 "\" needs radio.mtu_bytes, which says how long a frame can be");
  }
  double frame_s = 8.0 * (*radio.mtu_bytes + radio.header_bytes) / radio.rate_bps;
  if (acknowledged) frame_s += answer_s(radio);
  if (Duration::seconds(sharing.slot_s) >= Duration::seconds(std::min(frame_s, 9e9))) return;
  refuse(file, path["slot_s"],
         "shorter than a frame, which takes " + to_toml(frame_s) + " s" +
             (acknowledged ? " with latency and acknowledgement" : ""));
}

}  // namespace

void check_transmitter(ScenarioUnderCheck& file) {
  const KeyPath top;
  const KeyPath path = top["radio"];
  const RadioSpec& radio = file.scenario.radio;
  check_queue(file, path);
  check_frames(file, path);
  const KeyPath sharing_path = path["sharing"];
  const SharingSpec& sharing = radio.sharing;
  check_sharing_keys(file, sharing_path);
  if (sharing.model == "none") {
    if (sharing.slot_s > 0.0) {
      file.fail(sharing_path["slot_s"], "without effect; set radio.sharing.model, too");
    }
    if (sharing.capture_db) {
      file.fail(sharing_path["capture_db"],
                "without effect: with sharing.model = \"none\" frames do not meet");
    }
  } else {
    check_slots(file, sharing_path);
  }
  const bool lengths = radio.topology == "disk" || radio.topology == "by-position" ||
                       radio.topology == "random-geometric";
  if (sharing.capture_db && !lengths) {
    file.fail(sharing_path["capture_db"],
              "only for topology = \"disk\", \"by-position\" or \"random-geometric\", which know "
              "how strong a frame is; found \"" +
                  radio.topology + "\"");
  }
  if (sharing.window_max < sharing.window_min) {
    file.fail(sharing_path["window_max"],
              "must not be below window_min (" + std::to_string(sharing.window_min) + ")");
  }
  if (radio.jitter.law == "none" && radio.jitter.spread_s > 0.0) {
    file.fail(path["jitter"]["spread_s"], "without effect; set radio.jitter.law, too");
  }
}

}  // namespace hearsay
