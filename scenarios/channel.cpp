#include "scenarios/channel.hpp"

#include <utility>

namespace hearsay {
namespace {

Time at(double s) { return Time::at(Duration::seconds(s)); }
Time at_or_never(const std::optional<double>& s) { return s ? at(*s) : Time::never(); }

// The agents that a dropout befalls.
std::vector<AgentId> agents_of(const DropoutSpec& spec, int agents) {
  std::vector<AgentId> all;
  for (const AgentRef& agent : spec.agents) all.push_back(agent.number);
  for (AgentId a = 0; spec.agents.empty() && a < agents; ++a) all.push_back(a);
  return all;
}

}  // namespace

BurstLoss burst_loss_of(const LossSpec& spec) {
  return {.loss_rate = spec.probability,
          .mean_burst = spec.mean_burst.value(),
          .loss_good = spec.loss_good,
          .loss_bad = spec.loss_bad};
}

GilbertElliott chain_of(const LossSpec& spec) {
  if (spec.mean_burst) return chain_of(burst_loss_of(spec));
  return {.good_to_bad = spec.good_to_bad.value(),
          .bad_to_good = spec.bad_to_good.value(),
          .loss_good = spec.loss_good,
          .loss_bad = spec.loss_bad};
}

Loss loss_of(const LossSpec& spec) {
  if (spec.model == "gilbert-elliott") return Loss::gilbert_elliott(chain_of(spec));
  if (spec.model != "bernoulli") return {};
  std::vector<LinkLoss> links;
  for (const LinkLossSpec& link : spec.links) {
    links.push_back({link.from.value().number, link.to.value().number, link.probability.value()});
  }
  return Loss::bernoulli(spec.probability, std::move(links));
}

GreyZone grey_zone_of(const PropagationSpec& spec) {
  return {.inner_m = spec.inner_m, .outer_m = spec.outer_m};
}

LogDistance log_distance_of(const PropagationSpec& spec) {
  return {.exponent = spec.exponent,
          .reference_loss_db = spec.reference_loss_db,
          .reference_m = spec.reference_m,
          .shadowing_sigma_db = spec.shadowing_sigma_db,
          .transmit_dbm = spec.transmit_dbm,
          .noise_dbm = spec.noise_dbm,
          .range_m = spec.range_m};
}

Propagation propagation_of(const RadioSpec& spec) {
  if (spec.topology == "disk") return Propagation::disk(spec.range_m);
  if (spec.topology != "by-position") return {};
  const PropagationSpec& model = spec.propagation.value();
  if (model.model == "disk") return Propagation::disk(model.range_m.value());
  if (model.model == "grey-zone") return Propagation::grey_zone(grey_zone_of(model));
  return Propagation::log_distance(log_distance_of(model));
}

Jammer jammer_of(const JammerSpec& spec) {
  Jammer jammer{.radius_m = spec.radius_m,
                .power_dbm = spec.power_dbm,
                .from = at(spec.from_s),
                .until = at_or_never(spec.until_s),
                .period = Duration::seconds(spec.period_s.value_or(0.0)),
                .duty = spec.duty.value_or(1.0)};
  jammer.position_m = {spec.position_m.at(0), spec.position_m.at(1), 0.0};
  return jammer;
}

Jammers jammers_of(const RadioSpec& spec) {
  std::vector<Jammer> jammers;
  for (const JammerSpec& jammer : spec.jammers) jammers.push_back(jammer_of(jammer));
  return Jammers(std::move(jammers));
}

Dropouts dropouts_of(const Scenario& scenario, std::uint64_t seed, Time end) {
  Dropouts::Options options{.seed = seed, .end = end};
  for (const DropoutSpec& spec : scenario.dropouts) {
    const bool forgets = spec.kind == "reboot" && !spec.memory.value_or(false);
    for (const AgentId agent : agents_of(spec, scenario.agent_count())) {
      if (spec.from_s) {
        options.schedule.push_back({agent, at(*spec.from_s), at_or_never(spec.until_s), forgets});
        continue;
      }
      OutageRate rate{.agent = agent,
                      .mean_up_s = spec.mean_up_s.value(),
                      .mean_down_s = spec.mean_down_s,
                      .forgets = forgets};
      if (spec.outages_max) rate.outages_max = static_cast<std::uint64_t>(*spec.outages_max);
      options.rates.push_back(rate);
    }
  }
  return Dropouts(std::move(options));
}

}  // namespace hearsay
