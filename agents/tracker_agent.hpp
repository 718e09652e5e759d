// The tracker agent: scans, keeps tracks of what it finds, tells others of them, and takes in what
// they tell. It does not know how many targets there are, nor whose plot is whose.
//
// A message is a StampedGaussianMessage (filters/gaussian/codec.hpp) with the sender's clock in ns
// as its stamp and the labels of its tracks in place of subjects; with trails it is that of
// trail_message.hpp. Both kinds are understood by all.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "agents/agent.hpp"
#include "agents/sensors/target_scan.hpp"
#include "agents/talk/periodic.hpp"
#include "agents/track_mind.hpp"
#include "filters/gaussian/codec.hpp"
#include "filters/gaussian/trajectory_codec.hpp"
#include "filters/tracking/tracker.hpp"

namespace hearsay {

class TrackerAgent final : public Agent, public TrackMind {
 public:
  struct Options {
    tracking::Tracker::Options tracker;  ///< two axes, stamps in nanoseconds
    PlotSource* scanner = nullptr;       ///< null: it knows what others tell, no more. Not owned
    Duration sensor_period = Duration::nanoseconds(1'000'000'000);
    Time sensor_start;
    Time sensor_end = Time::never();
    std::optional<PeriodicTalk> talk;  ///< nothing: never talks
  };
  TrackerAgent(Context& context, Options options);

  void start() override;
  void on_packet(const Packet& packet) override;
  /// One that lost its memory has no tracks, and counts its labels anew.
  void on_up(bool forgets) override;
  /// Leaves what it counted.
  void finish() override;

  const tracking::Tracker& tracker() const { return tracker_; }
  gaussian::Stamp track_stamp() const override { return tracker_.stamp(); }
  std::vector<tracking::Report> confirmed_tracks() const override { return tracker_.reports(); }

 private:
  Process look();
  Process talk();
  void say(std::uint64_t tick);
  void tell(std::span<const tracking::Report> reports);
  void tell_with_trails(std::span<const tracking::Report> reports);
  /// What a message says; its tracks are in reports_.
  struct Told {
    std::uint32_t incarnation, count;
    gaussian::Stamp stamp;
  };
  std::optional<Told> told(const Packet& packet);
  bool outdated(AgentId from, const Told& told);

  Options options_;
  tracking::Tracker tracker_;
  NameId tracks_kind_, trails_kind_;
  struct Heard {
    AgentId from;
    std::uint32_t incarnation, count;
  };
  std::vector<Heard> heard_;  // the newest message of each
  std::uint32_t incarnation_ = 0;
  std::uint32_t next_count_ = 1;
  std::uint64_t refused_ = 0;
  tracking::Tracker::Counts before_;  // of the trackers it has forgotten
  gaussian::StampedMessage message_;
  gaussian::TrajectoryMessage trails_;
  std::vector<std::byte> bytes_;
  Plots plots_;
  std::vector<tracking::Report> reports_;
};

}  // namespace hearsay
