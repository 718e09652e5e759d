// What a world and an agent in another process tell each other: all of it in lockstep; in real time
// orders, and what the agent asks and tells of its world.
//
// The world gives an order: begin, what you planned for now is due, this was measured, this packet
// came. The agent acts on it and answers, first with calls, each of which the world answers by an
// order to go on (send this packet: taken or not), last with `done`. Every answer bears what
// happened since the one before, in its order: rows for the record, and what was planned. The world
// keeps the agent's plans in its own queue, so that what happens at one instant happens in the
// order in which it would within one process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "agents/estimator.hpp"
#include "agents/measurement.hpp"
#include "net/radio_port.hpp"
#include "sim/kernel/event_queue.hpp"
#include "sim/kernel/record.hpp"

namespace hearsay::remote {

enum class OrderKind : std::uint8_t {
  start,
  wake,         ///< the first of its plans is due
  measurement,  ///< was made by one of its sensors
  packet,       ///< arrived
  outcome,      ///< of a packet that was to be acknowledged
  queue_empty,  ///< of its radio
  down,
  up,
  report,   ///< what it believes
  finish,   ///< leaves its final values
  go_on,    ///< answers a call
  dismiss,  ///< nothing comes after this, and nobody waits for an answer
};

/// What an agent can see of its radio.
struct Surroundings {
  bool up = true;
  bool hears_strangers = false;
  std::uint32_t waiting = 0;
  std::optional<Point> position_m;
  /// If they are others than the last that were told.
  std::optional<std::vector<AgentId>> neighbours;
};

struct Order {
  OrderKind kind = OrderKind::start;
  Time now;
  Surroundings surroundings;
  /// Where ledgers of trajectories are kept: the stamps of what the fleet measured since the last
  /// order, by subject.
  std::vector<std::vector<std::int64_t>> measured_at = {};
  Measurement measurement = {};
  // A packet, or the one whose outcome this is.
  std::string message_kind = {};
  AgentId sender = no_agent, receiver = no_agent;
  Time sent = {};
  std::vector<std::byte> bytes = {};
  std::vector<std::byte> rider = {};  ///< as its RiderCodec wrote it; empty: none
  /// outcome: it was acknowledged. up: it forgets. go_on: the packet was taken.
  bool yes = false;
  std::uint32_t lives = 0;              ///< start: how often it began before, in this run
  std::int64_t stamp = 0;               ///< report: of the present
  double value = 0.0;                   ///< go_on: the distance that was asked for
  std::vector<std::byte> content = {};  ///< go_on: the answer to what was asked
  std::uint64_t number = 0;             ///< go_on, out of lockstep: of what was asked
};

enum class AnswerKind : std::uint8_t {
  done,
  send,                 ///< calls: a packet is to be sent, …
  tell_of_empty_queue,  ///< … it wants to know when its queue is empty, …
  distance,             ///< … how far from the truth is this belief? …
  ask,                  ///< … a question about its world (agents/remote/distant_world)
  failed,               ///< an exception left its code
};

/// Something that the agent planned, or that it will not do after all.
struct Plan {
  std::uint64_t event = 0;
  bool cancelled = false;
  Time time = {};
  Phase phase = Phase::act;
};

struct Row {
  enum class Kind : std::uint8_t { scalar, series, event } kind = Kind::scalar;
  Time time = {};
  std::string name;
  std::string text;  ///< series: the subject; event: the detail
  double value = 0.0;
};

struct Answer {
  AnswerKind kind = AnswerKind::done;
  std::vector<std::byte> notes = {};  ///< one after another, each with its length; come first
  std::vector<Plan> plans = {};
  std::vector<Row> rows = {};
  // send
  std::string message_kind = {};
  AgentId receiver = no_agent;
  std::optional<std::uint64_t> tick = {};
  std::uint64_t news_of = 0;  ///< Outgoing::subject
  bool acknowledged = false;
  std::vector<std::byte> bytes = {};
  std::vector<std::byte> rider = {};
  // distance
  int subject = 0;
  gaussian::Belief belief = {};
  std::string failure = {};
  // ask
  std::uint64_t number = 0;  ///< out of lockstep: counts what is asked
  /// ask: the question. done, of a report: what its Reporter tells.
  std::vector<std::byte> content = {};
  // done, of a report
  std::vector<TrackedBelief> beliefs = {};  ///< by subject
  EstimatorCounts counts = {};
};

/// Overwrite `out`, whose capacity is reused.
void pack(const Order& order, std::vector<std::byte>& out);
void pack(const Answer& answer, std::vector<std::byte>& out);
void pack(const LedgerRider& rider, std::vector<std::byte>& out);
/// False, and the result unspecified, if the bytes are not exactly what pack() makes of one:
/// truncated, trailing bytes, an unknown kind, a dimension beyond gaussian::dimension_max.
bool unpack(std::span<const std::byte> bytes, Order& order);
bool unpack(std::span<const std::byte> bytes, Answer& answer);
bool unpack(std::span<const std::byte> bytes, LedgerRider& rider);

}  // namespace hearsay::remote
