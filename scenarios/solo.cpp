#include "scenarios/solo.hpp"

#include <utility>

#include "agents/estimator_agent.hpp"
#include "agents/explorer_agent.hpp"
#include "agents/forager_agent.hpp"
#include "agents/localizer_agent.hpp"
#include "agents/remote/remote_body.hpp"
#include "agents/remote/remote_eyes.hpp"
#include "agents/source_agent.hpp"
#include "agents/tracker_agent.hpp"
#include "scenarios/estimators.hpp"
#include "scenarios/explorers.hpp"
#include "scenarios/foragers.hpp"
#include "scenarios/links.hpp"
#include "scenarios/localizers.hpp"
#include "scenarios/motion.hpp"
#include "scenarios/trackers.hpp"
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
           remote::DistantWorld& world, const Options& options)
    : prepared_(std::move(prepared)),
      simulation_({.seed = options.seed, .end = prepared_->end, .record = {.tap = options.tap}}) {
  simulation_.set_watch(options.plans);
  simulation_.advance(options.now);
  const auto i = static_cast<std::size_t>(options.id);
  const AgentSpec& spec = *prepared_->specs[i];
  simulation_.name_of_agent = [this, i](AgentId) { return prepared_->names[i]; };
  context_ = std::make_unique<Context>(
      simulation_, world,
      Context::Identity{.id = options.id,
                        .name = prepared_->names[i],
                        .kind = spec.kind,
                        .parameters = spec.parameters},
      Context::Service{.steers = is_steered(*prepared_, options.id) ? &world : nullptr});
  agent_ = make_agent(catalog, world, options);
}

std::unique_ptr<Agent> Solo::make_agent(const Catalog& catalog, remote::DistantWorld& world,
                                        const Options& options) {
  const AgentSpec& spec = *prepared_->specs[static_cast<std::size_t>(options.id)];
  const auto own = catalog.agents().find(spec.kind);
  if (own != catalog.agents().end()) return own->second.make(*context_);
  if (spec.kind == "estimator") return make_estimator(world, options);
  if (spec.kind == "tracker") return make_tracker(world, options);
  if (spec.kind == "localizer") return make_localizer(world, options);
  if (spec.kind == "explorer") return make_explorer(world, options);
  if (spec.kind == "forager") return make_forager(world, options);
  require(spec.kind == "source", "an agent that cannot live by itself");
  std::optional<SourceTraffic> traffic;
  if (spec.traffic) traffic = traffic_of(*spec.traffic, options.id, options.seed);
  return std::make_unique<SourceAgent>(*context_, traffic);
}

std::unique_ptr<Agent> Solo::make_estimator(remote::DistantWorld& world, const Options& options) {
  auto estimator = std::make_unique<EstimatorAgent>(
      *context_, world, estimator_options(*prepared_, options.id, options.seed));
  receiver_ = estimator.get();
  if (world.ledgers()) riders_ = std::make_unique<remote::LedgerRiders>(*world.ledgers());
  return estimator;
}

std::unique_ptr<Agent> Solo::make_tracker(remote::DistantWorld& world, const Options& options) {
  const AgentSpec& spec = *prepared_->specs[static_cast<std::size_t>(options.id)];
  if (scan_sensor_of(spec)) plots_ = std::make_unique<remote::RemotePlots>(world);
  auto tracker = std::make_unique<TrackerAgent>(
      *context_, tracker_options(*prepared_, options.id, options.seed, plots_.get()));
  reporter_ = std::make_unique<remote::TrackReporter>(*tracker);
  return tracker;
}

std::unique_ptr<Agent> Solo::make_localizer(remote::DistantWorld& world, const Options& options) {
  sightings_ = std::make_unique<remote::RemoteSightings>(world);
  auto localizer = std::make_unique<LocalizerAgent>(
      *context_, *sightings_, localizer_options(*prepared_, options.id, options.seed));
  reporter_ = std::make_unique<remote::PoseReporter>(*localizer);
  return localizer;
}

std::unique_ptr<Agent> Solo::make_explorer(remote::DistantWorld& world, const Options& options) {
  const AgentSpec& spec = *prepared_->specs[static_cast<std::size_t>(options.id)];
  if (grid_sensor_of(spec, prepared_->scenario.world)) {
    looks_ = std::make_unique<remote::RemoteLooks>(world);
  }
  const bool ledger = prepared_->scenario.record.ledger == "on";
  auto explorer = std::make_unique<ExplorerAgent>(
      *context_, ledger ? &grid_riders_ : nullptr,
      explorer_options(*prepared_, options.id, options.seed, looks_.get()));
  if (ledger) {
    riders_ =
        std::make_unique<remote::GridRiders>(grid_riders_, explorer->estimator().belief().shape());
  }
  reporter_ = std::make_unique<remote::GridReporter>(explorer->estimator());
  return explorer;
}

std::unique_ptr<Agent> Solo::make_forager(remote::DistantWorld& world, const Options& options) {
  body_ = std::make_unique<remote::RemoteBody>(world);
  account_ = std::make_unique<remote::RemoteAccount>(world);
  auto forager = std::make_unique<ForagerAgent>(
      *context_, *body_, *account_, forager_options(*prepared_, options.id, options.seed));
  reporter_ = std::make_unique<remote::TrailReporter>(*forager);
  return forager;
}

}  // namespace hearsay
