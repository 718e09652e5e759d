// Gossip between an agent and its radio: what is written anywhere gets everywhere that links lead
// to, over time, whatever is lost on the way.
//
// An item is broadcast when it is written. Who hears one that is new to it hands it up, holds it
// and broadcasts it once. Every summary period each agent broadcasts which items it has; who hears
// that, and holds what is missing there, broadcasts some of it. So what was lost is repaired, and
// what could not be told is told when a link comes up or a carrier comes by. (Epidemic routing:
// A. Vahdat, D. Becker, Duke CS-200006, 2000.)
//
// What the items are, bundles or slots, is the store's business (net/gossip_store). Items and
// summaries are frames of bytes (net/gossip_frame), charged on the air like anything else. The
// rider of an item travels with it at each hop and is held with it.
//
// Packets of other kinds pass through. Nothing is allocated a packet once all is as large as the
// traffic needs.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "net/gossip_store.hpp"
#include "net/radio.hpp"
#include "sim/kernel/simulation.hpp"

namespace hearsay {

class Gossip final : public Receiver {
 public:
  /// `simulation` and `radio` must outlive this; `store` is of agent `me`, with the same options.
  /// Attaches itself to the radio.
  /// @throws InputError for an option outside its range.
  Gossip(Simulation& simulation, Radio& radio, AgentId me, std::unique_ptr<GossipStore> store,
         const GossipOptions& options);
  ~Gossip() override;
  Gossip(const Gossip&) = delete;
  Gossip& operator=(const Gossip&) = delete;

  /// Who gets what is new. The sender of a packet is who wrote it, be it the agent itself before
  /// it lost its memory; `sent` is when. `up` must outlive this.
  void attach(Receiver& up) { up_ = &up; }
  /// Begins to send summaries. Once, before the run.
  void start();

  /// Writes an item. Bundles may have a receiver; the slot that is written is that of kind and
  /// subject. Tick and acknowledgement are without meaning.
  /// @return false if nothing was written: the agent is down, or there is no room for a new slot.
  /// @throws BrokenInvariant as Radio::send(), for an addressed slot, for a subject of 2^48 or more
  /// of a slot.
  bool write(const Outgoing& packet);
  /// Loses all that is held and known.
  void forget() { store_->forget(); }

  const GossipCounts& counts() const { return store_->counts; }
  const GossipStore& store() const { return *store_; }

  void on_packet(const Packet& packet) override;
  void on_outcome(const Packet& packet, bool acknowledged) override;
  void on_queue_empty() override {
    if (up_) up_->on_queue_empty();
  }

 private:
  void await(Time time);
  void say_what_is_held();
  void send(std::uint32_t place);
  void hear(const Packet& packet);
  void answer(const Packet& packet);

  Simulation& simulation_;
  Radio& radio_;
  AgentId me_;
  std::unique_ptr<GossipStore> store_;
  Duration period_;
  NameId item_kind_;
  NameId summary_kind_;
  Receiver* up_ = nullptr;
  EventId next_;
  std::vector<std::byte> frame_;  // being written
};

}  // namespace hearsay
