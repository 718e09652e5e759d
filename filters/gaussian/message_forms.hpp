// What else than whole beliefs agents send, as bytes: little-endian XCDR1 of these DDS types, each
// message beginning with unsigned long incarnation and count as in codec.hpp.
//
//   split       sequence<SplitBelief>: subject, ξ, Ω and sequence<double> independent_matrix
//   consensus   unsigned long degree; sequence<GaussianBelief>
//   hybrid      unsigned long degree; sequence<HybridBelief>: subject, ξ, Ω, and of what was
//   measured
//               since the last sending another ξ and Ω
//   diagonal    sequence<DiagonalBelief>: subject, ξ, sequence<double> diagonal  // n
//   quantised   octet dimension, bits; sequence<QuantisedBelief>: subject and sequence<octet> body:
//               n times (octet exponent, long mean), unaligned, then the entries of N by rows,
//               `bits` each, from the lowest bit of the first octet on
//
// Matrices are upper triangles by rows. Of a moving state each of them stands behind a long long
// stamp_ns, as in codec.hpp.
#pragma once

#include "filters/gaussian/codec.hpp"
#include "filters/gaussian/content.hpp"

namespace hearsay::gaussian {

enum class MessageForm { plain, split, consensus, hybrid, diagonal, quantised };

/// What stands beside the beliefs of a Message, entry by entry, as its form has it.
struct MessageExtras {
  std::uint32_t degree = 0;                ///< consensus, hybrid: neighbours of the sender
  std::vector<Belief> fresh;               ///< split (Ω alone), hybrid
  int bits = 8;                            ///< quantised: 4 … 16
  std::vector<QuantisedBelief> quantised;  ///< from which decode() makes the message's beliefs
};

/// Exact number of bytes of a message of `beliefs` beliefs of dimension n each.
std::size_t encoded_size(MessageForm form, std::size_t beliefs, int n, int bits = 8);

/// Encodes into `out`, which is overwritten, its capacity reused.
void encode(MessageForm form, const Message& message, const MessageExtras& extras,
            std::vector<std::byte>& out);

/// As decode() of codec.hpp. Also false for another number of bits than 4 to 16, and for quantised
/// beliefs without a positive definite covariance.
bool decode(MessageForm form, std::span<const std::byte> bytes, Message& message,
            MessageExtras& extras);

// The same for a message with a stamp, which takes stamp_bytes more.
void encode(MessageForm form, const StampedMessage& message, const MessageExtras& extras,
            std::vector<std::byte>& out);
bool decode(MessageForm form, std::span<const std::byte> bytes, StampedMessage& message,
            MessageExtras& extras);

}  // namespace hearsay::gaussian
