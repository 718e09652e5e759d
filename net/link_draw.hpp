// The name under which the channel draws: which packet on which link.
//
// Every draw of the channel is a pure function of (seed, purpose, link, number of the packet), so
// the same packets meet the same fate under every rule, and any of them can be asked again. Frame f
// of a packet has uniform f of that name: a packet of more frames meets the draws of a shorter one
// and then some more.
#pragma once

#include <cstdint>

#include "sim/kernel/error.hpp"
#include "sim/kernel/ids.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {

/// What a packet's index counts. The two are different names: packet n does not share the draw of
/// tick n.
enum class Numbering : std::uint8_t {
  tick,    ///< talks of the sender
  packet,  ///< packets without a tick on the link
};

/// A packet on a directed link.
struct PacketOnLink {
  std::uint64_t seed = 0;  ///< of the run
  AgentId from = no_agent;
  AgentId to = no_agent;
  Numbering numbering = Numbering::tick;
  std::uint64_t index = 0;  ///< below 2^48

  Entity link() const { return Entity::link(from, to); }
};

/// So many words a draw's name has; a packet cannot have more frames.
inline constexpr std::uint32_t frames_max = 131'072;

/// What the channel draws for: one purpose for each numbering.
struct PurposeOnLink {
  Purpose tick;
  Purpose packet;
  Purpose of(Numbering numbering) const { return numbering == Numbering::tick ? tick : packet; }
};

/// The uniforms of a packet's frames, one after another.
class FrameDraws {
 public:
  FrameDraws(const PacketOnLink& packet, const PurposeOnLink& purpose)
      : stream_(
            Stream::at(packet.seed, purpose.of(packet.numbering), packet.link(), packet.index)) {}
  double next() { return stream_.uniform(); }

 private:
  Stream stream_;
};

/// The uniform of the packet's first frame: what FrameDraws gives first, cheaper.
inline double first_frame_draw(const PacketOnLink& packet, const PurposeOnLink& purpose) {
  return Stream::uniform_at(packet.seed, purpose.of(packet.numbering), packet.link(), packet.index);
}

}  // namespace hearsay
