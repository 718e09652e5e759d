// What must fit together in the traffic of sources.
#include <cstdint>
#include <string>

#include "scenarios/scenario_under_check.hpp"
#include "scenarios/traffic.hpp"

namespace hearsay {
namespace {

constexpr double shortest_s = 1e-9;  // a tick of the clock

void check_arrivals(const ScenarioUnderCheck& file, const KeyPath& path, const TrafficSpec& s) {
  const bool saturated = s.arrivals == "saturated";
  if (saturated && s.period_s) {
    file.fail(path["period_s"], "not for arrivals = \"saturated\": there is always a packet");
  }
  if (!saturated && !s.period_s) {
    file.fail(path["period_s"], "missing; arrivals = \"" + s.arrivals + "\" needs it");
  }
  if (!s.phase_s) return;
  if (s.arrivals != "periodic") {
    file.fail(path["phase_s"], "only for arrivals = \"periodic\"; found \"" + s.arrivals + "\"");
  }
  if (*s.phase_s >= *s.period_s) {
    file.fail(path["phase_s"], "must be less than period_s (" + to_toml(*s.period_s) + " s)");
  }
}

// The receiver of agents `first` … `first + count − 1`.
void check_receiver(const ScenarioUnderCheck& file, const KeyPath& path, TrafficSpec& s, int first,
                    int count) {
  const bool addressed = s.service != "broadcast";
  if (addressed != s.receiver.has_value()) {
    file.fail(path["receiver"], addressed
                                    ? "missing; service = \"" + s.service + "\" needs it"
                                    : "not for service = \"broadcast\"; give another service");
  }
  if (!addressed) return;
  const KeyPath at = path["receiver"];
  s.receiver->number = file.resolve_agent(file.locate(at), at, s.receiver->number);
  if (s.receiver->number >= first && s.receiver->number < first + count) {
    file.fail(at, "agent '" + file.agents()[static_cast<std::size_t>(s.receiver->number)] +
                      "' would send to itself");
  }
}

// A saturated source has a packet in the queue behind the one that is being sent.
void check_queue(const ScenarioUnderCheck& file, const KeyPath& path, const TrafficSpec& s) {
  const RadioSpec& radio = file.scenario.radio;
  const KeyPath top;
  const KeyPath radio_path = top["radio"];
  const bool saturated = s.arrivals == "saturated";
  const auto largest = static_cast<double>(packet_sizes(s).largest());
  const double mtu = radio.mtu_bytes.value_or(1'000'000'000);
  const double frames = static_cast<double>(static_cast<std::int64_t>((largest - 1.0) / mtu)) + 1.0;
  const double packet = largest + frames * radio.header_bytes;
  if (radio.queue_bytes_max && *radio.queue_bytes_max < packet * (saturated ? 2 : 1)) {
    file.fail(radio_path["queue_bytes_max"],
              std::string(saturated ? "smaller than two packets of a saturated source; one"
                                    : "smaller than one packet of a source, which") +
                  " may take " + std::to_string(static_cast<std::int64_t>(packet)) +
                  " bytes with headers");
  }
  if (!saturated) return;
  if (radio.queue_packets_max < 2) {
    file.fail(radio_path["queue_packets_max"],
              "must be at least 2 for saturated traffic: one that is sent, and the next");
  }
  const int smallest = (s.sizes == "exponential" ? 1 : s.bytes) + radio.header_bytes;
  if (8.0 * smallest / radio.rate_bps < shortest_s) {
    file.fail(path["arrivals"],
              "\"saturated\" needs packets that take at least a nanosecond; "
              "lower radio.rate_bps");
  }
}

// A source neither measures nor believes; keys that say otherwise would have no effect.
void check_source(const ScenarioUnderCheck& file, const KeyPath& path, const AgentSpec& agent) {
  const std::string why = "without effect: kind = \"source\" sends agents.traffic alone";
  if (agent.sensor.kind != "none") file.fail(path["sensor"], why);
  if (agent.estimator != EstimatorSpec()) file.fail(path["estimator"], why);
  if (agent.talk != TalkSpec()) file.fail(path["talk"], why);
}

}  // namespace

void check_traffic(ScenarioUnderCheck& file) {
  const KeyPath top;
  const KeyPath all = top["agents"];
  int first = 0;
  for (std::size_t i = 0; i < file.scenario.agents.size(); ++i) {
    AgentSpec& agent = file.scenario.agents[i];
    const KeyPath path = all[i];
    if (agent.kind == "source") check_source(file, path, agent);
    if (agent.traffic) {
      const KeyPath traffic = path["traffic"];
      if (agent.kind != "source") {
        file.fail(traffic, "only for kind = \"source\"; found \"" + agent.kind + "\"");
      }
      check_arrivals(file, traffic, *agent.traffic);
      check_receiver(file, traffic, *agent.traffic, first, agent.count);
      check_queue(file, traffic, *agent.traffic);
    }
    first += agent.count;
  }
}

}  // namespace hearsay
