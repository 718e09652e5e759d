#include "agents/lookout.hpp"

#include <cmath>
#include <utility>

namespace hearsay {
namespace {

void record_looks(Context& context, const LookSums& sums) {
  Record& record = context.simulation().record();
  const auto scalar = [&](const char* name, double value) {
    record.scalar(context.id(), record.name(name), value);
  };
  const double hits = sums.looks - sums.missed, compared = sums.compared;
  scalar("looks_missed", sums.missed);
  scalar("look_sigma_along_m", std::sqrt(sums.variance_along_m2 / hits));
  scalar("look_sigma_across_m", std::sqrt(sums.variance_across_m2 / hits));
  scalar("look_kl_nats", sums.kl_nats / compared);
  scalar("look_variance_gap", sums.log_variance_ratio / compared);
}

}  // namespace

Lookout::Lookout(Context& context, Witness& witness, MeasurementReceiver& receiver, Options options)
    : context_(context), witness_(witness), receiver_(receiver), options_(std::move(options)) {}

void Lookout::start() {
  if (!options_.sensors.empty()) {
    looking_ = look();
    looking_.start(context_.simulation(), context_.id());
  }
  if (!options_.observations.empty()) {
    replaying_ = replay();
    replaying_.start(context_.simulation(), context_.id());
  }
}

void Lookout::finish() {
  LookSums sums;
  bool any = false;
  for (const Sensor& sensor : options_.sensors) {
    const CameraSensor* const camera = std::get_if<CameraSensor>(&sensor);
    if (!camera) continue;
    sums += camera->sums();
    any = true;
  }
  if (any) record_looks(context_, sums);
}

Process Lookout::look() {
  Time next = options_.start;
  for (std::uint64_t count = 0; next <= options_.end; ++count) {
    co_await context_.sleep_until(next, Phase::measure);
    for (std::size_t s = 0; s < options_.sensors.size() && context_.up(); ++s) {
      const auto subject = static_cast<int>(s);
      const auto information = look_at(subject, count);
      if (information) measured(subject, *information);
    }
    next = next + options_.period;
  }
}

std::optional<gaussian::Belief> Lookout::look_at(int subject, std::uint64_t count) {
  const auto stream = [&](const char* purpose) {
    return context_.simulation().stream_at(
        Purpose(purpose), Entity::sensor(context_.id(), static_cast<std::uint32_t>(subject)),
        count);
  };
  Sensor& sensor = options_.sensors[static_cast<std::size_t>(subject)];
  aim(sensor, subject);
  if (options_.range_max_m && distance_m(sensor) > *options_.range_max_m) return std::nullopt;
  Stream draws = stream("sensor noise");
  const auto information = measure(sensor, draws);
  CameraSensor* const camera = std::get_if<CameraSensor>(&sensor);
  if (camera && camera->compares()) {
    Stream reference = stream("sensor reference");
    camera->compare(reference);
  }
  return information;
}

void Lookout::aim(Sensor& sensor, int subject) {
  if (options_.moves && (has_direction(sensor) || options_.range_max_m)) {
    const Point place_m = context_.position();
    move_to(sensor, {place_m[0], place_m[1]});
  }
  if (!options_.motion) return;
  const auto truth = options_.targets[static_cast<std::size_t>(subject)].truth_at(
      options_.motion->stamp_at(context_.now()), options_.dimension);
  look_towards(sensor, {truth[0], truth[1]});
}

Process Lookout::replay() {
  for (const Observation& observation : options_.observations) {
    if (observation.time > context_.now()) {
      co_await context_.sleep_until(observation.time, Phase::measure);
    }
    if (!context_.up()) continue;
    measured(observation.subject, observation.information);
  }
}

void Lookout::measured(int subject, const gaussian::Belief& information) {
  const gaussian::Belief whole = gaussian::lifted(information, options_.dimension);
  const std::size_t index = witness_.measured(subject, whole);
  receiver_.on_measurement({.subject = subject, .information = information, .index = index});
}

}  // namespace hearsay
