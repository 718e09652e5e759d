// What is true of a moving target: position and velocity at stamps 0, 1, 2, …, one period apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/kernel/time.hpp"
#include "sim/world/motion.hpp"

namespace hearsay {

/// x, y in m, then their velocities in m/s.
using TargetState = std::array<double, 4>;

/// `count` states of one that moves along a path, in a row: 4·count numbers. At a corner the
/// velocity is that of the leg that begins there.
std::vector<double> target_states(Motion& motion, Duration period, std::size_t count);

/// White-noise acceleration: along each axis the acceleration is white noise of power spectral
/// density `psd_m2_per_s3` ≥ 0 (what a filter calls q), exact at the stamps. The k-th step draws
/// from Stream::at(seed, "target acceleration", target, k). Merino 2007, eq. 3.58–3.59.
std::vector<double> target_states(const TargetState& start, double psd_m2_per_s3, Duration period,
                                  std::size_t count, std::uint64_t seed, int target);

}  // namespace hearsay
