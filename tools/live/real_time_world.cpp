#include "tools/live/real_time_world.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "scenarios/estimators.hpp"
#include "scenarios/solo.hpp"

namespace hearsay::fleet {
namespace {

using namespace std::chrono_literals;

constexpr auto heartbeat = 100ms;  ///< of the clock, and of looking who is there

}  // namespace

RealTimeWorld::RealTimeWorld(const PreparedScenario& prepared, live::Port& port, Roster& roster,
                             Reactor& reactor, live::Writer& clock, const WorldOptions& options)
    : prepared_(prepared),
      port_(port),
      roster_(roster),
      reactor_(reactor),
      clock_(clock),
      truth_(port.writer(live::truth_topic(), live::fleet_partition(port.fleet()))),
      options_(options) {
  agents_.resize(static_cast<std::size_t>(roster.size()), nullptr);
}

std::unique_ptr<remote::StandIn> RealTimeWorld::stand_in(Context& context,
                                                         const remote::Belongings& world) {
  const AgentId id = context.id();
  auto agent =
      std::make_unique<RealTimeAgent>(context, port_, roster_.member(id), reactor_,
                                      RealTimeAgent::Options{.what = remote_options(prepared_, id),
                                                             .desk = world.desk,
                                                             .tongues = tongues_of(prepared_)});
  agents_[static_cast<std::size_t>(id)] = agent.get();
  return agent;
}

Time RealTimeWorld::now() const {
  const double elapsed_s = std::chrono::duration<double>(WallClock::now() - begin_).count();
  return std::min(prepared_.end, Time::at(Duration::seconds(elapsed_s * options_.speed)));
}

RunEnd RealTimeWorld::drive(Run& run, const std::function<void(const std::string&)>& status) {
  Simulation& simulation = run.simulation();
  begin_ = WallClock::now();
  tell_clock(simulation);
  run.start();
  WallTime next_beat = begin_, next_status = begin_;
  while (!simulation.failed() && !reactor_.stopped()) {
    const Time at = now();
    catch_up(simulation, at);
    if (simulation.failed()) break;
    if (at == prepared_.end) {
      simulation.advance(at);
      break;
    }
    take(run);
    if (WallClock::now() >= next_beat) {
      next_beat = WallClock::now() + heartbeat;
      look_after(run);
      tell_clock(simulation);
      tell_truth(run);
    }
    if (WallClock::now() >= next_status) {
      next_status = WallClock::now() + 500ms;
      status(fmt::format("{:.1f} s of {:g} s, {} deadlines missed", simulation.now().seconds(),
                         prepared_.end.seconds(), late_));
    }
    const Time next = std::min(simulation.next_time(), prepared_.end);
    reactor_.wait(std::min(next_beat, begin_ + wall(next.seconds() / options_.speed)));
  }
  return simulation.end_now(EndReason::time_reached);
}

void RealTimeWorld::catch_up(Simulation& simulation, Time until) {
  while (!simulation.failed() && !reactor_.stopped() && simulation.next_time() <= until) {
    const WallTime due = begin_ + wall(simulation.next_time().seconds() / options_.speed);
    if (WallClock::now() > due + wall(deadline_s)) ++late_;
    simulation.happen();
  }
}

// What came, comes at this instant, as an event.
void RealTimeWorld::take(Run& run) {
  Simulation& simulation = run.simulation();
  const Time at = std::max(simulation.now(), std::min(now(), simulation.next_time()));
  simulation.advance(at);
  simulation.schedule(at, Phase::update, [this, &simulation] {
    for (RealTimeAgent* agent : agents_) {
      simulation.acting_for(agent->id());
      agent->take();
    }
  });
  simulation.happen();
}

void RealTimeWorld::look_after(Run& run) {
  Simulation& simulation = run.simulation();
  const std::vector<AgentId> arrived = roster_.update(simulation.now().nanoseconds());
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    const auto id = static_cast<AgentId>(i);
    RealTimeAgent& agent = *agents_[i];
    const bool new_here = std::find(arrived.begin(), arrived.end(), id) != arrived.end();
    const bool gone = agent.gone();
    if (!agent.silent() && (new_here || gone)) {
      agent.fall_silent();
      run.set_reachable(id, false);
    }
    if (new_here) {
      roster_.member(id).here = true;
      simulation.record().event(
          simulation.now(), id, "joined again",
          roster_.member(id).remembers ? "with its memory" : "without memory");
      run.set_reachable(id, true);
      agent.start();
    }
    agent.tell_neighbours();
  }
}

void RealTimeWorld::tell_clock(const Simulation& simulation) {
  live::encode(live::Clock{.now_ns = simulation.now().nanoseconds(),
                           .end_ns = prepared_.end.nanoseconds(),
                           .speed = options_.speed,
                           .state = live::Clock::State::running},
               bytes_);
  clock_.write(bytes_);
}

void RealTimeWorld::tell_truth(Run& run) {
  if (!truth_.matched()) return;
  const std::int64_t now_ns = run.simulation().now().nanoseconds();
  for (std::size_t s = 0; s < run.subjects().size(); ++s) {
    const int n = dimension_of(prepared_);
    const std::int64_t stamp =
        prepared_.motion ? prepared_.motion->stamp_at(run.simulation().now()) : 0;
    const auto state = run.subjects()[s].truth_at(stamp, n);
    live::encode(live::Truth{.now_ns = now_ns,
                             .subject = static_cast<std::uint32_t>(s),
                             .state = {state.begin(), state.end()}},
                 bytes_);
    truth_.write(bytes_);
  }
}

void RealTimeWorld::dismiss() {
  for (RealTimeAgent* agent : agents_) {
    agent->dismiss();
    late_ += agent->missed();
    late_reports_ += agent->late_reports();
    dropped_ += agent->dropped();
  }
}

}  // namespace hearsay::fleet
