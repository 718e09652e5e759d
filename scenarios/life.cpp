#include "scenarios/life.hpp"

#include <utility>

namespace hearsay {

Life::Life(Simulation& simulation, Radio& radio, std::vector<std::unique_ptr<Agent>>& agents,
           std::vector<std::unique_ptr<Gossip>>& gossips, Dropouts dropouts)
    : simulation_(simulation),
      radio_(radio),
      agents_(agents),
      gossips_(gossips),
      dropouts_(std::move(dropouts)) {
  rows_.resize(dropouts_.agents().size());
}

Life::~Life() {
  for (const Row& row : rows_) simulation_.cancel(row.event);
}

void Life::start() {
  for (std::size_t row = 0; row < rows_.size(); ++row) await(row);
}

void Life::await(std::size_t row) {
  rows_[row].event = EventId();
  const auto outage = dropouts_.next(dropouts_.agents()[row]);
  if (!outage) return;
  rows_[row].outage = *outage;
  rows_[row].event =
      simulation_.schedule(outage->from, Phase::world, [this, row] { go_down(row); });
}

void Life::go_down(std::size_t row) {
  const Outage& outage = rows_[row].outage;
  simulation_.acting_for(outage.agent);
  simulation_.record().event(simulation_.now(), outage.agent, "down", "");
  radio_.set_up(outage.agent, false);
  agents_[static_cast<std::size_t>(outage.agent)]->on_down();
  rows_[row].event = EventId();
  if (outage.until == Time::never()) return;
  rows_[row].event =
      simulation_.schedule(outage.until, Phase::world, [this, row] { come_up(row); });
}

void Life::come_up(std::size_t row) {
  const Outage& outage = rows_[row].outage;
  simulation_.acting_for(outage.agent);
  simulation_.record().event(simulation_.now(), outage.agent, "up",
                             outage.forgets ? "without memory" : "");
  radio_.set_up(outage.agent, true);
  Gossip* const gossip = gossips_[static_cast<std::size_t>(outage.agent)].get();
  if (gossip && outage.forgets) gossip->forget();
  agents_[static_cast<std::size_t>(outage.agent)]->on_up(outage.forgets);
  await(row);
}

}  // namespace hearsay
