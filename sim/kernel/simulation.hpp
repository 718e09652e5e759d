// One run: the clock, the pending events, the named random streams and the record.
//
// No globals: any number of simulations live in one process, each used by one thread at a time.
//
//   Simulation simulation({.seed = 1, .end = Time::at(60_s)});
//   simulation.schedule(Time::at(1_s), Phase::act, [&] { ... });
//   const RunEnd end = simulation.run();
//
// Who owns processes or awaits something destroys it before the simulation; only what is done may
// outlive it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/kernel/event_queue.hpp"
#include "sim/kernel/ids.hpp"
#include "sim/kernel/random.hpp"
#include "sim/kernel/record.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

enum class EndReason : std::uint8_t {
  time_reached,  ///< all events up to and including the end time have happened
  nothing_left,  ///< the queue ran empty before
  agent_failed,  ///< an exception left an agent's code, or an invariant broke
  event_budget,  ///< more events than allowed
};
/// "time reached", "nothing left", "agent failed", "event budget".
const char* to_string(EndReason reason);

/// Why and when a run ended.
struct RunEnd {
  EndReason reason = EndReason::nothing_left;
  Time at;                   ///< clock at the end
  std::uint64_t events = 0;  ///< events that happened
  AgentId agent = no_agent;  ///< who failed
  /// Of a failure: "agent 'uav2' failed at 12.500000000 s: <what>". An agent without a name is
  /// "agent 3" or "the central estimator", nobody "the run".
  std::string message;
  bool ok() const { return reason == EndReason::time_reached || reason == EndReason::nothing_left; }
};

/// Is told of every event that is scheduled or taken back: for who keeps the same queue elsewhere.
class ScheduleWatch {
 public:
  virtual ~ScheduleWatch() = default;
  virtual void scheduled(EventId id, Time time, Phase phase) = 0;
  virtual void cancelled(EventId id) = 0;
};

class Simulation {
 public:
  struct Options {
    std::uint64_t seed = 1;
    Time end = Time::never();                    ///< events at this instant still happen
    std::uint64_t events_max = 100'000'000'000;  ///< budget; the run ends when it is spent
    Record::Options record;
  };
  explicit Simulation(const Options& options);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  Time now() const { return now_; }
  /// The instant `span` from now: now() for a negative span, Time::never() beyond the last instant.
  Time after(Duration span) const;
  Time end() const { return options_.end; }
  std::uint64_t seed() const { return options_.seed; }

  /// Schedules `callback` at `time`. An exception that leaves it ends the run in the name of the
  /// agent it acts for. At Time::never() it stays pending and does not happen.
  /// @throws BrokenInvariant if `time` is before now(), or is now() while samples are taken
  /// (Phase::observe), which must be the last thing of an instant.
  template <class Function>
  EventId schedule(Time time, Phase phase, Function&& callback) {
    require(time >= now_, "an event was scheduled in the past");
    require(!observing_ || time > now_, "a callback that takes samples scheduled an event at once");
    quiet_until_ = std::min(quiet_until_, time);
    const EventId id = queue_.push(time, phase, std::forward<Function>(callback));
    if (watch_) watch_->scheduled(id, time, phase);
    return id;
  }
  bool cancel(EventId id) {
    const bool was_pending = queue_.cancel(id);
    if (was_pending && watch_) watch_->cancelled(id);
    return was_pending;
  }
  /// From now on; nullptr: nobody. It outlives the simulation.
  void set_watch(ScheduleWatch* watch) { watch_ = watch; }

  /// For an event with several instants, such as a packet on its way from hearer to hearer. The
  /// event that is happening goes on at `time` without a way through the queue, if nothing else is
  /// due before or at that instant and the run may still have an event there: then the clock stands
  /// at `time`, one more event has begun, and nobody acts. Else nothing changes, and the rest of
  /// the event is to be scheduled. Both ways give the same run.
  /// @return whether the clock stands at `time`.
  /// @throws BrokenInvariant if no event is happening, or `time` is before now().
  bool go_on(Time time, Phase phase) {
    require(happening_, "what is not happening cannot go on");
    require(time >= now_, "an event was to go on in the past");
    if (time >= quiet_until_ && !quiet_at(time)) return false;
    if (end_.events == options_.events_max) return false;
    // Behind samples no more may happen at their instant: schedule() will say so.
    if (observing_ && time == now_) return false;
    begin_event(time, phase);
    return true;
  }

  /// From now on failures are charged to `agent`. Callbacks that act for an agent set it first;
  /// it is reset to no_agent before each event.
  void acting_for(AgentId agent) { acting_ = agent; }

  Stream stream(Purpose purpose, Entity entity) const {
    return Stream(options_.seed, purpose, entity);
  }
  Stream stream_at(Purpose purpose, Entity entity, std::uint64_t count) const {
    return Stream::at(options_.seed, purpose, entity, count);
  }

  Record& record() { return record_; }
  const Record& record() const { return record_; }

  /// Name of an agent for failure messages; set by whoever builds the run.
  std::function<std::string(AgentId)> name_of_agent;

  /// Ends the run after the current event with this failure (the first one counts). `error` is not
  /// null.
  void fail(AgentId agent, std::exception_ptr error);

  /// Lets everything happen up to the end. Callable once (else BrokenInvariant). On time_reached
  /// the clock stands at end(), otherwise at the last event.
  RunEnd run();

  // In place of run(), for who drives the run step by step: by another clock, or by orders from
  // elsewhere.

  /// When the next event is due; Time::never() if none is pending.
  Time next_time() { return queue_.empty() ? Time::never() : queue_.next_time(); }
  /// Moves the clock on to `time`. @throws BrokenInvariant if that is before now(), or beyond the
  /// next event or the end of the run.
  void advance(Time time);
  /// The next event happens, whatever the budget. One must be pending, not beyond the end. A
  /// failure ends the run as in run().
  void happen();
  bool failed() const { return failed_; }
  /// What was thrown, if it failed.
  std::exception_ptr failure() const { return failure_; }
  /// How far it came, or why it failed; what run() would return if it ended here.
  RunEnd end_now(EndReason reason);

 private:
  std::string who(AgentId agent) const;
  void begin_event(Time time, Phase phase) {
    now_ = time;
    observing_ = phase == Phase::observe;
    acting_ = no_agent;
    ++end_.events;
  }
  bool quiet_at(Time time);
  void happen_next();

  Options options_;
  Time now_;
  EventQueue queue_;
  Record record_;
  ScheduleWatch* watch_ = nullptr;
  AgentId acting_ = no_agent;
  bool started_ = false;
  bool happening_ = false;  // an event is
  // Nothing is due before, and the run has not ended, as far as go_on() has looked.
  Time quiet_until_;
  bool observing_ = false;
  bool failed_ = false;
  std::exception_ptr failure_;
  RunEnd end_;
};

}  // namespace hearsay
