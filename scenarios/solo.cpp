#include "scenarios/solo.hpp"

#include <utility>

#include "agents/estimator_agent.hpp"
#include "agents/source_agent.hpp"
#include "scenarios/estimators.hpp"
#include "scenarios/links.hpp"
#include "scenarios/motion.hpp"
#include "scenarios/traffic.hpp"

namespace hearsay {

remote::RemoteAgent::Options remote_options(const PreparedScenario& prepared, AgentId id) {
  const auto i = static_cast<std::size_t>(id);
  const bool estimates = prepared.specs[i]->kind == "estimator";
  return {.knows_place = has_motion(prepared.scenario) || !positions_of(prepared.places).empty(),
          .subjects = estimates ? static_cast<int>(prepared.subjects.size()) : 0,
          .dimension = estimates ? dimension_of(prepared) : 0,
          .moving = prepared.motion.has_value()};
}

Solo::Solo(std::shared_ptr<const PreparedScenario> prepared, const Catalog& catalog,
           RadioPort& radio, EstimatorWitness& witness, const Options& options)
    : prepared_(std::move(prepared)),
      simulation_({.seed = options.seed, .end = prepared_->end, .record = {.tap = options.tap}}) {
  simulation_.set_watch(options.plans);
  simulation_.advance(options.now);
  const auto i = static_cast<std::size_t>(options.id);
  const AgentSpec& spec = *prepared_->specs[i];
  simulation_.name_of_agent = [this, i](AgentId) { return prepared_->names[i]; };
  context_ = std::make_unique<Context>(simulation_, radio,
                                       Context::Identity{.id = options.id,
                                                         .name = prepared_->names[i],
                                                         .kind = spec.kind,
                                                         .parameters = spec.parameters});
  const auto own = catalog.agents().find(spec.kind);
  if (own != catalog.agents().end()) {
    agent_ = own->second.make(*context_);
  } else if (spec.kind == "estimator") {
    auto estimator = std::make_unique<EstimatorAgent>(
        *context_, witness, estimator_options(*prepared_, options.id, options.seed));
    receiver_ = estimator.get();
    agent_ = std::move(estimator);
  } else {
    require(spec.kind == "source", "an agent that cannot live by itself");
    std::optional<SourceTraffic> traffic;
    if (spec.traffic) traffic = traffic_of(*spec.traffic, options.id, options.seed);
    agent_ = std::make_unique<SourceAgent>(*context_, traffic);
  }
}

}  // namespace hearsay
