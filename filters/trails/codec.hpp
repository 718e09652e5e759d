// Trails as bytes: little-endian XCDR1, the encoding of these DDS types:
//
//   struct Identity    { unsigned long robot, incarnation, number; };
//   struct TrailHead   { unsigned long sender, incarnation, count;  // of the message
//                        unsigned long part, parts;                 // this packet of the message's
//                        unsigned long numbers; };                  // floats a position
//   struct TrailPlace  { double time_s; unsigned long event; Identity identity; };
//   struct TrailCrumb  { double created_s; unsigned long event, goal; Identity identity;
//                        float distance_s; };
//   struct TrailPart   { TrailHead head; sequence<TrailPlace> places;  // by event, rising
//                        sequence<TrailCrumb> crumbs;
//                        sequence<float> positions; };  // of the places, then of the crumbs
//
// In the plane a crumb is 40 bytes and a place 32. Positions are in the sender's frame. A message
// is cut into packets of at most an MTU. Each stands alone: it has all places of the message, so
// that its crumbs can be brought into the receiver's frame, and a lost one leaves just its crumbs
// unsaid. (incarnation, count) orders a sender's messages across reboots; crumbs and places have
// identities of their own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "filters/trails/space.hpp"
#include "filters/trails/trail.hpp"

namespace hearsay::trails {

/// Bounds of what a packet may say.
inline constexpr std::size_t packet_places_max = 64;
inline constexpr std::size_t packet_crumbs_max = 65536;
inline constexpr std::uint32_t packet_parts_max = 65536;
inline constexpr std::size_t position_numbers_max = 4096;

/// Exact bytes of a packet; `numbers`: floats a position.
std::size_t packet_size(std::size_t numbers, std::size_t places, std::size_t crumbs);
/// How many crumbs fit into `mtu` bytes beside the places; 0 if none does.
std::size_t crumbs_that_fit(std::size_t numbers, std::size_t places, std::size_t mtu);

/// What a message takes, headers of packets included. One without crumbs is one packet.
struct MessageSize {
  std::size_t packets = 0, bytes = 0;
};
/// @throws BrokenInvariant beyond the bounds above, or for an MTU in which a crumb (or, without
/// crumbs, the places) does not fit.
MessageSize message_size(std::size_t numbers, std::size_t places, std::size_t crumbs,
                         std::size_t mtu);

struct PacketHead {
  std::uint32_t sender = 0, incarnation = 0, count = 0;
  std::uint32_t part = 0, parts = 1;
};

/// Cuts messages into packets; its storage is reused (no allocation once warm).
template <LocalizationSpace S>
class Encoder {
 public:
  struct Message {
    std::uint32_t sender = 0, incarnation = 0, count = 0;
    std::span<const PlaceOf<typename S::Position>> places;  ///< by event, rising
    std::span<const CrumbOf<typename S::Position>> crumbs;
  };
  /// The packets, valid until the next call. @throws BrokenInvariant as message_size(), for places
  /// out of order, and for what Packet::parse() would refuse.
  std::span<const std::vector<std::byte>> encode(const Message& message, std::size_t mtu);

 private:
  std::vector<std::vector<std::byte>> packets_;
};

/// Where the parts of a well-formed packet stand, whatever the space.
struct PacketLayout {
  PacketHead head;
  std::size_t places = 0, crumbs = 0;
  std::span<const std::byte> place_records, crumb_records, positions;

  /// Everything but the positions. Nothing unless the bytes are one packet with so many numbers a
  /// position.
  static std::optional<PacketLayout> read(std::span<const std::byte> bytes, std::size_t numbers);
};

/// A packet that was found to be well-formed. Refers to the bytes it was made from.
template <LocalizationSpace S>
class Packet {
 public:
  using Crumb = CrumbOf<typename S::Position>;
  using Place = PlaceOf<typename S::Position>;

  /// Nothing unless the bytes are exactly one well-formed packet: also if it is truncated or has
  /// trailing bytes, part ≥ parts, counts beyond the bounds above or the bytes that are there,
  /// events of places not rising, an event without number, times that are not finite, d that is
  /// negative or not finite, or a position that is not sound. Allocates nothing.
  static std::optional<Packet> parse(std::span<const std::byte> bytes);

  const PacketHead& head() const { return layout_.head; }
  std::size_t places() const { return layout_.places; }
  std::size_t crumbs() const { return layout_.crumbs; }
  /// i < places().
  Place place(std::size_t i) const;
  /// i < crumbs().
  Crumb crumb(std::size_t i) const;

 private:
  typename S::Position position(std::size_t i) const;
  PacketLayout layout_;
};

using MetricEncoder = Encoder<MetricSpace>;
using MetricPacket = Packet<MetricSpace>;

}  // namespace hearsay::trails

#include "filters/trails/codec_impl.hpp"
