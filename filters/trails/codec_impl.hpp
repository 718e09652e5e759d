// The functions of Encoder and Packet. Included by codec.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "filters/gaussian/cdr.hpp"
#include "filters/trails/codec.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::trails {
namespace codec {

inline constexpr std::size_t place_size = 24, crumb_size = 32;

inline std::uint32_t word(std::span<const std::byte> bytes, std::size_t offset) {
  return gaussian::cdr::load<std::uint32_t>(bytes.data() + offset);
}
inline double number(std::span<const std::byte> bytes, std::size_t offset) {
  return std::bit_cast<double>(gaussian::cdr::load<std::uint64_t>(bytes.data() + offset));
}
inline Identity identity(std::span<const std::byte> bytes, std::size_t offset) {
  return {word(bytes, offset), word(bytes, offset + 4), word(bytes, offset + 8)};
}
void write_head(gaussian::cdr::Writer& writer, const PacketHead& head, std::size_t numbers);
void write_identity(gaussian::cdr::Writer& writer, const Identity& identity);

template <LocalizationSpace S>
bool sound(const PlaceOf<typename S::Position>& place) {
  return place.event != no_event && std::isfinite(place.time_s) && S::sound(place.position);
}
template <LocalizationSpace S>
bool sound(const CrumbOf<typename S::Position>& crumb) {
  return crumb.event != no_event && std::isfinite(crumb.created_s) &&
         std::isfinite(crumb.distance_s) && crumb.distance_s >= 0.0F && S::sound(crumb.position);
}

template <LocalizationSpace S>
void write_position(gaussian::cdr::Writer& writer, const typename S::Position& position) {
  std::array<float, S::numbers> floats{};
  S::put(position, floats);
  for (const float value : floats) writer.u32(std::bit_cast<std::uint32_t>(value));
}

template <LocalizationSpace S>
void write_body(gaussian::cdr::Writer& writer,
                std::span<const PlaceOf<typename S::Position>> places,
                std::span<const CrumbOf<typename S::Position>> crumbs) {
  writer.u32(places.size());
  for (const auto& place : places) {
    require(sound<S>(place), "trail codec: a place that no receiver would take");
    writer.f64(place.time_s);
    writer.u32(place.event);
    write_identity(writer, place.identity);
  }
  writer.u32(crumbs.size());
  for (const auto& crumb : crumbs) {
    require(sound<S>(crumb), "trail codec: a crumb that no receiver would take");
    writer.f64(crumb.created_s);
    writer.u32(crumb.event);
    writer.u32(crumb.goal);
    write_identity(writer, crumb.identity);
    writer.u32(std::bit_cast<std::uint32_t>(crumb.distance_s));
  }
  writer.u32((places.size() + crumbs.size()) * S::numbers);
  for (const auto& place : places) write_position<S>(writer, place.position);
  for (const auto& crumb : crumbs) write_position<S>(writer, crumb.position);
}

}  // namespace codec

template <LocalizationSpace S>
std::span<const std::vector<std::byte>> Encoder<S>::encode(const Message& message,
                                                           std::size_t mtu) {
  const std::size_t places = message.places.size(), crumbs = message.crumbs.size();
  const MessageSize size = message_size(S::numbers, places, crumbs, mtu);
  for (std::size_t i = 1; i < places; ++i) {
    require(message.places[i - 1].event < message.places[i].event,
            "trail codec: places by event, one each");
  }
  const std::size_t fit = crumbs_that_fit(S::numbers, places, mtu);
  if (packets_.size() < size.packets) packets_.resize(size.packets);
  for (std::size_t part = 0; part < size.packets; ++part) {
    const std::size_t count = std::min(fit, crumbs - part * fit);
    const std::size_t bytes = packet_size(S::numbers, places, count);
    gaussian::cdr::Writer writer =
        gaussian::cdr::begin(bytes - gaussian::cdr::header.size(), packets_[part]);
    codec::write_head(writer,
                      {message.sender, message.incarnation, message.count,
                       static_cast<std::uint32_t>(part), static_cast<std::uint32_t>(size.packets)},
                      S::numbers);
    codec::write_body<S>(writer, message.places, message.crumbs.subspan(part * fit, count));
  }
  return std::span(packets_).first(size.packets);
}

template <LocalizationSpace S>
std::optional<Packet<S>> Packet<S>::parse(std::span<const std::byte> bytes) {
  const std::optional<PacketLayout> layout = PacketLayout::read(bytes, S::numbers);
  if (!layout) return std::nullopt;
  Packet packet;
  packet.layout_ = *layout;
  for (std::size_t i = 0; i < packet.places(); ++i) {
    const Place place = packet.place(i);
    if (!codec::sound<S>(place)) return std::nullopt;
    if (i > 0 && packet.place(i - 1).event >= place.event) return std::nullopt;
  }
  for (std::size_t i = 0; i < packet.crumbs(); ++i) {
    if (!codec::sound<S>(packet.crumb(i))) return std::nullopt;
  }
  return packet;
}

template <LocalizationSpace S>
auto Packet<S>::position(std::size_t i) const -> typename S::Position {
  std::array<float, S::numbers> floats{};
  for (std::size_t k = 0; k < S::numbers; ++k) {
    floats[k] = std::bit_cast<float>(codec::word(layout_.positions, 4 * (i * S::numbers + k)));
  }
  return S::get(floats);
}

template <LocalizationSpace S>
auto Packet<S>::place(std::size_t i) const -> Place {
  const auto record = layout_.place_records.subspan(i * codec::place_size, codec::place_size);
  return {.event = codec::word(record, 8),
          .position = position(i),
          .time_s = codec::number(record, 0),
          .identity = codec::identity(record, 12)};
}

template <LocalizationSpace S>
auto Packet<S>::crumb(std::size_t i) const -> Crumb {
  const auto record = layout_.crumb_records.subspan(i * codec::crumb_size, codec::crumb_size);
  return {.event = codec::word(record, 8),
          .goal = codec::word(record, 12),
          .position = position(layout_.places + i),
          .distance_s = std::bit_cast<float>(codec::word(record, 28)),
          .created_s = codec::number(record, 0),
          .identity = codec::identity(record, 16)};
}

}  // namespace hearsay::trails
