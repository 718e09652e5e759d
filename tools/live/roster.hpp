// Who takes part in a fleet, as its world knows them: they say hello, are welcome or refused, and
// one day are gone.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "net/live/messages.hpp"
#include "net/live/port.hpp"
#include "tools/live/options.hpp"
#include "tools/live/reactor.hpp"

namespace hearsay::fleet {

struct Member {
  live::Writer orders;
  live::Reader answers;
  live::Writer measurements;
  live::Reader reports;
  std::uint64_t process = 0;  ///< that was welcome last; 0: nobody came yet
  std::uint64_t heir = 0;     ///< another that wants to take its place, …
  WallTime heir_since;        ///< … since then
  bool remembers = false;     ///< it says that it kept its memory
  bool ours = false;          ///< a `hearsay agent`: it obeys orders
  bool here = false;          ///< it is heard, and hears

  /// Whether it shows signs of life.
  bool alive() const { return answers.writers_alive() + reports.writers_alive() > 0; }
};

class Roster {
 public:
  /// For agents 0 … agents − 1. All outlive this.
  Roster(live::Port& port, Reactor& reactor, const WorldOptions& options, int agents);

  /// Waits until all are here. @return what is to be said otherwise: who is missing, after
  /// patience_s; empty also if the process was asked to stop.
  std::string gather();

  /// Answers who says hello, and looks who is here. @return agents that are new since the last
  /// call.
  std::vector<AgentId> update(std::int64_t now_ns);

  Member& member(AgentId id) { return members_[static_cast<std::size_t>(id)]; }
  int size() const { return static_cast<int>(members_.size()); }
  /// Processes that were refused so far.
  int refused() const { return refused_; }

 private:
  std::string objection(const live::Hello& hello);
  /// Somebody is there already, who may have died a moment ago: time will show.
  bool must_wait(const live::Hello& hello);
  void answer(const live::Hello& hello, const std::string& objection, std::int64_t now_ns);

  Reactor& reactor_;
  const WorldOptions& options_;
  live::Reader hellos_;
  live::Writer welcomes_;
  std::vector<Member> members_;
  int refused_ = 0;
  std::uint64_t refused_last_ = 0;  // whom
  std::vector<std::byte> bytes_;
};

}  // namespace hearsay::fleet
