#include "agents/witness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "filters/gaussian/distance.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double& at(std::array<double, series_metric_count>& values, Metric metric) {
  return values[static_cast<std::size_t>(metric)];
}

/// Its order is lost. Nothing of nothing.
double median(std::vector<double>& values) {
  if (values.empty()) return kNone;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool is_ledger(Metric metric) { return metrics()[static_cast<std::size_t>(metric)].ledger; }

}  // namespace

std::span<const double> Subject::truth_at(std::int64_t stamp, int n) const {
  const auto size = static_cast<std::size_t>(n);
  const std::size_t last = truth.size() / size - 1;
  const std::size_t k = std::min(static_cast<std::size_t>(stamp), last);
  return std::span(truth).subspan(k * size, size);
}

Witness::Witness(Simulation& simulation, Options options)
    : simulation_(simulation), options_(std::move(options)) {
  require(!options_.subjects.empty(), "a witness needs a subject");
  dimension_ = options_.motion ? static_cast<int>(options_.motion->step.A.rows())
                               : static_cast<int>(options_.subjects.front().truth.size());
  axes_ = options_.motion ? dimension_ / 2 : dimension_;
  Record& record = simulation_.record();
  for (std::size_t m = 0; m < series_metric_count; ++m) {
    metric_names_[m] = record.name(metrics()[m].name);
  }
  for (const Metric metric : options_.series) wanted_[static_cast<std::size_t>(metric)] = true;
  if (options_.agreement) agreement_.emplace(*options_.agreement);
  workspace_.measured_at.resize(options_.subjects.size());
  for (const Subject& subject : options_.subjects) {
    const auto numbers = static_cast<int>(subject.truth.size());
    require(options_.motion ? numbers > 0 && numbers % dimension_ == 0 : numbers == dimension_,
            "subjects of one run differ in dimension");
    subject_names_.push_back(record.name(subject.name));
    books_.emplace_back(dimension_);
    books_.back().set_motion(subject.motion_noise);
    central_.push_back({gaussian::Belief::unknown(dimension_), Ledger{}});
    spreads_.emplace_back(axes_);
  }
}

std::size_t Witness::measured(int subject, const gaussian::Belief& information) {
  advance();
  const auto s = static_cast<std::size_t>(subject);
  central_[s].belief += information;
  ++measurements_;
  if (!options_.ledger) return 0;
  if (options_.motion) workspace_.measured_at[s].push_back(stamp_);
  const std::size_t index = books_[s].add(information);
  central_[s].ledger.measured(index);
  return index;
}

void Witness::watch(AgentId agent, Believer& believer) {
  watched_.push_back({.agent = agent, .believer = &believer});
}

void Witness::advance() {
  if (!options_.motion) return;
  const std::int64_t now = options_.motion->stamp_at(simulation_.now());
  for (; stamp_ < now; ++stamp_) {
    for (TrackedBelief& central : central_) {
      central.belief = gaussian::predict(central.belief, options_.motion->step);
    }
  }
}

void Witness::start() {
  schedule_sample(Time());
  if (agreement_) schedule_agreement(agreement_->options().from);
}

void Witness::schedule_sample(Time at) {
  if (at > simulation_.end()) return;
  simulation_.schedule(at, Phase::observe, [this, at] {
    sample();
    schedule_sample(at + options_.series_period);
  });
}

void Witness::schedule_agreement(Time at) {
  if (at > simulation_.end()) return;
  simulation_.schedule(at, Phase::observe, [this, at] {
    sample_agreement();
    schedule_agreement(at + agreement_->options().period);
  });
}

void Witness::gather_spreads() {
  advance();
  for (const Watched& watched : watched_) watched.believer->advance(stamp_);
  for (std::size_t s = 0; s < spreads_.size(); ++s) {
    spreads_[s].clear();
    for (const Watched& watched : watched_) {
      if (!up(watched.agent)) continue;
      auto estimate = gaussian::state(watched.believer->tracked(static_cast<int>(s)).belief);
      if (estimate) estimate->conservativeResize(axes_);
      spreads_[s].add(estimate);
    }
  }
}

void Witness::sample_agreement() {
  gather_spreads();
  const bool agreed = std::all_of(spreads_.begin(), spreads_.end(), [this](const Spread& spread) {
    return agreement_->holds(spread);
  });
  agreement_->sample(simulation_.now(), agreed);
}

double Witness::disagreement(const Watched& watched, const gaussian::Assessment& assessment,
                             int subject) const {
  if (!assessment.state || !assessment.state->allFinite() || !up(watched.agent)) return kNone;
  return spreads_[static_cast<std::size_t>(subject)]
      .farthest(assessment.state->head(axes_))
      .value_or(kNone);
}

void Witness::sample() {
  last_sample_ = simulation_.now();
  advance();
  if (wants(Metric::disagreement_m)) gather_spreads();
  const int subjects = static_cast<int>(options_.subjects.size());
  for (int s = 0; s < subjects; ++s) {
    const TrackedBelief& central = central_[static_cast<std::size_t>(s)];
    Values values = measure(central, gaussian::assess(central.belief), s, true);
    if (wants(Metric::disagreement_m)) {
      at(values, Metric::disagreement_m) =
          spreads_[static_cast<std::size_t>(s)].width().value_or(kNone);
    }
    keep(central_agent, s, values);
    keep_distance(central_distances_m_, values);
  }
  for (Watched& watched : watched_) {
    watched.believer->advance(stamp_);
    for (int s = 0; s < subjects; ++s) sample(watched, s);
  }
}

void Witness::sample(Watched& watched, int subject) {
  const TrackedBelief& tracked = watched.believer->tracked(subject);
  const gaussian::Assessment assessment = gaussian::assess(tracked.belief);
  Values values = measure(tracked, assessment, subject, false);
  if (wants(Metric::disagreement_m)) {
    at(values, Metric::disagreement_m) = disagreement(watched, assessment, subject);
  }
  ++watched.samples;
  if (at(values, Metric::not_positive) != 0.0) ++watched.not_positive;
  if (options_.ledger) {
    watched.reach_gap_max = std::max(watched.reach_gap_max, at(values, Metric::reach_gap));
  }
  if (!watched.overflow_told && assessment.definiteness == gaussian::Definiteness::overflow) {
    watched.overflow_told = true;
    simulation_.record().event(simulation_.now(), watched.agent, "belief overflow",
                               options_.subjects[static_cast<std::size_t>(subject)].name);
  }
  keep(watched.agent, subject, values);
  keep_distance(watched.distances_m, values);
}

void Witness::keep_distance(std::vector<double>& distances_m, const Values& values) const {
  if (!options_.motion) return;
  const double error_m = values[static_cast<std::size_t>(Metric::rms_error_m)];
  distances_m.push_back(std::isnan(error_m) ? std::numeric_limits<double>::infinity()
                                            : error_m * std::sqrt(double(axes_)));
}

void Witness::keep(AgentId agent, int subject, const Values& values) {
  Record& record = simulation_.record();
  for (const Metric metric : options_.series) {
    if (is_ledger(metric) && !options_.ledger) continue;
    // The central filter counts each measurement once by construction; its ledger says nothing.
    if (is_ledger(metric) && agent == central_agent) continue;
    const auto m = static_cast<std::size_t>(metric);
    record.series(simulation_.now(), agent, subject_names_[static_cast<std::size_t>(subject)],
                  metric_names_[m], values[m], is_ledger(metric) ? Origin::ledger : Origin::run);
  }
}

Witness::Values Witness::measure(const TrackedBelief& tracked,
                                 const gaussian::Assessment& assessment, int subject,
                                 bool central) const {
  Values values;
  values.fill(kNone);
  const gaussian::Belief& belief = tracked.belief;
  const gaussian::Vector x = truth(subject);
  if (const auto& estimate = assessment.state) {
    const gaussian::Vector error = *estimate - x;
    at(values, Metric::rms_error_m) = error.head(axes_).norm() / std::sqrt(double(axes_));
    at(values, Metric::nees) = gaussian::nees_of_error(belief, error).value_or(kNone);
    at(values, Metric::x_m) = (*estimate)(0);
    at(values, Metric::x_error_m) = error(0);
    if (axes_ > 1) {
      at(values, Metric::y_m) = (*estimate)(1);
      at(values, Metric::y_error_m) = error(1);
    }
    if (options_.motion) measure_velocity(belief, error, values);
  }
  at(values, Metric::claimed_sigma_m) = claimed_sigma(belief, assessment);
  if (wants(Metric::entropy_nats)) {
    at(values, Metric::entropy_nats) = gaussian::entropy_nats(belief).value_or(kNone);
  }
  if (wants(Metric::kl_to_central_nats)) {
    const gaussian::Belief& reference = central_[static_cast<std::size_t>(subject)].belief;
    at(values, Metric::kl_to_central_nats) =
        gaussian::kl_divergence_nats(reference, belief).value_or(kNone);
  }
  if (wants(Metric::hellinger_to_central)) {
    const gaussian::Belief& reference = central_[static_cast<std::size_t>(subject)].belief;
    at(values, Metric::hellinger_to_central) =
        gaussian::hellinger(reference, belief).value_or(kNone);
  }
  const gaussian::Definiteness kind = assessment.definiteness;
  at(values, Metric::not_positive) =
      kind == gaussian::Definiteness::indefinite || kind == gaussian::Definiteness::overflow;
  if (options_.ledger && !central) measure_ledger(tracked, assessment, subject, values);
  return values;
}

void Witness::measure_velocity(const gaussian::Belief& belief, const gaussian::Vector& error,
                               Values& values) const {
  const double root = std::sqrt(double(axes_));
  at(values, Metric::velocity_error_m_per_s) = error.tail(axes_).norm() / root;
  const auto P = gaussian::covariance(belief);
  if (!P) return;
  at(values, Metric::claimed_velocity_sigma_m_per_s) =
      std::sqrt(P->diagonal().tail(axes_).sum()) / root;
}

double Witness::claimed_sigma(const gaussian::Belief& belief,
                              const gaussian::Assessment& assessment) const {
  if (axes_ == dimension_) return assessment.claimed_sigma.value_or(kNone);
  const auto P = gaussian::covariance(belief);
  return P ? position_sigma(*P) : kNone;
}

double Witness::position_sigma(const gaussian::Matrix& P) const {
  double sum = 0.0;
  for (int i = 0; i < axes_; ++i) sum += P(i, i);
  return std::sqrt(sum / axes_);
}

void Witness::measure_ledger(const TrackedBelief& tracked, const gaussian::Assessment& assessment,
                             int subject, Values& values) const {
  const MeasurementBook& book = books_[static_cast<std::size_t>(subject)];
  const gaussian::Belief& belief = tracked.belief;
  const Multiplicity counted = multiplicity(tracked.ledger);
  at(values, Metric::multiplicity_mean) = counted.mean;
  at(values, Metric::multiplicity_max) = counted.max;
  at(values, Metric::multiplicity_share) = counted.share_above_one;
  if (!options_.motion) at(values, Metric::reach_gap) = reach_gap(belief, tracked.ledger, book);
  if (options_.motion && (!tracked.ledger.moves() || book.motion().size() == 0)) return;
  if (!wants(Metric::true_sigma_m) && !wants(Metric::ledger_anees) && !wants(Metric::ledger_nees)) {
    return;
  }
  const auto P = true_covariance(belief.omega, tracked.ledger, book);
  if (!P) return;
  at(values, Metric::true_sigma_m) = position_sigma(*P);
  at(values, Metric::ledger_anees) = belief.omega.cwiseProduct(*P).sum() / dimension_;
  if (!assessment.state) return;
  at(values, Metric::ledger_nees) =
      gaussian::mahalanobis_squared(*assessment.state - truth(subject), *P).value_or(kNone);
}

gaussian::Vector Witness::truth(int subject) const {
  const auto values =
      options_.subjects[static_cast<std::size_t>(subject)].truth_at(stamp_, dimension_);
  gaussian::Vector x(dimension_);
  for (int i = 0; i < dimension_; ++i) x(i) = values[static_cast<std::size_t>(i)];
  return x;
}

double Witness::distance_m(const std::optional<gaussian::Vector>& state, int subject) const {
  return state ? (*state - truth(subject)).head(axes_).norm() : kNone;
}

double Witness::distance_error_m(int subject, const gaussian::Belief& belief) {
  advance();
  return distance_m(gaussian::state(belief), subject);
}

void Witness::finish() {
  if (last_sample_ != simulation_.now()) sample();
  Record& record = simulation_.record();
  record.scalar(central_agent, record.name("state_dimension"), dimension_);
  record.scalar(central_agent, record.name("measurements"), static_cast<double>(measurements_));
  if (agreement_) {
    const Time now = simulation_.now();
    if (now >= agreement_->options().from && agreement_->last_sample() != now) sample_agreement();
    record.scalar(central_agent, record.name("agree_again_s"), agreement_->agree_again_s());
  }
  Watched central{.agent = central_agent, .believer = nullptr};
  central.distances_m.swap(central_distances_m_);
  finish(central);
  for (Watched& watched : watched_) finish(watched);
}

void Witness::finish(Watched& watched) {
  Record& record = simulation_.record();
  const auto scalar = [&](const char* name, double value, Origin origin = Origin::run) {
    record.scalar(watched.agent, record.name(name), value, origin);
  };
  double distance = 0.0, variance = 0.0;
  for (std::size_t s = 0; s < central_.size(); ++s) {
    const int subject = static_cast<int>(s);
    const gaussian::Belief& belief =
        watched.believer ? watched.believer->tracked(subject).belief : central_[s].belief;
    const gaussian::Assessment assessment = gaussian::assess(belief);
    const double sigma = claimed_sigma(belief, assessment);
    distance += distance_m(assessment.state, subject);
    variance += sigma * sigma;
  }
  const auto subjects = static_cast<double>(central_.size());
  scalar("distance_error_m", distance / subjects);
  scalar("final_claimed_sigma_m", std::sqrt(variance / subjects));
  if (options_.motion) scalar("position_error_median_m", median(watched.distances_m));
  if (!watched.believer) return;
  scalar("not_positive_share",
         static_cast<double>(watched.not_positive) / static_cast<double>(watched.samples));
  if (options_.ledger && !options_.motion) {
    scalar("reach_gap_max", watched.reach_gap_max, Origin::ledger);
  }
  const EstimatorCounts& counts = watched.believer->counts();
  scalar("measurements", static_cast<double>(counts.measurements));
  scalar("fusions", static_cast<double>(counts.fusions));
  scalar("fusions_skipped", static_cast<double>(counts.skipped));
  scalar("messages_refused", static_cast<double>(counts.refused));
  if (options_.motion) scalar("news_late", static_cast<double>(counts.late));
  scalar("fusion_gain_max", counts.fusion_gain_max);
}

}  // namespace hearsay
