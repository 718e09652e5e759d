// Trajectories as bytes: little-endian XCDR1, the encoding of these DDS types:
//
//   struct TrajectoryStep    { long long stamp_ns;
//                              sequence<double> information_vector;   // n: ξ_k
//                              sequence<double> information_matrix;   // upper triangle of Ω_k,k by
//                                                                     // rows, n(n+1)/2
//                              sequence<double> next_block; };        // Ω_k,k+1 by rows, n²; or
//                              none
//   struct TrajectoryBelief  { unsigned long subject; long long first_ns;
//                              sequence<TrajectoryStep> steps; };
//   struct TrajectoryMessage { unsigned long incarnation; unsigned long count;
//                              sequence<TrajectoryBelief> trajectories; };
//
// What was measured at each stamp has no blocks beside the diagonal; a whole trajectory has one
// between each step and the next. A step takes (n + n(n+1)/2 + n²)·8 bytes and 32 more; 20 steps in
// 6-D about 10 kB (Merino 2007, p. 73).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "filters/gaussian/trajectory.hpp"

namespace hearsay::gaussian {

struct TrajectoryStep {
  Stamp stamp = 0;     ///< in ns
  Belief information;  ///< Ω_k,k and ξ_k
  Matrix next;         ///< Ω_k,k+1 (n×n), or 0×0
};
struct TrajectoryEntry {
  std::uint32_t subject = 0;
  Stamp first = 0;  ///< in ns: of what was before it says nothing
  std::vector<TrajectoryStep> steps;
};
struct TrajectoryMessage {
  std::uint32_t incarnation = 0;
  std::uint32_t count = 0;
  std::vector<TrajectoryEntry> trajectories;
};

/// Encodes into `out`, which is overwritten; its capacity is reused.
void encode(const TrajectoryMessage& message, std::vector<std::byte>& out);

/// Decodes into `out`, reusing its storage. False, `out` unspecified, if the bytes are not exactly
/// one well-formed message, as for other beliefs (codec.hpp). Numbers are taken as they are.
bool decode(std::span<const std::byte> bytes, TrajectoryMessage& out);

}  // namespace hearsay::gaussian
