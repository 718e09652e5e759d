#include "sim/kernel/process.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "sim/kernel/error.hpp"

namespace hearsay {

Process& Process::operator=(Process&& other) noexcept {
  if (this != &other) {
    cancel();
    handle_ = std::exchange(other.handle_, {});
    first_ = std::exchange(other.first_, {});
  }
  return *this;
}

void Process::start(Simulation& simulation, AgentId agent) {
  require(static_cast<bool>(handle_), "a process was started that was never made");
  promise_type& promise = handle_.promise();
  require(promise.simulation == nullptr, "a process was started twice");
  const Handle handle = handle_;
  first_ = simulation.schedule(simulation.now(), Phase::act, [handle] { resume(handle); });
  promise.simulation = &simulation;
  promise.agent = agent;
}

void Process::cancel() {
  if (!handle_) return;
  const promise_type& promise = handle_.promise();
  if (promise.running) {
    // Its frame is in use further down this stack, and a destructor cannot report by throwing.
    std::fputs("hearsay: a process cancelled or destroyed itself\n", stderr);
    std::abort();
  }
  if (!handle_.done() && promise.simulation != nullptr) promise.simulation->cancel(first_);
  first_ = {};
  std::exchange(handle_, {}).destroy();
}

void Process::resume(Handle handle) {
  promise_type& promise = handle.promise();
  promise.simulation->acting_for(promise.agent);
  promise.running = true;
  handle.resume();
  promise.running = false;
  if (promise.error) promise.simulation->fail(promise.agent, promise.error);
}

void Sleep::await_suspend(Process::Handle handle) {
  event_ = simulation_.schedule(std::max(until_, simulation_.now()), phase_,
                                [handle] { Process::resume(handle); });
}

}  // namespace hearsay
