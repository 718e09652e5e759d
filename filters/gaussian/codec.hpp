// Gaussian beliefs as bytes: little-endian XCDR1, the encoding of these DDS types:
//
//   struct GaussianBelief  { unsigned long subject;
//                            sequence<double> information_vector;    // n
//                            sequence<double> information_matrix; }; // upper triangle by rows,
//                            n(n+1)/2
//   struct GaussianMessage { unsigned long incarnation; unsigned long count;
//                            sequence<GaussianBelief> beliefs; };
//
//   struct StampedGaussianMessage { long long stamp_ns; …as GaussianMessage };  // of a moving
//   state
//
// (incarnation, count) orders a sender's messages across reboots. Four bytes of encapsulation
// header, then natural alignment counted from the end of the header, sequence lengths as uint32.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "filters/gaussian/belief.hpp"

namespace hearsay::gaussian {

struct BeliefEntry {
  std::uint32_t subject = 0;
  Belief belief;
};
struct Message {
  std::uint32_t incarnation = 0;
  std::uint32_t count = 0;
  std::vector<BeliefEntry> beliefs;
};
/// The beliefs are about states as they were at `stamp`.
struct StampedMessage {
  std::int64_t stamp = 0;
  Message message;
};

/// Exact number of bytes of a message of `beliefs` beliefs of dimension n each.
std::size_t encoded_size(std::size_t beliefs, int n);

/// Encodes into `out`, which is overwritten; its capacity is reused (no allocation once warm).
void encode(const Message& message, std::vector<std::byte>& out);

/// Decodes into `out`, reusing its storage. False, `out` unspecified, if the bytes are not exactly
/// one well-formed message: wrong header, truncated, trailing bytes, a dimension of 0 or beyond
/// dimension_max, lengths that disagree. Numbers are taken as they are (also NaN).
bool decode(std::span<const std::byte> bytes, Message& out);

// The same for a message with a stamp, which takes so many bytes more.
inline constexpr std::size_t stamp_bytes = 8;
void encode(const StampedMessage& message, std::vector<std::byte>& out);
bool decode(std::span<const std::byte> bytes, StampedMessage& out);

}  // namespace hearsay::gaussian
