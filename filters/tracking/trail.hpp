// The trail of a track: its trajectory over the last scans that saw it, of own plots alone. Two
// targets that meet cannot be told apart by their states at that instant, but by their trails.
#pragma once

#include <optional>

#include "filters/gaussian/belief.hpp"
#include "filters/gaussian/trajectory.hpp"
#include "filters/gaussian/transition.hpp"

namespace hearsay::tracking {

/// The bound that χ² with `degrees` degrees of freedom exceeds as rarely as χ² with `n` exceeds
/// `gate`, all > 0, by Wilson & Hilferty's cube root (1931): its probability is right to 6 % of
/// itself for n ≥ 4 and gates up to 16.
double equivalent_gate(double gate, int n, int degrees);

/// How far two trails of the same dimension n are apart, to be compared with `gate` like d² of two
/// states: d² of both trajectories over their common stamps times
/// gate/equivalent_gate(gate, n, n·stamps). Nothing without common stamps, or where one is singular
/// there. Linear in the number of stamps. (As both assume the same random accelerations, trails of
/// one object are nearer than χ² says; so right pairs lie outside the gate even more rarely.)
std::optional<double> trail_separation(const gaussian::Trajectory& a, const gaussian::Trajectory& b,
                                       double gate);

/// Adds what is seen at a stamp that is not before the last; `motion` leads there from the last.
/// Stamps before `oldest` are marginalised.
void extend(gaussian::Trajectory& trail, gaussian::Stamp stamp, const gaussian::Belief& seen,
            const std::optional<gaussian::Transition>& motion, gaussian::Stamp oldest);

}  // namespace hearsay::tracking
