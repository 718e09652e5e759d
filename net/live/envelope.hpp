// Packets as bytes: an envelope before the message of a codec, as air.idl has them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace hearsay::live {

inline constexpr std::uint32_t everybody = 0xffffffff;

struct Envelope {
  std::uint32_t sender = 0;
  std::uint32_t receiver = everybody;
  std::uint64_t number = 0;   ///< rises from packet to packet of a sender
  std::int64_t sent_ns = 0;   ///< when the sender handed it to its radio, in the fleet's time
  std::int64_t tick = -1;     ///< number of the talk in the sender's schedule; −1: none
  std::uint64_t subject = 0;  ///< what it is news of, for queues that replace
  bool operator==(const Envelope&) const = default;
};
/// Of an envelope in a packet.
inline constexpr std::size_t envelope_bytes = 40;

/// A packet from a message that begins with its header of four bytes. `out` is overwritten, its
/// capacity reused. @throws BrokenInvariant for a message without that header.
void pack(const Envelope& envelope, std::span<const std::byte> message,
          std::vector<std::byte>& out);

/// Takes a packet apart in its place: `message` refers to its bytes, of which the last of the
/// envelope are overwritten, and begins with its header. False unless it has header and envelope.
bool unpack(std::span<std::byte> packet, Envelope& envelope, std::span<std::byte>& message);

/// The envelope that a packet's body (all behind its header) begins with; false if it is shorter.
bool read_envelope(std::span<const std::byte> body, Envelope& envelope);

/// The same for an OctetsPacket: of a kind that no codec here knows, the bytes as the agent made
/// them. @throws BrokenInvariant for more than messages.hpp allows.
void pack_octets(const Envelope& envelope, const std::string& kind,
                 std::span<const std::byte> message, std::vector<std::byte>& out);
/// False unless the bytes are exactly one such packet within the bounds of messages.hpp. `message`
/// refers to them.
bool unpack_octets(std::span<const std::byte> packet, Envelope& envelope, std::string& kind,
                   std::span<const std::byte>& message);

}  // namespace hearsay::live
