// Of a run: what stands in for agents that live in other processes.
#include <utility>

#include "agents/remote/remote_body.hpp"
#include "agents/remote/remote_eyes.hpp"
#include "scenarios/estimators.hpp"
#include "scenarios/explorers.hpp"
#include "scenarios/run.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {

std::unique_ptr<Agent> Run::make_stand_in(AgentId id) {
  const std::string& kind = prepared_->specs[static_cast<std::size_t>(id)]->kind;
  if (kind == "estimator") return make_estimator_elsewhere(id);
  if (kind == "tracker") return make_tracker_elsewhere(id);
  if (kind == "localizer") return make_localizer_elsewhere(id);
  if (kind == "explorer") return make_explorer_elsewhere(id);
  if (kind == "forager") return make_forager_elsewhere(id);
  return elsewhere_(*contexts_[static_cast<std::size_t>(id)], {});
}

std::unique_ptr<Agent> Run::make_estimator_elsewhere(AgentId id) {
  const auto i = static_cast<std::size_t>(id);
  Context& context = *contexts_[i];
  std::unique_ptr<remote::RiderCodec>& riders = equipment_[i].riders;
  if (witness_->ledgers()) riders = std::make_unique<remote::LedgerRiders>(*witness_->ledgers());
  auto agent = elsewhere_(context, {.witness = witness_.get(), .riders = riders.get()});
  witness_->watch(id, agent->believer());
  lookouts_[i] = make_lookout(*prepared_, id, context, *witness_, *agent, subjects_);
  return agent;
}

std::unique_ptr<Agent> Run::at_desk(AgentId id, std::unique_ptr<remote::Desk> desk) {
  const auto i = static_cast<std::size_t>(id);
  auto agent =
      elsewhere_(*contexts_[i], {.desk = desk.get(), .riders = equipment_[i].riders.get()});
  desk->attach(*agent);
  equipment_[i].desk = std::move(desk);
  return agent;
}

std::unique_ptr<Agent> Run::make_tracker_elsewhere(AgentId id) {
  const auto tracks_max =
      static_cast<std::size_t>(prepared_->specs[static_cast<std::size_t>(id)]->tracker.tracks_max);
  auto desk = std::make_unique<remote::TrackDesk>(equip_with_scan(id), tracks_max);
  track_witness_->watch(id, *desk);
  return at_desk(id, std::move(desk));
}

std::unique_ptr<Agent> Run::make_localizer_elsewhere(AgentId id) {
  const auto robots = static_cast<AgentId>(prepared_->journeys.size());
  auto desk = std::make_unique<remote::PoseDesk>(*pose_witness_, id, robots);
  pose_witness_->watch(id, *desk);
  return at_desk(id, std::move(desk));
}

std::unique_ptr<Agent> Run::make_explorer_elsewhere(AgentId id) {
  const ExplorerAgent::Options options =
      explorer_options(*prepared_, id, simulation_.seed(), equip_with_looks(id));
  auto desk =
      std::make_unique<remote::GridDesk>(options.looks, options.area, options.estimator.belief);
  if (grid_witness_->riders()) {
    equipment_[static_cast<std::size_t>(id)].riders =
        std::make_unique<remote::GridRiders>(*grid_witness_->riders(), desk->belief().shape());
  }
  grid_witness_->watch(id, *desk);
  return at_desk(id, std::move(desk));
}

std::unique_ptr<Agent> Run::make_forager_elsewhere(AgentId id) {
  const auto i = static_cast<std::size_t>(id);
  const auto rays = static_cast<std::size_t>(prepared_->specs[i]->robot->rays);
  auto desk =
      std::make_unique<remote::RobotDesk>(equip_with_body(id), *trail_witness_, robots_[i], rays);
  trail_witness_->watch(id, robots_[i], *desk);
  return at_desk(id, std::move(desk));
}

}  // namespace hearsay
