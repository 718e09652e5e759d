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
  std::uint64_t index = 0;       ///< below 2^48; 2^36 if it is repeated or acknowledged
  std::uint32_t repetition = 0;  ///< below 1024; 0: sent for the first time
  bool answer = false;           ///< the acknowledgement, by from, of what to sent

  Entity link() const { return Entity::link(from, to); }
};

/// So many words a draw's name has; a packet cannot have more frames.
inline constexpr std::uint32_t frames_max = 131'072;

/// What the channel draws for: one purpose for each numbering.
struct PurposeOnLink {
  Purpose tick;
  Purpose packet;
  Purpose again;  ///< repetitions and acknowledgements, which do not shift the others
  Purpose of(Numbering numbering) const { return numbering == Numbering::tick ? tick : packet; }
};

/// The uniforms of a packet's frames, one after another.
class FrameDraws {
 public:
  FrameDraws(const PacketOnLink& packet, const PurposeOnLink& purpose)
      : stream_(again(packet)
                    ? Stream::at(packet.seed, purpose.again, packet.link(), again_count(packet))
                    : Stream::at(packet.seed, purpose.of(packet.numbering), packet.link(),
                                 packet.index)) {}
  double next() { return stream_.uniform(); }

  static bool again(const PacketOnLink& packet) { return packet.repetition > 0 || packet.answer; }

 private:
  static std::uint64_t again_count(const PacketOnLink& packet) {
    require(packet.repetition < 1024, "radio: a packet is repeated too often");
    const std::uint64_t numbering = packet.numbering == Numbering::tick ? 0 : 1;
    const std::uint64_t answer = packet.answer ? 1 : 0;
    return ((packet.index * 2 + numbering) * 2 + answer) * 1024 + packet.repetition;
  }
  Stream stream_;
};

/// The uniform of the packet's first frame: what FrameDraws gives first, cheaper.
inline double first_frame_draw(const PacketOnLink& packet, const PurposeOnLink& purpose) {
  if (FrameDraws::again(packet)) return FrameDraws(packet, purpose).next();
  return Stream::uniform_at(packet.seed, purpose.of(packet.numbering), packet.link(), packet.index);
}

}  // namespace hearsay
