// Who may hear whom, and what the way there does to a packet: graph or places, links that come and
// go, propagation, loss, jammers, latency.
//
// Draws are keyed by (seed, link, number of the packet), so the same packets are lost under every
// fusion rule, whatever it sends.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "net/link_draw.hpp"
#include "net/link_states.hpp"
#include "net/places.hpp"
#include "net/radio_options.hpp"
#include "net/topology.hpp"
#include "net/transmission.hpp"
#include "sim/kernel/simulation.hpp"

namespace hearsay {

/// Where radios are, or who is joined to whom.
struct Reach {
  /// Everybody who may ever hear a sender is its neighbour. By place: as many agents, no links.
  Topology topology;
  std::vector<LinkChange> changes = {};  ///< links that come and go, as in LinkPlan
  std::vector<Point> positions_m = {};   ///< of radios that stand, by agent; empty: not known
  /// Where radios are that move. Not owned, outlives the radio; somebody else keeps it up to date.
  Places* places = nullptr;
  /// Who hears whom follows from `places`, whose reach is that of the propagation, and not from the
  /// topology.
  bool by_place = false;
};

class Channel {
 public:
  /// `simulation` outlives this.
  /// @throws InputError for options that need positions, without any.
  Channel(Simulation& simulation, Reach reach, const RadioOptions& options);
  ~Channel() { simulation_.cancel(change_); }
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  int agents() const { return topology_.agents(); }
  const Topology& topology() const { return topology_; }
  /// Who may hear `agent` now, by number. Valid until the next call.
  std::span<const AgentId> neighbours(AgentId agent);
  /// True if they may change over time.
  bool neighbours_change() const { return by_place_ || !changes_.empty(); }
  /// True if links of the graph come and go.
  bool links_change() const { return !changes_.empty(); }
  /// Whether the link to the packet's i-th hearer is up now.
  bool link_up(const Transmission& t, std::size_t i) const {
    return states_.up(t.route.ear(i).link);
  }
  /// True if who may hear a packet is known when it is handed over.
  bool foreseen() const { return !by_place_; }
  /// Where `agent` is now. @throws BrokenInvariant if nobody knows.
  Point position(AgentId agent) const;
  /// Calls visit(from, to, number) for each link that was numbered, by from and to.
  template <class Visit>
  void visit_links(Visit visit) const {
    for (const auto& [key, number] : numbers_) {
      visit(static_cast<AgentId>(key >> 32), static_cast<AgentId>(key & UINT32_MAX), number);
    }
    if (by_place_) return;
    for (AgentId from = 0; from < agents(); ++from) {
      auto link = static_cast<std::uint32_t>(topology_.first_link(from));
      for (const AgentId to : topology_.neighbours(from)) visit(from, to, link++);
    }
  }

  /// Finds the route of a packet and uses up its draw on each link. With `draws` its fates are
  /// those the channel gives it: delivered, lost or out_of_range.
  void aim(Transmission& t, bool draws);
  /// Draws the fate of an addressed packet that is repeated.
  Fate repeat(Transmission& t);
  /// Whether the acknowledgement of an addressed packet gets through.
  bool acknowledgement_lost(const Transmission& t) const;
  /// When the last bit has left: from now on its hearers are in order of arrival.
  void launch(Transmission& t);
  /// True if nothing happens to a packet on its way that aim() does not know.
  bool quiet() const { return quiet_; }
  /// What the channel makes of a packet that arrives at its i-th hearer now, beside that.
  Fate fate_on_arrival(const Transmission& t, std::size_t i) const;
  /// How strong the i-th hearer hears a packet, and `to` a frame of `from`, now.
  double power_dbm(const Transmission& t, std::size_t i) const {
    return powers_ ? power_dbm(t.sender, t.route.hearer(i)) : 0.0;
  }
  double power_dbm(AgentId from, AgentId to) const;

 private:
  void order_arrivals();
  void route(Transmission& t);
  void route_moving(Transmission& t);
  void draw_jitter(Transmission& t);
  Duration way(double distance_m) const;
  double distance_m(AgentId from, AgentId to) const;
  std::uint32_t number(AgentId from, AgentId to);
  PacketOnLink on_link(const Transmission& t, AgentId to, std::uint64_t index) const;
  LinkQuality quality(AgentId from, AgentId to, double interference_mw) const;
  FrameSizes frame_sizes(const Transmission& t) const;
  bool heard(PacketOnLink packet, const Transmission& t, std::uint32_t link);
  void schedule_change();

  Simulation& simulation_;
  Topology topology_;
  std::vector<LinkChange> changes_;
  std::vector<Point> positions_m_;
  Places* places_;
  bool by_place_;
  LinkStates states_;
  EventId change_;  // of links, the next
  Propagation propagation_;
  Loss loss_;
  Jammers jammers_;
  Duration latency_;
  JitterOptions jitter_;
  double propagation_m_per_s_;
  std::uint32_t mtu_bytes_;
  std::uint32_t header_bytes_;
  std::uint32_t answer_bytes_;
  bool quiet_;
  bool powers_;                  // are of interest
  bool numbers_links_;           // although radios move
  bool certain_;                 // who is in reach hears
  bool noisy_;                   // jammers add to the noise, so that the draws are needed again
  std::size_t hearers_max_ = 1;  // of anybody's broadcast; an addressed packet has one
  // The neighbours of each sender in order of arrival, rows as in the topology. Empty if the way
  // takes no time: then they hear at once.
  std::vector<Ear> ears_;
  // Of radios that stand, unless certain, a link: its quality, and the success of a frame of the
  // size that was last asked for.
  std::vector<LinkQuality> link_quality_;
  struct FrameSuccess {
    double success;
    std::uint32_t bytes;
  };
  std::vector<FrameSuccess> frame_success_;
  std::map<std::uint64_t, std::uint32_t> numbers_;  // of links of moving radios, by both ends
  std::vector<std::uint64_t> link_packets_;         // packets without tick so far, a link
  std::vector<Time> link_arrival_;  // in-order jitter: when the next may arrive at the earliest
  struct Sorted {
    Ear ear;
    Fate fate;
    std::uint64_t number;
  };
  std::vector<Sorted> sorting_;
  std::vector<AgentId> neighbours_;
};

}  // namespace hearsay
