#include "tools/live/world.hpp"

#include <exception>

#include "sim/record/digest.hpp"
#include "tools/live/lockstep_world.hpp"
#include "tools/live/real_time_world.hpp"

namespace hearsay::fleet {
namespace {

void tell_clock(live::Writer& clock, const live::Clock& state) {
  std::vector<std::byte> bytes;
  live::encode(state, bytes);
  clock.write(bytes);
}

/// Builds the run, drives it and closes its record.
template <class World>
void live_through(World& world, const std::shared_ptr<const PreparedScenario>& prepared,
                  const Catalog& catalog, const WorldOptions& options, Reactor& reactor,
                  const std::function<void(const std::string&)>& status, WorldResult& result) {
  Xxh3Digest digest, ledger_digest;
  Run::Options how{.seed = options.seed, .digest = &digest, .ledger_digest = &ledger_digest};
  how.elsewhere = [&world](Context& context, const remote::Belongings& belongings) {
    return world.stand_in(context, belongings);
  };
  result.run = std::make_unique<Run>(prepared, catalog, how);
  result.end = result.run->finish(world.drive(*result.run, status));
  if (reactor.stopped()) result.trouble = "it was asked to stop";
  world.dismiss();
  const bool ledger = prepared->scenario.record.ledger == "on";
  result.digest = digest_text(digest, ledger ? &ledger_digest : nullptr);
  result.run->keep_record_only();
}

}  // namespace

WorldResult run_world(const std::shared_ptr<const PreparedScenario>& prepared,
                      const Catalog& catalog, const WorldOptions& options,
                      const std::function<void(const std::string&)>& status) {
  const WallTime begin = WallClock::now();
  live::Port port({.fleet = options.fleet.fleet,
                   .interface = options.fleet.interface,
                   .domain = options.fleet.domain});
  Reactor reactor(port);
  Roster roster(port, reactor, options, static_cast<int>(prepared->specs.size()));
  live::Writer clock = port.writer(live::clock_topic(), live::fleet_partition(options.fleet.fleet));
  live::Clock state{.end_ns = prepared->end.nanoseconds(), .speed = options.speed};
  tell_clock(clock, state);
  WorldResult result;
  status("waits for its agents");
  result.trouble = roster.gather();
  if (result.trouble.empty() && reactor.stopped()) result.trouble = "it was asked to stop";
  if (!result.trouble.empty()) {
    // Whoever has come need not wait for ever.
    LockstepWorld(*prepared, roster, reactor).dismiss();
  } else if (options.lockstep) {
    LockstepWorld world(*prepared, roster, reactor);
    live_through(world, prepared, catalog, options, reactor, status, result);
  } else {
    RealTimeWorld world(*prepared, port, roster, reactor, clock, options);
    live_through(world, prepared, catalog, options, reactor, status, result);
    result.late = world.late();
    result.silent = world.silent();
    result.dropped = world.dropped();
  }
  state.state = live::Clock::State::ended;
  state.now_ns = result.end.at.nanoseconds();
  state.reason = result.trouble;
  tell_clock(clock, state);
  result.wall_s = std::chrono::duration<double>(WallClock::now() - begin).count();
  return result;
}

}  // namespace hearsay::fleet
