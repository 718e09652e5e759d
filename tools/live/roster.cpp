#include "tools/live/roster.hpp"

#include <fmt/core.h>

#include "agents/remote/protocol.hpp"

namespace hearsay::fleet {
namespace {

using namespace std::chrono_literals;

/// A process that was killed seems alive for as long.
constexpr auto last_breath = 3s;

Member make_member(live::Port& port, std::uint32_t agent) {
  const std::string partition = live::agent_partition(port.fleet(), agent);
  return {.orders = port.writer(live::order_topic(), partition),
          .answers = port.reader(live::answer_topic(), partition),
          .measurements = port.writer(live::measurement_topic(), partition),
          .reports = port.reader(live::report_topic(), partition)};
}

}  // namespace

Roster::Roster(live::Port& port, Reactor& reactor, const WorldOptions& options, int agents)
    : reactor_(reactor),
      options_(options),
      hellos_(port.reader(live::hello_topic(), live::fleet_partition(port.fleet()))),
      welcomes_(port.writer(live::welcome_topic(), live::fleet_partition(port.fleet()))) {
  for (int agent = 0; agent < agents; ++agent) {
    members_.push_back(make_member(port, static_cast<std::uint32_t>(agent)));
  }
}

std::string Roster::gather() {
  const WallTime until = WallClock::now() + wall(options_.patience_s);
  for (;;) {
    update(0);
    std::string missing;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (!members_[i].here) missing += (missing.empty() ? "" : ", ") + std::to_string(i);
    }
    if (missing.empty() || reactor_.stopped()) return {};
    if (WallClock::now() >= until) {
      return fmt::format("after {:g} s these agents have not come: {}", options_.patience_s,
                         missing);
    }
    reactor_.wait(std::min(until, WallClock::now() + 100ms));
  }
}

std::vector<AgentId> Roster::update(std::int64_t now_ns) {
  live::Hello hello;
  while (hellos_.take(bytes_)) {
    if (!live::decode(bytes_, hello) || must_wait(hello)) continue;
    answer(hello, objection(hello), now_ns);
  }
  std::vector<AgentId> arrived;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Member& member = members_[i];
    if (member.here || member.process == 0 || !member.alive()) continue;
    if (member.ours && (!member.orders.matched() || member.answers.writers_alive() == 0)) continue;
    member.here = true;
    arrived.push_back(static_cast<AgentId>(i));
  }
  return arrived;
}

bool Roster::must_wait(const live::Hello& hello) {
  if (hello.agent >= members_.size()) return false;
  Member& member = members_[hello.agent];
  if (member.process == hello.process || !member.here || !member.alive()) return false;
  if (member.heir != hello.process) {
    member.heir = hello.process;
    member.heir_since = WallClock::now();
  }
  return WallClock::now() < member.heir_since + last_breath;
}

std::string Roster::objection(const live::Hello& hello) {
  if (hello.protocol != live::protocol) {
    return fmt::format("it speaks protocol {}, this world {}", hello.protocol, live::protocol);
  }
  if (hello.agent >= members_.size()) {
    return fmt::format("there is no agent {}: the scenario has {}", hello.agent, members_.size());
  }
  // Who knows the IDL alone need not know the scenario.
  if (!hello.scenario.empty() && hello.scenario != options_.scenario_hash) {
    return "it has another scenario, or other settings of it";
  }
  const bool ours = hello.version.starts_with("hearsay ");
  if (ours && hello.version != options_.version) {
    return fmt::format("it is of version '{}', this world of '{}'", hello.version,
                       options_.version);
  }
  if (options_.lockstep && !ours)
    return "this world moves in lockstep, which only hearsay's own agents can";
  const Member& member = members_[hello.agent];
  if (member.process != hello.process && member.here && member.alive()) {
    return fmt::format("agent {} is there already", hello.agent);
  }
  return {};
}

void Roster::answer(const live::Hello& hello, const std::string& objection, std::int64_t now_ns) {
  live::Welcome welcome{.agent = hello.agent,
                        .process = hello.process,
                        .accepted = objection.empty(),
                        .lockstep = options_.lockstep,
                        .seed = options_.seed,
                        .now_ns = now_ns,
                        .speed = options_.speed,
                        .reason = objection};
  if (welcome.accepted) {
    Member& member = members_[hello.agent];
    if (member.process != hello.process) member.here = false;
    member.process = hello.process;
    member.remembers = hello.remembers;
    member.ours = hello.version.starts_with("hearsay ");
  } else if (refused_last_ != hello.process) {
    ++refused_;
    refused_last_ = hello.process;
    fmt::print(stderr, "hearsay world: refused agent {}: {}\n", hello.agent, objection);
  }
  std::vector<std::byte> bytes;
  live::encode(welcome, bytes);
  welcomes_.write(bytes);
}

}  // namespace hearsay::fleet
