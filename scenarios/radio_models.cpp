#include "scenarios/radio_models.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace hearsay {
namespace {

using Models = std::vector<RadioModelInfo>;

Models transmitters() {
  const std::string by = "radio.queue_policy";
  const std::vector<std::string> bounds = {"radio.queue_packets_max", "radio.queue_bytes_max",
                                           "radio.queue_wait_max_s"};
  return {
      {"transmitter",
       "first-in-first-out",
       "",
       "packets leave one after another at rate_bps, in frames of at most mtu_bytes; a lost "
       "frame loses its packet",
       {"radio.rate_bps", "radio.header_bytes", "radio.mtu_bytes", "radio.half_duplex"},
       "a queue with one server: L. Kleinrock, Queueing systems 1, 1975"},
      {"queue", "drop-new", by, "a packet that finds the queue full is dropped", bounds, ""},
      {"queue", "drop-oldest", by, "a full queue drops who has waited longest", bounds, ""},
      {"queue", "replace", by,
       "a newer packet of the same kind, receiver and subject takes the place of one that waits",
       bounds, "age of information: S. Kaul, R. Yates, M. Gruteser, INFOCOM 2012"}};
}

Models services() {
  const std::string by = "agents.talk.service";
  const std::vector<std::string> both = {
      "radio.gossip.summary_period_s", "radio.gossip.summary_bytes_max", "radio.gossip.answers_max",
      "radio.gossip.buffer_packets_max"};
  std::vector<std::string> bundles = both;
  bundles.emplace_back("radio.gossip.hops_max");
  bundles.emplace_back("radio.gossip.lifetime_s");
  return {{"service", "broadcast", by, "one packet to whoever hears it", {}, ""},
          {"service",
           "acknowledged",
           by,
           "a packet to each neighbour, repeated until its acknowledgement comes back",
           {"radio.acknowledgement."},
           "stop-and-wait: A. S. Tanenbaum, Computer networks"},
          {"service", "store-and-forward", by,
           "a bundle is held and passed on by all it reaches, also when links come up later or a "
           "carrier comes by, and delivered once",
           bundles, "epidemic routing: A. Vahdat, D. Becker, Duke CS-200006, 2000"},
          {"service", "blackboard", by,
           "named slots of which each agent holds a copy; the last version wins, and lost ones are "
           "repaired",
           both,
           "the blackboard of the COMETS fleet: V. Remuss, M. Musial, EMAV 2004; versions: "
           "P. R. Johnson, R. H. Thomas, RFC 677, 1975"}};
}

Models sharings() {
  const std::string by = "radio.sharing.model";
  const std::string capture = "radio.sharing.capture_db";
  return {{"sharing", "none", by, "all send at will, packets pass through one another", {}, ""},
          {"sharing",
           "slotted-aloha",
           by,
           "a frame is sent in the next slot, with a probability; frames that overlap are lost",
           {"radio.sharing.slot_s", "radio.sharing.send_probability", capture},
           "L. G. Roberts, ALOHA packet system with and without slots and capture, 1975"},
          {"sharing",
           "carrier-sense",
           by,
           "who has a frame counts down a random number of idle slots; who cannot hear each other "
           "may collide",
           {"radio.sharing.slot_s", "radio.sharing.interframe_s", "radio.sharing.window_min",
            "radio.sharing.window_max", capture},
           "IEEE 802.11 DCF: G. Bianchi, IEEE JSAC 18(3), 2000"},
          {"sharing",
           "tdma",
           by,
           "agent i sends in slots i, i + slots, i + 2 slots, ...",
           {"radio.sharing.slot_s", "radio.sharing.slots", capture},
           "time division"}};
}

Models latencies() {
  const std::string by = "radio.jitter.law";
  const std::vector<std::string> jitter = {"radio.jitter.spread_s", "radio.jitter.order"};
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
           "speed of light or sound"},
          {"jitter", "none", by, "no latency beside the constant one", {}, ""},
          {"jitter", "uniform", by, "up to spread_s more, drawn for each packet and hearer", jitter,
           ""},
          {"jitter", "exponential", by, "spread_s more on average, with a long tail", jitter, ""}};
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
          {"topology",
           "binary-tree",
           by,
           "agent i hears its parent (i - 1)/2 and its children",
           {},
           ""},
          {"topology",
           "grid",
           by,
           "rows of so many agents; each hears its four neighbours",
           {"radio.columns"},
           ""},
          {"topology",
           "erdos-renyi",
           by,
           "each pair hears each other with a probability, drawn anew for each seed",
           {"radio.link_probability"},
           "P. Erdos, A. Renyi, Publicationes Mathematicae 6, 1959; E. N. Gilbert 1959"},
          {"topology",
           "small-world",
           by,
           "a ring on which each hears its nearest, and links lead elsewhere with a probability",
           {"radio.mean_degree", "radio.rewire_probability"},
           "D. J. Watts, S. H. Strogatz, Nature 393, 1998"},
          {"topology",
           "random-geometric",
           by,
           "agents stand at random in a square and hear who is within range_m",
           {"radio.side_m", "radio.range_m"},
           "M. Penrose, Random geometric graphs, 2003"},
          {"topology", "edges", by, "the pairs that the file names", {"radio.edges"}, ""},
          {"topology",
           "contacts",
           by,
           "links come and go as a recorded trace says",
           {"radio.contacts"},
           "contact traces of delay-tolerant networking"},
          {"schedule", "outages", "", "links are down for a while", {"radio.outages."}, ""},
          {"schedule",
           "partitions",
           "",
           "groups of agents do not hear one another for a while",
           {"radio.partitions."},
           ""},
          {"schedule", "rotation", "", "groups are cut off in turn", {"radio.rotation."}, ""},
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

Models motions() {
  const std::string by = "agents.motion.kind";
  const auto keys = [](std::vector<std::string> names) {
    names.emplace_back("altitude_m");
    for (std::string& name : names) name.insert(0, "agents.motion.");
    return names;
  };
  return {{"motion", "hover", by, "stays where it is", keys({}), ""},
          {"motion", "waypoints", by, "straight from point to point, with a pause at each",
           keys({"points_m", "speed_m_per_s", "pause_s", "repeat"}), ""},
          {"motion", "lawn-mower", by, "lanes to and fro over a rectangle",
           keys({"area_m", "lane_spacing_m", "speed_m_per_s", "repeat"}), ""},
          {"motion", "random-waypoint", by,
           "straight to a place drawn evenly from a rectangle, a pause, and so on; from the "
           "stationary law",
           keys({"area_m", "speed_min_m_per_s", "speed_max_m_per_s", "pause_min_s", "pause_max_s"}),
           "W. Navidi, T. Camp, IEEE Trans. Mobile Computing 3(1), 2004"},
          {"motion", "gauss-markov", by,
           "speed and direction forget their last values by alpha at each update; walls reflect",
           keys({"area_m", "speed_mean_m_per_s", "speed_sigma_m_per_s", "direction_mean_rad",
                 "direction_sigma_rad", "alpha", "update_period_s"}),
           "T. Camp, J. Boleng, V. Davies, Wireless Comm. Mobile Computing 2(5), 2002"},
          {"motion", "track", by, "straight between places at times from a CSV file",
           keys({"file"}), ""},
          {"motion", "steered", by, "where the agent decides to go (Context::go_to)", keys({}), ""},
          {"motion", "white-noise-acceleration", by,
           "of targets alone: speed and course change by white noise, as a tracking filter expects",
           keys({"velocity_m_per_s", "acceleration_psd_m2_per_s3"}), "Merino 2007, eq. 3.58-3.59"}};
}

}  // namespace

const std::vector<RadioModelInfo>& radio_models() {
  static const Models all = [] {
    Models models;
    // A new part of the network, or a new model of a part, is added here and shown everywhere.
    for (const auto part : {transmitters, services, sharings, latencies, propagations, losses,
                            topologies, faults, motions}) {
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
  constexpr std::array<std::pair<std::string_view, const char*>, 19> units = {
      {{"_m_per_s", "m/s"},
       {"_rad_per_s", "rad/s"},
       {"_m_per_sqrt_s", "m/√s"},
       {"_m_per_sqrt_m", "m/√m"},
       {"_rad_per_sqrt_s", "rad/√s"},
       {"_rad_per_sqrt_m", "rad/√m"},
       {"_rad_per_sqrt_rad", "rad/√rad"},
       {"_m2_per_s3", "m²/s³"},
       {"_nats", "nats"},
       {"_bps", "bit/s"},
       {"_bytes", "bytes"},
       {"_bytes_max", "bytes"},
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
