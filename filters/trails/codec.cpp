#include "filters/trails/codec.hpp"

namespace hearsay::trails {
namespace {

using gaussian::cdr::aligned;
using gaussian::cdr::Reader;
using gaussian::cdr::Writer;

constexpr std::size_t head_size = 24;  // six words

/// The end of a sequence of records whose length stands at `offset`: records begin at multiples of
/// 8, if there are any.
std::size_t after_records(std::size_t offset, std::size_t count, std::size_t size) {
  const std::size_t begin = offset + 4;
  return count == 0 ? begin : aligned(begin, 8) + count * size;
}

bool read_records(Reader& reader, std::size_t size, std::size_t most, std::size_t& count,
                  std::span<const std::byte>& out) {
  std::uint32_t said = 0;
  if (!reader.u32(said) || said > most) return false;
  count = said;
  if (count == 0) return true;
  if (!reader.has_f64(count * size / 8)) return false;
  out = reader.records(count * size);
  return true;
}

}  // namespace

namespace codec {

void write_head(Writer& writer, const PacketHead& head, std::size_t numbers) {
  writer.u32(head.sender);
  writer.u32(head.incarnation);
  writer.u32(head.count);
  writer.u32(head.part);
  writer.u32(head.parts);
  writer.u32(numbers);
}

void write_identity(Writer& writer, const Identity& identity) {
  writer.u32(identity.robot);
  writer.u32(identity.incarnation);
  writer.u32(identity.number);
}

}  // namespace codec

std::size_t packet_size(std::size_t numbers, std::size_t places, std::size_t crumbs) {
  require(numbers >= 1 && numbers <= position_numbers_max, "trail codec: numbers a position");
  const std::size_t after_places = after_records(head_size, places, codec::place_size);
  const std::size_t after_crumbs = after_records(after_places, crumbs, codec::crumb_size);
  return gaussian::cdr::header.size() + after_crumbs + 4 + 4 * numbers * (places + crumbs);
}

std::size_t crumbs_that_fit(std::size_t numbers, std::size_t places, std::size_t mtu) {
  const std::size_t with_one = packet_size(numbers, places, 1);
  if (mtu < with_one) return 0;
  const std::size_t fit = 1 + (mtu - with_one) / (codec::crumb_size + 4 * numbers);
  return fit < packet_crumbs_max ? fit : packet_crumbs_max;
}

MessageSize message_size(std::size_t numbers, std::size_t places, std::size_t crumbs,
                         std::size_t mtu) {
  require(places <= packet_places_max, "trail codec: more places than a packet may have");
  if (crumbs == 0) {
    const std::size_t bytes = packet_size(numbers, places, 0);
    require(bytes <= mtu, "trail codec: the places do not fit into the MTU");
    return {1, bytes};
  }
  const std::size_t fit = crumbs_that_fit(numbers, places, mtu);
  require(fit >= 1, "trail codec: places and one crumb do not fit into the MTU");
  const std::size_t packets = (crumbs + fit - 1) / fit;
  require(packets <= packet_parts_max, "trail codec: more packets than a message may have");
  const std::size_t rest = crumbs - (packets - 1) * fit;
  return {packets,
          (packets - 1) * packet_size(numbers, places, fit) + packet_size(numbers, places, rest)};
}

std::optional<PacketLayout> PacketLayout::read(std::span<const std::byte> bytes,
                                               std::size_t numbers) {
  std::optional<Reader> reader = gaussian::cdr::body_of(bytes);
  PacketLayout layout;
  PacketHead& head = layout.head;
  std::uint32_t said_numbers = 0, floats = 0;
  if (!reader || !reader->u32(head.sender) || !reader->u32(head.incarnation) ||
      !reader->u32(head.count) || !reader->u32(head.part) || !reader->u32(head.parts) ||
      !reader->u32(said_numbers)) {
    return std::nullopt;
  }
  if (head.part >= head.parts || head.parts > packet_parts_max || said_numbers != numbers) {
    return std::nullopt;
  }
  if (!read_records(*reader, codec::place_size, packet_places_max, layout.places,
                    layout.place_records) ||
      !read_records(*reader, codec::crumb_size, packet_crumbs_max, layout.crumbs,
                    layout.crumb_records)) {
    return std::nullopt;
  }
  const std::size_t expected = (layout.places + layout.crumbs) * numbers;
  if (!reader->u32(floats) || floats != expected || reader->left() != 4 * expected) {
    return std::nullopt;
  }
  layout.positions = reader->octets(4 * expected);
  return layout;
}

}  // namespace hearsay::trails
