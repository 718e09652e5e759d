#include "sim/kernel/simulation.hpp"

#include <algorithm>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/kernel/what_of.hpp"

namespace hearsay {

namespace {

// "12.500000000": every nanosecond, without a detour through floating point.
std::string to_seconds(Time time) {
  constexpr std::int64_t ns_per_s = 1'000'000'000;
  const std::string fraction = std::to_string(time.nanoseconds() % ns_per_s);
  return std::to_string(time.nanoseconds() / ns_per_s) + "." +
         std::string(9 - fraction.size(), '0') + fraction;
}

}  // namespace

const char* to_string(EndReason reason) {
  switch (reason) {
    case EndReason::time_reached:
      return "time reached";
    case EndReason::nothing_left:
      return "nothing left";
    case EndReason::agent_failed:
      return "agent failed";
    case EndReason::event_budget:
      return "event budget";
  }
  throw BrokenInvariant("an end reason without a name");
}

Simulation::Simulation(const Options& options) : options_(options), record_(options.record) {
  require(options.end >= Time(), "a run ends before it starts");
}

Time Simulation::after(Duration span) const {
  if (span <= Duration()) return now_;
  return span >= Time::never() - now_ ? Time::never() : now_ + span;
}

// Whether nothing is due up to that instant, and there will be one.
bool Simulation::quiet_at(Time time) {
  if (failed_ || time > options_.end || time == Time::never()) return false;
  quiet_until_ = queue_.empty() ? Time::never() : queue_.next_time();
  if (options_.end < quiet_until_) quiet_until_ = options_.end + 1_ns;
  return time < quiet_until_;
}

std::string Simulation::who(AgentId agent) const {
  if (agent == no_agent) return "the run";
  const std::string name = name_of_agent ? name_of_agent(agent) : std::string();
  if (!name.empty()) return "agent '" + name + "'";
  return agent == central_agent ? "the central estimator" : "agent " + std::to_string(agent);
}

void Simulation::fail(AgentId agent, std::exception_ptr error) {
  if (failed_) return;
  failed_ = true;
  failure_ = error;
  quiet_until_ = Time();
  end_.reason = EndReason::agent_failed;
  end_.agent = agent;
  end_.message = who(agent) + " failed at " + to_seconds(now_) + " s: " + what_of(error);
}

inline void Simulation::happen_next() {
  EventQueue::Event event = queue_.pop();
  begin_event(event.time, event.phase);
  happening_ = true;
  try {
    event.callback();
  } catch (...) {
    fail(acting_, std::current_exception());
  }
  happening_ = false;
}

RunEnd Simulation::run() {
  require(!started_, "a simulation was run twice");
  started_ = true;
  while (!failed_) {
    const Time next = queue_.empty() ? Time::never() : queue_.next_time();
    if (next == Time::never() && (queue_.empty() || options_.end == Time::never())) {
      end_.reason = EndReason::nothing_left;
      break;
    }
    if (next > options_.end) {
      end_.reason = EndReason::time_reached;
      now_ = options_.end;
      break;
    }
    if (end_.events == options_.events_max) {
      end_.reason = EndReason::event_budget;
      break;
    }
    happen_next();
  }
  return end_now(end_.reason);
}

void Simulation::advance(Time time) {
  require(time >= now_, "the clock was to go back");
  require(time <= next_time() && time <= options_.end, "the clock was to pass what is due");
  now_ = time;
  observing_ = false;
  acting_ = no_agent;
}

void Simulation::happen() {
  require(next_time() <= options_.end, "nothing is due up to the end of the run");
  happen_next();
}

RunEnd Simulation::end_now(EndReason reason) {
  if (!failed_) end_.reason = reason;
  observing_ = false;
  acting_ = no_agent;
  end_.at = now_;
  return end_;
}

}  // namespace hearsay
