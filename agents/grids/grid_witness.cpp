#include "agents/grids/grid_witness.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// A threshold as the subject of its rows: "0.8"; the shortest text that no other number has.
std::string name_of(double threshold) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), threshold).ptr;
  return {text.data(), end};
}

std::vector<unsigned char> truth_of(const grid::Area& area, std::span<const grid::Point> targets) {
  std::vector<unsigned char> truth(static_cast<std::size_t>(area.cells()), 0);
  for (const grid::Point& target : targets) {
    if (const auto cell = area.at(target)) truth[static_cast<std::size_t>(*cell)] = 1;
  }
  return truth;
}

}  // namespace

GridWitness::GridWitness(Simulation& simulation, Options options)
    : simulation_(simulation),
      options_(std::move(options)),
      truth_(truth_of(options_.area, options_.targets)),
      book_(GridBelief(options_.area, options_.belief).shape()),
      central_(options_.area, options_.belief) {
  require(!options_.thresholds.empty(), "GridWitness: there is no threshold");
  const auto wants = [&](const char* name) {
    return std::find(options_.series.begin(), options_.series.end(), name) != options_.series.end();
  };
  wanted_ = {.kl = wants("kl_to_central_nats"),
             .entropy = wants("entropy_nats"),
             .disagreement = wants("disagreement_probability"),
             .place = wants("place_x_m") || wants("place_y_m"),
             .multiplicity_mean = options_.ledger && wants("multiplicity_mean"),
             .multiplicity_max = options_.ledger && wants("multiplicity_max"),
             .multiplicity_share = options_.ledger && wants("multiplicity_share"),
             .detected = wants("alarms_detected_share"),
             .false_alarms = wants("alarms_false"),
             .position_error = wants("alarm_error_m"),
             .cells_detected = wants("cells_detected_share"),
             .cells_false = wants("cells_false_share"),
             .cells_hearsay = wants("cells_hearsay")};
  for (const double threshold : options_.thresholds) {
    threshold_names_.push_back(simulation_.record().name(name_of(threshold)));
  }
}

std::span<const std::uint32_t> GridWitness::looked(AgentId agent,
                                                   std::span<const grid::CellLook> looks) {
  central_.add(looks);
  looks_ += looks.size();
  indices_.clear();
  if (options_.ledger) {
    for (const grid::CellLook& look : looks) indices_.push_back(book_.add(look));
  }
  const auto at = std::lower_bound(watched_.begin(), watched_.end(), agent,
                                   [](const Watched& w, AgentId id) { return w.agent < id; });
  require(at != watched_.end() && at->agent == agent, "GridWitness: nobody watches who looked");
  for (const grid::CellLook& look : looks) at->seen[static_cast<std::size_t>(look.cell)] = 1;
  return indices_;
}

void GridWitness::watch(AgentId agent, const GridMind& mind) {
  watched_.push_back({agent, &mind, std::vector<unsigned char>(truth_.size(), 0), {}});
}

void GridWitness::start() { schedule_sample(Time()); }

void GridWitness::schedule_sample(Time at) {
  if (at > simulation_.end()) return;
  simulation_.schedule(at, Phase::observe, [this, at] {
    sample();
    schedule_sample(at + options_.period);
  });
}

void GridWitness::sample() {
  const Time now = simulation_.now();
  last_sample_ = now;
  sample(central_agent, central_);
  if (!central_found_ && finds_all(central_)) central_found_ = now;
  if (wanted_.disagreement) sample_disagreement();
  for (Watched& watched : watched_) {
    const GridBelief& belief = watched.mind->belief();
    sample(watched.agent, belief);
    sample_ledger(watched);
    if (!watched.found && finds_all(belief)) watched.found = now;
  }
}

void GridWitness::keep(AgentId agent, NameId subject, const char* name, double value,
                       Origin origin) {
  Record& record = simulation_.record();
  record.series(simulation_.now(), agent, subject, record.name(name), value, origin);
}

void GridWitness::sample(AgentId agent, const GridBelief& belief) {
  const NameId whole = simulation_.record().name("");
  const bool central = agent == central_agent;
  if (wanted_.kl && !central) {
    keep(agent, whole, "kl_to_central_nats", central_.divergence(belief).value_or(none));
  }
  if (wanted_.entropy) {
    keep(agent, whole, "entropy_nats", belief.total_entropy().value_or(none));
  }
  if (wanted_.place && !central) {
    const Point place = options_.place_of(agent);
    keep(agent, whole, "place_x_m", place[0]);
    keep(agent, whole, "place_y_m", place[1]);
  }
  if (wanted_.alarms()) sample_alarms(agent, belief);
}

void GridWitness::sample_alarms(AgentId agent, const GridBelief& belief) {
  for (std::size_t i = 0; i < options_.thresholds.size(); ++i) {
    const double threshold = options_.thresholds[i];
    const NameId subject = threshold_names_[i];
    if (wanted_.detected || wanted_.false_alarms || wanted_.position_error) {
      const grid::Match match =
          grid::match(belief.regions(finder_, threshold), options_.targets, options_.gate_m);
      const double targets = static_cast<double>(options_.targets.size());
      if (wanted_.detected) keep(agent, subject, "alarms_detected_share", match.detected / targets);
      if (wanted_.false_alarms) keep(agent, subject, "alarms_false", match.false_alarms);
      if (wanted_.position_error) {
        keep(agent, subject, "alarm_error_m", match.detected > 0 ? match.position_error_m : none);
      }
    }
    if (!wanted_.cells_detected && !wanted_.cells_false && !wanted_.cells_hearsay) continue;
    belief.mark_above(threshold, marks_);
    const grid::CellRates rates = grid::cell_rates(marks_, truth_);
    if (wanted_.cells_detected) {
      keep(agent, subject, "cells_detected_share",
           rates.hits / static_cast<double>(rates.true_cells));
    }
    if (wanted_.cells_false) {
      keep(agent, subject, "cells_false_share",
           rates.false_alarms / static_cast<double>(rates.empty_cells));
    }
    if (!wanted_.cells_hearsay || agent == central_agent) continue;
    central_.mark_above(threshold, central_marks_);
    int hearsay = 0;
    for (std::size_t k = 0; k < marks_.size(); ++k) hearsay += marks_[k] > central_marks_[k];
    keep(agent, subject, "cells_hearsay", hearsay);
  }
}

void GridWitness::sample_ledger(const Watched& watched) {
  if (!wanted_.multiplicity_mean && !wanted_.multiplicity_max && !wanted_.multiplicity_share)
    return;
  const grid::LookMultiplicity counted = grid::multiplicity(watched.mind->ledger(), book_);
  const NameId whole = simulation_.record().name("");
  const bool any = counted.looks > 0;
  const auto leave = [&](bool wanted, const char* name, double value) {
    if (wanted) keep(watched.agent, whole, name, any ? value : none, Origin::ledger);
  };
  leave(wanted_.multiplicity_mean, "multiplicity_mean", counted.mean);
  leave(wanted_.multiplicity_max, "multiplicity_max", counted.max);
  leave(wanted_.multiplicity_share, "multiplicity_share", counted.share_above_one);
}

void GridWitness::sample_disagreement() {
  lowest_.assign(truth_.size(), 1.0F);
  highest_.assign(truth_.size(), 0.0F);
  for (const Watched& watched : watched_) {
    const GridBelief& belief = watched.mind->belief();
    for (std::size_t k = 0; k < truth_.size(); ++k) {
      const auto p = belief.probability(static_cast<int>(k));
      if (!p) continue;
      lowest_[k] = std::min(lowest_[k], static_cast<float>(*p));
      highest_[k] = std::max(highest_[k], static_cast<float>(*p));
    }
  }
  double sum = 0.0;
  for (std::size_t k = 0; k < truth_.size(); ++k) {
    sum += std::max(0.0, static_cast<double>(highest_[k]) - static_cast<double>(lowest_[k]));
  }
  keep(central_agent, simulation_.record().name(""), "disagreement_probability",
       sum / static_cast<double>(truth_.size()));
}

bool GridWitness::finds_all(const GridBelief& belief) {
  if (options_.targets.empty()) return false;
  // As cheap as can be where nothing is over the threshold yet.
  if (belief.mark_above(options_.thresholds.front(), marks_) == 0) return false;
  const auto regions = belief.regions(finder_, options_.thresholds.front());
  return grid::match(regions, options_.targets, options_.gate_m).missed == 0;
}

void GridWitness::finish() {
  if (last_sample_ != simulation_.now()) sample();
  Record& record = simulation_.record();
  const auto found_s = [&](const std::optional<Time>& found) {
    return found ? (*found - Time()).seconds() : std::numeric_limits<double>::infinity();
  };
  if (!options_.targets.empty()) {
    record.scalar(central_agent, record.name("alarms_found_s"), found_s(central_found_));
  }
  record.scalar(central_agent, record.name("measurements"), static_cast<double>(looks_));
  for (const Watched& watched : watched_) {
    if (!options_.targets.empty()) {
      record.scalar(watched.agent, record.name("alarms_found_s"), found_s(watched.found));
    }
  }
  leave_seen();
  if (!options_.grids) return;
  leave_grid(central_agent, central_);
  for (const Watched& watched : watched_) leave_grid(watched.agent, watched.mind->belief());
}

void GridWitness::leave_seen() {
  Record& record = simulation_.record();
  std::vector<int> by(truth_.size(), 0);
  const double cells = static_cast<double>(truth_.size());
  for (const Watched& watched : watched_) {
    int seen = 0;
    for (std::size_t k = 0; k < truth_.size(); ++k) {
      seen += watched.seen[k];
      by[k] += watched.seen[k];
    }
    record.scalar(watched.agent, record.name("cells_seen_share"), seen / cells);
  }
  const auto seen = std::count_if(by.begin(), by.end(), [](int agents) { return agents > 0; });
  const int looked = std::accumulate(by.begin(), by.end(), 0);
  record.scalar(central_agent, record.name("cells_seen_share"), static_cast<double>(seen) / cells);
  record.scalar(central_agent, record.name("agents_a_cell"), looked / static_cast<double>(seen));
}

void GridWitness::leave_grid(AgentId agent, const GridBelief& belief) {
  Record& record = simulation_.record();
  for (int k = 0; k < options_.area.cells(); ++k) {
    const grid::Cell cell = options_.area.cell(k);
    const NameId subject =
        record.name(std::to_string(cell.column) + "," + std::to_string(cell.row));
    keep(agent, subject, "cell_probability", belief.probability(k).value_or(none));
    const auto beta = belief.beta(k);
    if (!beta) continue;
    keep(agent, subject, "cell_alpha", beta->alpha);
    keep(agent, subject, "cell_beta", beta->beta);
  }
}

}  // namespace hearsay
