// Messages of air.idl in packets, ours beside Cyclone's.
#pragma once

#include <gtest/gtest.h>
#include <hearsay/idl/air.h>

#include "net/live/envelope.hpp"
#include "tests/net/live/cyclone.hpp"

namespace hearsay::live {

inline Envelope some_envelope(Stream& random) {
  return {word(random), word(random), random.bits(), stamp(random), stamp(random), random.bits()};
}
inline hearsay_Envelope in_c(const Envelope& e) {
  return {e.sender, e.receiver, e.number, e.sent_ns, e.tick, e.subject};
}

/// A message and, behind an envelope, the packet of it.
template <class Packet, class Part>
void expect_packet(const dds_topic_descriptor_t& type, const Part& message, const Bytes& bytes,
                   Stream& random) {
  const Envelope envelope = some_envelope(random);
  const Packet packet{in_c(envelope), message};
  Bytes packed;
  pack(envelope, bytes, packed);
  expect_same(type, &packet, packed);
  Envelope back;
  std::span<std::byte> inside;
  ASSERT_TRUE(unpack(packed, back, inside));
  EXPECT_EQ(back, envelope);
  EXPECT_EQ(Bytes(inside.begin(), inside.end()), bytes);
}

}  // namespace hearsay::live
