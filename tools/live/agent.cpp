#include "tools/live/agent.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <optional>
#include <random>

#include "scenarios/solo.hpp"
#include "tools/live/frame_line.hpp"
#include "tools/live/memory_file.hpp"
#include "tools/live/own_time.hpp"

namespace hearsay::fleet {
namespace {

using namespace std::chrono_literals;

/// Says hello until it is answered.
std::optional<live::Welcome> join(live::Port& port, Reactor& reactor, const AgentOptions& options,
                                  bool remembers, std::string& trouble) {
  const std::string partition = live::fleet_partition(options.fleet.fleet);
  live::Writer hellos = port.writer(live::hello_topic(), partition);
  live::Reader welcomes = port.reader(live::welcome_topic(), partition);
  // Nothing of a run depends on this number; it only tells processes apart.
  std::random_device entropy;
  const live::Hello hello{.agent = static_cast<std::uint32_t>(options.id),
                          .process = (std::uint64_t{entropy()} << 32) | entropy() | 1,
                          .scenario = options.scenario_hash,
                          .version = options.version,
                          .remembers = remembers};
  std::vector<std::byte> bytes;
  const WallTime until = WallClock::now() + wall(options.patience_s);
  while (!reactor.stopped()) {
    if (WallClock::now() >= until) {
      trouble = fmt::format("no world of fleet '{}' answered within {:g} s", options.fleet.fleet,
                            options.patience_s);
      return std::nullopt;
    }
    live::encode(hello, bytes);
    if (hellos.matched()) hellos.write(bytes);
    const WallTime again = WallClock::now() + 200ms;
    while (WallClock::now() < again && !reactor.stopped()) {
      reactor.wait(again);
      live::Welcome welcome;
      while (welcomes.take(bytes)) {
        if (!live::decode(bytes, welcome) || welcome.process != hello.process) continue;
        if (welcome.accepted) return welcome;
        trouble = "the world refused it: " + welcome.reason;
        return std::nullopt;
      }
    }
  }
  return std::nullopt;
}

/// @throws InputError for an agent that has nothing to keep. (Of a user's own kinds save() says.)
void require_memory(const PreparedScenario& prepared, const Catalog& catalog, AgentId id) {
  const auto i = static_cast<std::size_t>(id);
  const AgentSpec& spec = *prepared.specs[i];
  const bool own = catalog.agents().contains(spec.kind);
  if (own || (spec.kind == "estimator" && spec.estimator.kind != "trajectory-gaussian")) return;
  throw InputError(prepared.scenario.file, 0,
                   "agent '" + prepared.names[i] +
                       "' keeps no memory (--memory); estimators of kind 'static-gaussian' and "
                       "'moving-gaussian' do");
}

std::string in_lockstep(const std::shared_ptr<const PreparedScenario>& prepared,
                        const Catalog& catalog, const AgentOptions& options,
                        const live::Welcome& welcome, FrameSuperior& superior, Reactor& reactor,
                        remote::MemoryStore* memory) {
  const std::string gone = fmt::format("the world of fleet '{}' is gone", options.fleet.fleet);
  remote::Order first;
  if (!superior.wait(first)) return reactor.stopped() ? "" : gone;
  if (first.kind == remote::OrderKind::dismiss) return {};
  const int subjects = remote_options(*prepared, options.id).subjects;
  for (;;) {
    remote::RemoteWorld world(superior, first,
                              {.ledgers = prepared->scenario.record.ledger == "on",
                               .subjects = subjects,
                               .memory = memory});
    try {
      Solo solo(prepared, catalog, world,
                {.id = options.id,
                 .seed = welcome.seed,
                 .now = first.now,
                 .tap = &world.tap(),
                 .plans = &world.plans()});
      if (world.serve(
              {solo.simulation(), solo.agent(), solo.receiver(), solo.reporter(), solo.riders()})) {
        return {};
      }
    } catch (const remote::WorldGone&) {
      // It asked something before it began, and nobody answered.
      if (world.dismissed()) return {};
    }
    // The world took this process for gone, and has it join again.
    if (!world.next_life()) return reactor.stopped() ? "" : gone;
    first = *world.next_life();
  }
}

}  // namespace

std::string run_agent(const std::shared_ptr<const PreparedScenario>& prepared,
                      const Catalog& catalog, const AgentOptions& options,
                      const std::function<void(const std::string&)>& status) {
  const auto agents = static_cast<AgentId>(prepared->specs.size());
  if (options.id < 0 || options.id >= agents) {
    throw InputError(
        prepared->scenario.file, 0,
        fmt::format("there is no agent {}: the scenario has {}, from 0 on", options.id, agents));
  }
  std::optional<MemoryFile> memory;
  if (!options.memory.empty()) {
    require_memory(*prepared, catalog, options.id);
    memory.emplace(options.memory,
                   fmt::format("agent {} of scenario {}", options.id, options.scenario_hash));
  }
  live::Port port({.fleet = options.fleet.fleet,
                   .interface = options.fleet.interface,
                   .domain = options.fleet.domain});
  Reactor reactor(port);
  status("looks for its world");
  std::string trouble;
  const std::optional<live::Welcome> welcome =
      join(port, reactor, options, memory && memory->remembers(), trouble);
  if (!welcome) return trouble;
  const std::string partition =
      live::agent_partition(options.fleet.fleet, static_cast<std::uint32_t>(options.id));
  live::Reader orders = port.reader(live::order_topic(), partition);
  live::Writer answers = port.writer(live::answer_topic(), partition);
  const WallTime until = WallClock::now() + wall(options.patience_s);
  while (!(answers.matched() && orders.writers_alive() > 0)) {
    if (reactor.stopped()) return {};
    if (WallClock::now() >= until) return "the world does not listen";
    reactor.wait(WallClock::now() + 20ms);
  }
  status("waits for the others");
  WallTime next_status;
  FrameSuperior superior(orders, answers, reactor, options.id, [&](const remote::Order& order) {
    if (WallClock::now() < next_status) return;
    next_status = WallClock::now() + 500ms;
    status(fmt::format("{:.1f} s", order.now.seconds()));
  });
  if (welcome->lockstep) {
    return in_lockstep(prepared, catalog, options, *welcome, superior, reactor,
                       memory ? &*memory : nullptr);
  }
  OwnTime own_time(prepared, options, *welcome, port, reactor, orders, answers,
                   memory ? &*memory : nullptr);
  return own_time.serve(catalog, status);
}

}  // namespace hearsay::fleet
