// Tracks with their trails as a message: a TrajectoryMessage
// (filters/gaussian/trajectory_codec.hpp) with labels for subjects. Of each track it has the steps
// of its trail, if there is one; and, as a last step that no block ties to them, the belief about
// the sender's present.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "filters/gaussian/trajectory_codec.hpp"
#include "filters/tracking/tracker.hpp"

namespace hearsay {

/// All but `incarnation` and `count`; `now` is the stamp of the beliefs.
void put_tracks(std::span<const tracking::Report> reports, gaussian::Stamp now,
                gaussian::TrajectoryMessage& out);

/// The stamp of the beliefs, and `out` the tracks; nothing, `out` unspecified, if the message is no
/// such thing: without tracks, of several presents, or with a trail that is none or lies ahead.
std::optional<gaussian::Stamp> take_tracks(const gaussian::TrajectoryMessage& message,
                                           std::vector<tracking::Report>& out);

}  // namespace hearsay
