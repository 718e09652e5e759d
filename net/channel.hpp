// Who may hear whom, and what the way there does to a packet: graph, loss, latency.
//
// Draws are keyed by (seed, link, number of the packet), so the same packets are lost under every
// fusion rule, whatever it sends.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "net/link_draw.hpp"
#include "net/loss.hpp"
#include "net/radio_options.hpp"
#include "net/topology.hpp"
#include "net/transmission.hpp"
#include "sim/kernel/simulation.hpp"

namespace hearsay {

class Channel {
 public:
  /// `simulation` outlives this.
  Channel(Simulation& simulation, Topology topology, const RadioOptions& options);

  int agents() const { return topology_.agents(); }
  const Topology& topology() const { return topology_; }
  /// Who may hear `agent` now, by number. Valid until the next call.
  std::span<const AgentId> neighbours(AgentId agent);
  /// True if who may hear a packet is known when it is handed over.
  bool foreseen() const { return true; }
  /// How many links there are, if they are numbered.
  std::size_t links() const { return topology_.links(); }

  /// Finds the route of a packet and uses up its draw on each link. With `draws` its fates are
  /// those the channel gives it: delivered, lost or out_of_range.
  void aim(Transmission& t, bool draws);
  /// Draws the fate of an addressed packet that is repeated.
  Fate repeat(const Transmission& t) const;
  /// Whether the acknowledgement of an addressed packet gets through.
  bool acknowledgement_lost(const Transmission& t) const;
  /// When the last bit has left: from now on its hearers are in order of arrival.
  void launch(Transmission& t);
  /// What the channel makes of a packet that arrives now.
  Fate on_arrival(const Transmission&, std::size_t) const { return Fate::delivered; }
  /// How strong the i-th hearer hears a packet, and `to` a frame of `from`.
  double power_dbm(const Transmission&, std::size_t) const { return 0.0; }
  double power_dbm(AgentId, AgentId) const { return 0.0; }

 private:
  void order_arrivals();
  void route(Transmission& t);
  void draw_jitter(Transmission& t);
  Duration way(std::size_t link) const;
  PacketOnLink on_link(const Transmission& t, std::size_t i, std::uint64_t index) const;

  Simulation& simulation_;
  Topology topology_;
  Loss loss_;
  Duration latency_;
  JitterOptions jitter_;
  double propagation_m_per_s_;
  std::size_t hearers_max_ = 1;  // of anybody's broadcast; an addressed packet has one
  // The neighbours of each sender in order of arrival, rows as in the topology. Empty if the way
  // takes no time: then they hear at once.
  std::vector<Ear> ears_;
  std::vector<std::uint64_t> link_packets_;  // packets without tick so far, a link
  std::vector<Time> link_arrival_;           // in-order jitter: the last arrival, a link
  std::vector<std::pair<Ear, Fate>> sorting_;
};

}  // namespace hearsay
