// What trackers, localizers and explorers have of a world in another process: what their sensors
// see, and who hears of it; and who answers for them in the world.
#pragma once

#include <optional>
#include <vector>

#include "agents/grids/area_look.hpp"
#include "agents/grids/grid_mind.hpp"
#include "agents/pose_mind.hpp"
#include "agents/remote/distant_world.hpp"
#include "agents/sensors/target_scan.hpp"
#include "agents/track_mind.hpp"

namespace hearsay::remote {

class RemotePlots final : public PlotSource {
 public:
  /// `asker` outlives this.
  explicit RemotePlots(Asker& asker) : asking_(asker) {}
  void scan(std::uint64_t count, Plots& out) override;

 private:
  Asking asking_;
};

class TrackReporter final : public Reporter {
 public:
  /// `mind` outlives this.
  explicit TrackReporter(const TrackMind& mind) : mind_(mind) {}
  void report(Packer& out) override;

 private:
  const TrackMind& mind_;
};

/// Its tracks are told without their trails.
class TrackDesk final : public Desk, public TrackMind {
 public:
  /// `plots`: null for who has no sensor. It outlives this. `tracks_max`: that it may report.
  TrackDesk(PlotSource* plots, std::size_t tracks_max) : source_(plots), tracks_max_(tracks_max) {}
  void answer(Question question, Unpacker& in, Packer& out) override;
  bool is_sound(std::span<const std::byte> report) const override;
  gaussian::Stamp track_stamp() const override;
  std::vector<tracking::Report> confirmed_tracks() const override;

 private:
  PlotSource* source_;
  std::size_t tracks_max_;
  Plots plots_;
};

class RemoteSightings final : public SightingAccount {
 public:
  /// `asker` outlives this.
  explicit RemoteSightings(Asker& asker) : asking_(asker) {}
  void saw_place(AgentId agent, const Eigen::Vector2d& place_m,
                 const localization::RelativeSighting& seen) override;
  void saw_robot(AgentId agent, AgentId other, const localization::RelativeSighting& seen) override;

 private:
  Asking asking_;
};

class PoseReporter final : public Reporter {
 public:
  /// `mind` outlives this.
  explicit PoseReporter(PoseMind& mind) : mind_(mind) {}
  void report(Packer& out) override;

 private:
  PoseMind& mind_;
};

class PoseDesk final : public Desk, public PoseMind {
 public:
  /// Of robot `agent`, of so many. `account` outlives this.
  PoseDesk(SightingAccount& account, AgentId agent, AgentId robots)
      : account_(account), agent_(agent), robots_(robots) {}
  void answer(Question question, Unpacker& in, Packer& out) override;
  bool is_sound(std::span<const std::byte> report) const override;
  std::optional<PoseBelief> own_pose() override;

 private:
  SightingAccount& account_;
  AgentId agent_, robots_;
};

class RemoteLooks final : public LookSource {
 public:
  /// `asker` outlives this.
  explicit RemoteLooks(Asker& asker) : asking_(asker) {}
  Looks look(double heading_rad, std::uint64_t count) override;

 private:
  Asking asking_;
  std::vector<grid::CellLook> looks_;
  std::vector<std::uint32_t> indices_;
};

class GridReporter final : public Reporter {
 public:
  /// `mind` outlives this.
  explicit GridReporter(const GridMind& mind) : mind_(mind) {}
  void report(Packer& out) override;

 private:
  const GridMind& mind_;
};

class GridDesk final : public Desk, public GridMind {
 public:
  /// `looks`: null for who has no sensor. It outlives this.
  GridDesk(LookSource* looks, const grid::Area& area, const GridBelief::Options& belief);
  void answer(Question question, Unpacker& in, Packer& out) override;
  bool is_sound(std::span<const std::byte> report) const override;
  /// The prior where nobody knows.
  const GridBelief& belief() const override;
  const grid::LookLedger& ledger() const override;

 private:
  Unpacker take_evidence() const;

  LookSource* looks_;
  // As last reported.
  mutable GridBelief belief_;
  mutable std::vector<float> evidence_;
  mutable grid::LookLedger ledger_;
};

}  // namespace hearsay::remote
