// Processes: behaviour over time, written as a coroutine.
//
//   Process Sensor::sense() {
//     for (;;) {
//       look();
//       co_await sleep(simulation_, 1_s);
//     }
//   }
//
// A Process object owns the coroutine: destroying it cancels whatever it waits for. Every resume
// goes through the event queue, never directly. An exception that leaves a process ends the run
// with the agent's name and the simulated time. After each co_await re-read shared state.
// Destroy a process before its simulation, unless it is done.
// Mind gcc 12: only `co_await call(lvalues);` or `auto x = co_await call(lvalues);`.
#pragma once

#include <coroutine>
#include <exception>
#include <utility>

#include "sim/kernel/simulation.hpp"

namespace hearsay {

class [[nodiscard]] Process {
 public:
  struct promise_type {
    Simulation* simulation = nullptr;
    AgentId agent = no_agent;
    bool running = false;
    std::exception_ptr error;

    Process get_return_object() {
      return Process(std::coroutine_handle<promise_type>::from_promise(*this));
    }
    std::suspend_always initial_suspend() noexcept { return {}; }
    std::suspend_always final_suspend() noexcept { return {}; }
    void return_void() {}
    void unhandled_exception() { error = std::current_exception(); }
  };
  using Handle = std::coroutine_handle<promise_type>;

  Process() = default;
  Process(Process&& other) noexcept
      : handle_(std::exchange(other.handle_, {})), first_(std::exchange(other.first_, {})) {}
  Process& operator=(Process&& other) noexcept;
  ~Process() { cancel(); }

  /// Lets the process begin in `simulation` at the current instant (through the queue), in the
  /// name of `agent`. Once, on a process that was made by a coroutine (else BrokenInvariant).
  void start(Simulation& simulation, AgentId agent);
  /// Ends the process where it stands; nothing of it runs any more. Harmless when it is over.
  /// A process must not cancel itself: the program stops if it does.
  void cancel();
  /// True if it has returned, failed, been cancelled or never been made.
  bool done() const { return !handle_ || handle_.done(); }

  /// Resumes `handle` in the name of its agent and passes an exception on to its simulation. For
  /// awaitables, from an event's callback only; afterwards the awaitable may be gone.
  static void resume(Handle handle);

 private:
  explicit Process(Handle handle) : handle_(handle) {}
  Handle handle_;
  EventId first_;
};

/// Awaitable: the process goes on at `until` (at once, through the queue, if that is past).
class [[nodiscard]] Sleep {
 public:
  Sleep(Simulation& simulation, Time until, Phase phase)
      : simulation_(simulation), until_(until), phase_(phase) {}
  Sleep(const Sleep&) = delete;
  Sleep& operator=(const Sleep&) = delete;
  ~Sleep() {
    if (event_ != EventId()) simulation_.cancel(event_);
  }

  bool await_ready() const noexcept { return false; }
  void await_suspend(Process::Handle handle);
  void await_resume() noexcept { event_ = {}; }

 private:
  Simulation& simulation_;
  Time until_;
  Phase phase_;
  EventId event_;
};

/// co_await sleep(simulation, 5_s): go on that much later. A negative span counts as zero; one
/// beyond the last instant never ends.
inline Sleep sleep(Simulation& simulation, Duration span, Phase phase = Phase::act) {
  return Sleep(simulation, simulation.after(span), phase);
}
/// co_await sleep_until(simulation, t): go on at that instant.
inline Sleep sleep_until(Simulation& simulation, Time until, Phase phase = Phase::act) {
  return Sleep(simulation, until, phase);
}

}  // namespace hearsay
