#include "agents/remote/protocol.hpp"

#include "agents/packed_beliefs.hpp"

namespace hearsay::remote {
namespace {

void put(Packer& out, const std::vector<Ledger>& ledgers) {
  out.count(ledgers.size());
  for (const Ledger& ledger : ledgers) put(out, ledger);
}

void take(Unpacker& in, std::vector<Ledger>& ledgers) {
  ledgers.resize(in.count(19));
  for (Ledger& ledger : ledgers) take(in, ledger);
}

void put(Packer& out, const Surroundings& surroundings) {
  out.flag(surroundings.up);
  out.flag(surroundings.hears_strangers);
  out.u32(surroundings.waiting);
  out.flag(surroundings.position_m.has_value());
  for (const double x : surroundings.position_m.value_or(Point())) out.f64(x);
  out.flag(surroundings.neighbours.has_value());
  if (!surroundings.neighbours) return;
  out.count(surroundings.neighbours->size());
  for (const AgentId id : *surroundings.neighbours) out.u32(static_cast<std::uint32_t>(id));
}

void take(Unpacker& in, Surroundings& surroundings) {
  surroundings = {.up = in.flag(), .hears_strangers = in.flag(), .waiting = in.u32()};
  const bool placed = in.flag();
  Point place_m;
  for (double& x : place_m) x = in.f64();
  if (placed) surroundings.position_m = place_m;
  if (!in.flag()) return;
  std::vector<AgentId>& neighbours = surroundings.neighbours.emplace(in.count(4));
  for (AgentId& id : neighbours) id = static_cast<AgentId>(in.u32());
}

void put(Packer& out, Time time) { out.i64(time.nanoseconds()); }
Time take_time(Unpacker& in) { return Time::nanoseconds(in.i64()); }

void put(Packer& out, const EstimatorCounts& counts) {
  for (const std::uint64_t count :
       {counts.measurements, counts.fusions, counts.skipped, counts.refused, counts.late}) {
    out.u64(count);
  }
  out.f64(counts.fusion_gain_max);
}

void take(Unpacker& in, EstimatorCounts& counts) {
  for (std::uint64_t* count :
       {&counts.measurements, &counts.fusions, &counts.skipped, &counts.refused, &counts.late}) {
    *count = in.u64();
  }
  counts.fusion_gain_max = in.f64();
}

template <class Enum>
Enum take_kind(Unpacker& in, Enum last) {
  const std::uint8_t value = in.u8();
  if (value > static_cast<std::uint8_t>(last)) in.fail();
  return static_cast<Enum>(value);
}

void take_bytes(Unpacker& in, std::vector<std::byte>& bytes) {
  const std::span<const std::byte> taken = in.bytes();
  bytes.assign(taken.begin(), taken.end());
}

void put(Packer& out, const Plan& plan) {
  out.u64(plan.event);
  out.flag(plan.cancelled);
  put(out, plan.time);
  out.u8(static_cast<std::uint8_t>(plan.phase));
}

void take(Unpacker& in, Plan& plan) {
  plan.event = in.u64();
  plan.cancelled = in.flag();
  plan.time = take_time(in);
  plan.phase = take_kind(in, Phase::observe);
}

void put(Packer& out, const Row& row) {
  out.u8(static_cast<std::uint8_t>(row.kind));
  put(out, row.time);
  out.text(row.name);
  out.text(row.text);
  out.f64(row.value);
}

void take(Unpacker& in, Row& row) {
  row.kind = take_kind(in, Row::Kind::event);
  row.time = take_time(in);
  row.name = in.text();
  row.text = in.text();
  row.value = in.f64();
}

}  // namespace

void pack(const Order& order, std::vector<std::byte>& bytes) {
  bytes.clear();
  Packer out(bytes);
  out.u8(static_cast<std::uint8_t>(order.kind));
  put(out, order.now);
  put(out, order.surroundings);
  out.count(order.measured_at.size());
  for (const std::vector<std::int64_t>& stamps : order.measured_at) {
    out.count(stamps.size());
    for (const std::int64_t stamp : stamps) out.i64(stamp);
  }
  out.u32(static_cast<std::uint32_t>(order.measurement.subject));
  put(out, order.measurement.information);
  out.u64(order.measurement.index);
  out.text(order.message_kind);
  out.u32(static_cast<std::uint32_t>(order.sender));
  out.u32(static_cast<std::uint32_t>(order.receiver));
  put(out, order.sent);
  out.bytes(order.bytes);
  out.bytes(order.rider);
  out.flag(order.yes);
  out.u32(order.lives);
  out.i64(order.stamp);
  out.f64(order.value);
  out.bytes(order.content);
  out.u64(order.number);
}

bool unpack(std::span<const std::byte> bytes, Order& order) {
  Unpacker in(bytes);
  order.kind = take_kind(in, OrderKind::dismiss);
  order.now = take_time(in);
  take(in, order.surroundings);
  order.measured_at.resize(in.count(4));
  for (std::vector<std::int64_t>& stamps : order.measured_at) {
    stamps.resize(in.count(8));
    for (std::int64_t& stamp : stamps) stamp = in.i64();
  }
  order.measurement.subject = static_cast<int>(in.u32());
  take(in, order.measurement.information);
  order.measurement.index = in.u64();
  order.message_kind = in.text();
  order.sender = static_cast<AgentId>(in.u32());
  order.receiver = static_cast<AgentId>(in.u32());
  order.sent = take_time(in);
  take_bytes(in, order.bytes);
  take_bytes(in, order.rider);
  order.yes = in.flag();
  order.lives = in.u32();
  order.stamp = in.i64();
  order.value = in.f64();
  take_bytes(in, order.content);
  order.number = in.u64();
  return in.done();
}

void pack(const Answer& answer, std::vector<std::byte>& bytes) {
  bytes.clear();
  Packer out(bytes);
  out.u8(static_cast<std::uint8_t>(answer.kind));
  out.bytes(answer.notes);
  out.count(answer.plans.size());
  for (const Plan& plan : answer.plans) put(out, plan);
  out.count(answer.rows.size());
  for (const Row& row : answer.rows) put(out, row);
  out.text(answer.message_kind);
  out.u32(static_cast<std::uint32_t>(answer.receiver));
  out.flag(answer.tick.has_value());
  out.u64(answer.tick.value_or(0));
  out.u64(answer.news_of);
  out.flag(answer.acknowledged);
  out.bytes(answer.bytes);
  out.bytes(answer.rider);
  out.u32(static_cast<std::uint32_t>(answer.subject));
  put(out, answer.belief);
  out.text(answer.failure);
  out.u64(answer.number);
  out.bytes(answer.content);
  out.count(answer.beliefs.size());
  for (const TrackedBelief& tracked : answer.beliefs) put(out, tracked);
  put(out, answer.counts);
}

bool unpack(std::span<const std::byte> bytes, Answer& answer) {
  Unpacker in(bytes);
  answer.kind = take_kind(in, AnswerKind::failed);
  take_bytes(in, answer.notes);
  answer.plans.resize(in.count(18));
  for (Plan& plan : answer.plans) take(in, plan);
  answer.rows.resize(in.count(25));
  for (Row& row : answer.rows) take(in, row);
  answer.message_kind = in.text();
  answer.receiver = static_cast<AgentId>(in.u32());
  const bool ticks = in.flag();
  const std::uint64_t tick = in.u64();
  answer.tick = ticks ? std::optional(tick) : std::nullopt;
  answer.news_of = in.u64();
  answer.acknowledged = in.flag();
  take_bytes(in, answer.bytes);
  take_bytes(in, answer.rider);
  answer.subject = static_cast<int>(in.u32());
  take(in, answer.belief);
  answer.failure = in.text();
  answer.number = in.u64();
  take_bytes(in, answer.content);
  answer.beliefs.resize(in.count(20));
  for (TrackedBelief& tracked : answer.beliefs) take(in, tracked);
  take(in, answer.counts);
  return in.done();
}

void pack(const LedgerRider& rider, std::vector<std::byte>& bytes) {
  bytes.clear();
  Packer out(bytes);
  put(out, rider.ledgers);
  put(out, rider.fresh);
}

bool unpack(std::span<const std::byte> bytes, LedgerRider& rider) {
  Unpacker in(bytes);
  take(in, rider.ledgers);
  take(in, rider.fresh);
  return in.done();
}

}  // namespace hearsay::remote
