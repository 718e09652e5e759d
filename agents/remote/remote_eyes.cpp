#include "agents/remote/remote_eyes.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "agents/packed_beliefs.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::remote {
namespace {

// Bytes of a plot, a report (at least) and a look.
constexpr std::size_t plot_bytes = 48, report_bytes = 5 + 6 * 8, look_bytes = 28;

void put(Packer& out, const localization::RelativeSighting& seen) {
  for (const double x :
       {seen.range_m, seen.bearing_rad, seen.sigma_range_m, seen.sigma_bearing_rad}) {
    out.f64(x);
  }
}

localization::RelativeSighting take_sighting(Unpacker& in) {
  localization::RelativeSighting seen{};
  for (double* const x :
       {&seen.range_m, &seen.bearing_rad, &seen.sigma_range_m, &seen.sigma_bearing_rad}) {
    *x = in.f64();
  }
  return seen;
}

template <class M>
void put_numbers(Packer& out, const M& matrix) {
  for (int j = 0; j < matrix.cols(); ++j) {
    for (int i = 0; i < matrix.rows(); ++i) out.f64(matrix(i, j));
  }
}

template <class M>
void take_numbers(Unpacker& in, M& matrix) {
  for (int j = 0; j < matrix.cols(); ++j) {
    for (int i = 0; i < matrix.rows(); ++i) matrix(i, j) = in.f64();
  }
}

std::vector<tracking::Report> take_reports(Unpacker& in, std::size_t count) {
  std::vector<tracking::Report> reports(count);
  for (tracking::Report& report : reports) {
    report.label = in.u32();
    take(in, report.belief);
  }
  return reports;
}

/// Nothing unless it is one.
std::optional<PoseBelief> take_pose_belief(Unpacker in) {
  PoseBelief own{};
  for (double* const x : {&own.pose.x_m, &own.pose.y_m, &own.pose.heading_rad}) *x = in.f64();
  take_numbers(in, own.covariance);
  return in.done() ? std::optional(own) : std::nullopt;
}

}  // namespace

void RemotePlots::scan(std::uint64_t count, Plots& out) {
  asking_.begin(Question::plots).u64(count);
  Unpacker in = asking_.ask();
  out.coverage.centre.resize(0);
  out.coverage.range = std::numeric_limits<double>::infinity();
  if (in.flag()) {
    out.coverage.centre.resize(2);
    take_numbers(in, out.coverage.centre);
    out.coverage.range = in.f64();
  }
  out.plots.resize(in.count(plot_bytes));
  for (gaussian::PositionMeasurement& plot : out.plots) {
    plot.z.resize(2);
    plot.S.resize(2, 2);
    take_numbers(in, plot.z);
    take_numbers(in, plot.S);
  }
  require_whole(in);
}

void TrackReporter::report(Packer& out) {
  out.i64(mind_.track_stamp());
  const std::vector<tracking::Report> reports = mind_.confirmed_tracks();
  out.count(reports.size());
  for (const tracking::Report& report : reports) {
    out.u32(report.label);
    put(out, report.belief);
  }
}

void TrackDesk::answer(Question question, Unpacker& in, Packer& out) {
  require(question == Question::plots && source_, "a tracker elsewhere asks for what it has not");
  const std::uint64_t count = in.u64();
  require_whole(in);
  source_->scan(count, plots_);
  const bool placed = plots_.coverage.centre.size() == 2;
  out.flag(placed);
  if (placed) {
    put_numbers(out, plots_.coverage.centre);
    out.f64(plots_.coverage.range);
  }
  out.count(plots_.plots.size());
  for (const gaussian::PositionMeasurement& plot : plots_.plots) {
    require(plot.z.size() == 2, "a plot lies in the plane");
    put_numbers(out, plot.z);
    put_numbers(out, plot.S);
  }
}

bool TrackDesk::is_sound(std::span<const std::byte> report) const {
  Unpacker in(report);
  in.i64();
  const std::size_t count = in.count(report_bytes);
  if (count > tracks_max_) return false;
  const std::vector<tracking::Report> tracks = take_reports(in, count);
  return in.done() && std::all_of(tracks.begin(), tracks.end(), [](const auto& track) {
           const gaussian::Belief& belief = track.belief;
           return (belief.dimension() == 2 || belief.dimension() == 4) && belief.xi.allFinite() &&
                  belief.omega.allFinite();
         });
}

gaussian::Stamp TrackDesk::track_stamp() const { return state().i64(); }

std::vector<tracking::Report> TrackDesk::confirmed_tracks() const {
  Unpacker in = state();
  in.i64();
  return take_reports(in, in.count(report_bytes));
}

void RemoteSightings::saw_place(AgentId, const Eigen::Vector2d& place_m,
                                const localization::RelativeSighting& seen) {
  Packer out = asking_.begin(Question::saw_place);
  put_numbers(out, place_m);
  put(out, seen);
  asking_.note();
}

void RemoteSightings::saw_robot(AgentId, AgentId other,
                                const localization::RelativeSighting& seen) {
  Packer out = asking_.begin(Question::saw_robot);
  out.u32(static_cast<std::uint32_t>(other));
  put(out, seen);
  asking_.note();
}

void PoseReporter::report(Packer& out) {
  const std::optional<PoseBelief> own = mind_.own_pose();
  if (!own) return;
  for (const double x : {own->pose.x_m, own->pose.y_m, own->pose.heading_rad}) out.f64(x);
  put_numbers(out, own->covariance);
}

void PoseDesk::answer(Question question, Unpacker& in, Packer&) {
  if (question == Question::saw_place) {
    Eigen::Vector2d place_m;
    take_numbers(in, place_m);
    const localization::RelativeSighting seen = take_sighting(in);
    require_whole(in);
    account_.saw_place(agent_, place_m, seen);
    return;
  }
  require(question == Question::saw_robot, "a localizer elsewhere asks for what it has not");
  const std::uint32_t other = in.u32();
  require(other < static_cast<std::uint32_t>(robots_), "a localizer saw a robot that is not there");
  const localization::RelativeSighting seen = take_sighting(in);
  require_whole(in);
  account_.saw_robot(agent_, static_cast<AgentId>(other), seen);
}

bool PoseDesk::is_sound(std::span<const std::byte> report) const {
  const std::optional<PoseBelief> own = take_pose_belief(Unpacker(report));
  if (!own) return false;
  const bool finite = std::isfinite(own->pose.x_m) && std::isfinite(own->pose.y_m) &&
                      std::isfinite(own->pose.heading_rad) && own->covariance.allFinite();
  return finite && Eigen::LLT<Eigen::Matrix3d>(own->covariance).info() == Eigen::Success;
}

std::optional<PoseBelief> PoseDesk::own_pose() { return take_pose_belief(state()); }

Looks RemoteLooks::look(double heading_rad, std::uint64_t count) {
  Packer out = asking_.begin(Question::look);
  out.f64(heading_rad);
  out.u64(count);
  Unpacker in = asking_.ask();
  looks_.resize(in.count(look_bytes));
  for (grid::CellLook& look : looks_) {
    look.cell = static_cast<int>(in.u32());
    look.ratio = in.f64();
    look.m = in.f64();
    look.n = in.f64();
  }
  indices_.resize(in.count(4));
  for (std::uint32_t& index : indices_) index = in.u32();
  require_whole(in);
  return {looks_, indices_};
}

void GridReporter::report(Packer& out) {
  for (const float evidence : mind_.belief().evidence()) out.f32(evidence);
  put(out, mind_.ledger());
}

GridDesk::GridDesk(LookSource* looks, const grid::Area& area, const GridBelief::Options& belief)
    : looks_(looks), belief_(area, belief), evidence_(belief_.evidence().size()) {}

void GridDesk::answer(Question question, Unpacker& in, Packer& out) {
  require(question == Question::look && looks_, "an explorer elsewhere asks for what it has not");
  const double heading_rad = in.f64();
  const std::uint64_t count = in.u64();
  require_whole(in);
  const Looks seen = looks_->look(heading_rad, count);
  out.count(seen.looks.size());
  for (const grid::CellLook& look : seen.looks) {
    out.u32(static_cast<std::uint32_t>(look.cell));
    out.f64(look.ratio);
    out.f64(look.m);
    out.f64(look.n);
  }
  out.count(seen.indices.size());
  for (const std::uint32_t index : seen.indices) out.u32(index);
}

bool GridDesk::is_sound(std::span<const std::byte> report) const {
  Unpacker in(report);
  bool finite = true;
  for (std::size_t i = 0; i < evidence_.size(); ++i) finite = std::isfinite(in.f32()) && finite;
  grid::LookLedger ledger;
  take(in, belief_.shape(), ledger);
  return finite && in.done();
}

// Zeros, where nothing came, are the prior.
Unpacker GridDesk::take_evidence() const {
  Unpacker in = state();
  for (float& evidence : evidence_) evidence = in.f32();
  return in;
}

const GridBelief& GridDesk::belief() const {
  take_evidence();
  belief_.assign(evidence_);
  return belief_;
}

const grid::LookLedger& GridDesk::ledger() const {
  Unpacker in = take_evidence();
  take(in, belief_.shape(), ledger_);
  return ledger_;
}

}  // namespace hearsay::remote
