// What an agent believes of an area, what it has told and heard of it: one certainty grid, the
// memories its fusion rule needs, and the cutting of messages into packets.
//
// It knows no clock and no radio. A message is cut into packets (filters/grid/codec.hpp); each is
// taken in as it comes, and what was lost stays unsaid until it is told again. Messages are
// numbered by (incarnation, count): what is older than the newest of a sender, or a part that was
// heard already, is refused.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "agents/grids/grid_mind.hpp"
#include "net/rider_pool.hpp"
#include "sim/kernel/ids.hpp"

namespace hearsay {

/// The ledger of what a message tells; rides beside each of its packets.
class GridRider final : public PooledRider<GridRider> {
 public:
  grid::LookLedger ledger;

 private:
  friend class RiderPool<GridRider>;
  using PooledRider::PooledRider;
};

class GridEstimator final : public GridMind {
 public:
  struct Options {
    GridBelief::Options belief;
    grid::Rule rule = grid::Rule::none;
    double omega = grid::usual_omega;  ///< of rules that weigh, 0 … 1
    grid::Form form = grid::Form::whole;
    int whole_every = 0;  ///< of Form::changed: at every so many talks the whole grid; 0: never
    std::size_t packet_bytes = 1400;  ///< at most, of a packet
  };
  struct Counts {
    std::uint64_t looks = 0;    ///< cells looked at, once a look
    std::uint64_t fusions = 0;  ///< packets fused
    std::uint64_t refused = 0;  ///< packets malformed, outdated or heard before
  };
  /// `riders`: where those of its messages come from; nullptr: ledgers are off.
  /// @throws BrokenInvariant for options out of range, a rule that is not for the kind of grid, or
  /// packets in which nothing fits.
  GridEstimator(const grid::Area& area, const Options& options, RiderPool<GridRider>* riders);

  /// `indices`: of the looks in the run's book; with ledgers as many as looks.
  void looked(std::span<const grid::CellLook> looks, std::span<const std::uint32_t> indices);

  /// True if each neighbour is told something of its own.
  bool addresses() const;
  /// The packets of the `talk`-th message to `receiver`, or to all for no_agent; none if there is
  /// nothing to tell. Valid until the next call.
  std::span<const std::vector<std::byte>> speech(AgentId receiver, std::uint64_t talk);
  /// Of the last speech; empty if ledgers are off.
  const RiderPtr& rider() const { return rider_; }
  /// A packet of the last speech was handed to the radio; `listeners`: whom it may reach.
  void sent(AgentId receiver, std::span<const std::byte> packet,
            std::span<const AgentId> listeners);

  /// Takes in a packet.
  void heard(AgentId from, std::span<const std::byte> bytes, const Rider* rider);

  /// Comes back without its memory.
  void forget();

  const GridBelief& belief() const override { return belief_; }
  const grid::LookLedger& ledger() const override { return ledger_; }
  const Counts& counts() const { return counts_; }

 private:
  /// What is remembered of one who was heard or told something.
  struct Other {
    AgentId id;
    bool heard = false;
    std::uint32_t incarnation = 0, count = 0;  // of the newest message from there
    std::vector<unsigned char> parts;          // of it: 1 if it came
    std::vector<float> common;                 // by the rule's memory; empty: nothing yet
    std::vector<float> sent;                   // as it was told; empty: nothing yet
    grid::LookLedger common_ledger;            // of `common`
  };
  Other& other(AgentId id);
  bool is_news(Other& from, const grid::PacketHead& head);
  std::span<const float> evidence_for(AgentId receiver);
  void make_rider(AgentId receiver);
  /// Fuses a range of cells, and its ledger; remembers it as the rule wants.
  void fuse(Other& from, int first_cell, std::span<const float> values,
            const grid::LookLedger* ledger);
  bool tells_nothing(std::span<const float> evidence) const;

  Options options_;
  GridBelief belief_;
  std::vector<Other> others_;  // by id
  std::vector<float> sent_;    // as it was told to all; empty: nothing yet
  std::vector<float> less_;    // evidence less what one neighbour said
  grid::Encoder encoder_;
  RiderPool<GridRider>* riders_;
  RiderPtr rider_;
  grid::LookLedger ledger_;
  std::vector<grid::Shares> shares_;
  std::uint32_t incarnation_ = 0;
  std::uint32_t next_count_ = 1;
  Counts counts_;
};

}  // namespace hearsay
