#include "scenarios/radio_models.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace hearsay {
namespace {

using Models = std::vector<RadioModelInfo>;

Models transmitters() {
  return {{"transmitter",
           "first-in-first-out",
           "",
           "packets leave one after another at rate_bps; one beyond the queue's bound is dropped",
           {"radio.rate_bps", "radio.header_bytes", "radio.queue_packets_max"},
           "a queue with one server: L. Kleinrock, Queueing systems 1, 1975"}};
}

Models latencies() {
  return {{"latency",
           "constant",
           "",
           "the same time from the last bit sent to arrival, for every packet",
           {"radio.latency_s"},
           "idealisation of processing and stacks"},
          {"latency",
           "distance",
           "",
           "arrival is later by distance / speed",
           {"radio.propagation_m_per_s"},
           "speed of light or sound"}};
}

Models propagations() {
  const std::string by = "radio.propagation.model";
  return {{"propagation",
           "disk",
           by,
           "who is within range_m hears everything, nobody else hears anything",
           {"radio.propagation.range_m"},
           "unit disk graph: B. N. Clark, C. J. Colbourn, D. S. Johnson, Discrete Mathematics 86, "
           "1990"},
          {"propagation",
           "grey-zone",
           by,
           "everything is heard up to inner_m, and linearly less from there to outer_m",
           {"radio.propagation.inner_m", "radio.propagation.outer_m"},
           "quasi unit disk graph: F. Kuhn, R. Wattenhofer, A. Zollinger, DIALM-POMC 2003"},
          {"propagation",
           "log-distance",
           by,
           "path loss PL0 + 10 n log10(d/d0) + X with X normal and fixed for a pair of agents; a "
           "frame of B bytes succeeds with (1 - BER)^(8 B), BER = exp(-SNR/1.28)/2",
           {"radio.propagation.exponent", "radio.propagation.reference_loss_db",
            "radio.propagation.reference_m", "radio.propagation.shadowing_sigma_db",
            "radio.propagation.transmit_dbm", "radio.propagation.noise_dbm",
            "radio.propagation.range_m"},
           "M. Zuniga, B. Krishnamachari, Analyzing the transitional region in low power wireless "
           "links, SECON 2004"}};
}

Models losses() {
  const std::string by = "radio.loss.model";
  return {{"loss", "none", by, "what is in range is heard", {}, ""},
          {"loss",
           "bernoulli",
           by,
           "each frame is lost by chance, independently; links may have their own probability",
           {"radio.loss.probability", "radio.loss.links."},
           "idealisation of noise without memory"},
          {"loss",
           "gilbert-elliott",
           by,
           "a link is good or bad; its state changes once a packet, and loss depends on it",
           {"radio.loss.probability", "radio.loss.mean_burst", "radio.loss.good_to_bad",
            "radio.loss.bad_to_good", "radio.loss.loss_good", "radio.loss.loss_bad"},
           "E. N. Gilbert, Bell System Technical Journal 39, 1960; E. O. Elliott, ibid. 42, 1963"}};
}

Models topologies() {
  const std::string by = "radio.topology";
  return {{"topology", "line", by, "agent i hears i - 1 and i + 1", {}, ""},
          {"topology", "ring", by, "a line whose ends are joined", {}, ""},
          {"topology", "star", by, "agent 0 in the middle", {}, ""},
          {"topology", "full", by, "everybody hears everybody", {}, ""},
          {"topology", "edges", by, "the pairs that the file names", {"radio.edges"}, ""},
          {"topology",
           "disk",
           by,
           "who stands within range_m hears",
           {"radio.range_m"},
           "unit disk graph: B. N. Clark, C. J. Colbourn, D. S. Johnson, Discrete Mathematics 86, "
           "1990"},
          {"topology",
           "by-position",
           by,
           "who hears whom follows from where they are and radio.propagation",
           {"radio.propagation.model"},
           ""}};
}

Models faults() {
  const std::string by = "dropouts.kind";
  const std::string source =
      "alternating renewal process with exponential times: D. R. Cox, Renewal theory, 1962";
  const std::vector<std::string> planned = {"dropouts.agents", "dropouts.from_s"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), planned.begin(), planned.end());
    return more;
  };
  const std::vector<std::string> times = {"dropouts.until_s", "dropouts.mean_up_s",
                                          "dropouts.mean_down_s", "dropouts.outages_max"};
  std::vector<std::string> reboot = times;
  reboot.emplace_back("dropouts.memory");
  const std::vector<std::string> when = {"radio.jammers.position_m", "radio.jammers.from_s",
                                         "radio.jammers.until_s", "radio.jammers.period_s",
                                         "radio.jammers.duty"};
  std::vector<std::string> radius = when, power = when;
  radius.emplace_back("radio.jammers.radius_m");
  power.emplace_back("radio.jammers.power_dbm");
  return {
      {"dropouts", "die", by, "the agent is gone for good", with({"dropouts.mean_up_s"}), source},
      {"dropouts", "sleep", by, "the agent is away and comes back as it was", with(times), source},
      {"dropouts", "reboot", by, "the agent is away and comes back without its memory, or with",
       with(reboot), source},
      {"jammers", "by radius", "", "who is within radius_m hears nothing", radius, ""},
      {"jammers", "by power", "",
       "noise that adds to the noise floor, by the path loss of log-distance", power,
       "signal-to-interference-and-noise ratio"}};
}

}  // namespace

const std::vector<RadioModelInfo>& radio_models() {
  static const Models all = [] {
    Models models;
    // A new part of the network, or a new model of a part, is added here and shown everywhere.
    for (const auto part : {transmitters, latencies, propagations, losses, topologies, faults}) {
      Models of_part = part();
      std::move(of_part.begin(), of_part.end(), std::back_inserter(models));
    }
    return models;
  }();
  return all;
}

std::vector<KeyInfo> parameters(const RadioModelInfo& model) {
  static const std::vector<KeyInfo> known = schema_keys();
  std::vector<KeyInfo> found;
  for (const std::string& key : model.keys) {
    std::copy_if(known.begin(), known.end(), std::back_inserter(found), [&](const KeyInfo& info) {
      return key.ends_with('.') ? info.path.starts_with(key) : info.path == key;
    });
  }
  return found;
}

std::string unit_of(std::string_view key) {
  constexpr std::array<std::pair<std::string_view, const char*>, 10> units = {
      {{"_m_per_s", "m/s"},
       {"_bps", "bit/s"},
       {"_bytes", "bytes"},
       {"_packets_max", "packets"},
       {"mean_burst", "packets"},
       {"_dbm", "dBm"},
       {"_db", "dB"},
       {"_rad", "rad"},
       {"_m", "m"},
       {"_s", "s"}}};
  const auto at = std::find_if(units.begin(), units.end(),
                               [&](const auto& unit) { return key.ends_with(unit.first); });
  return at == units.end() ? "" : at->second;
}

}  // namespace hearsay
