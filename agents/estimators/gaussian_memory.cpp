// What a GaussianEstimator remembers, as bytes.
#include "agents/estimators/gaussian.hpp"
#include "agents/packed_beliefs.hpp"

namespace hearsay {
namespace {

void put_all(Packer& out, const std::vector<TrackedBelief>& beliefs) {
  out.count(beliefs.size());
  for (const TrackedBelief& tracked : beliefs) put(out, tracked);
}

/// As many as there are, of dimension n.
void take_all(Unpacker& in, std::vector<TrackedBelief>& beliefs, int n) {
  if (in.count(20) != beliefs.size()) in.fail();
  for (TrackedBelief& tracked : beliefs) {
    take(in, tracked);
    if (tracked.belief.dimension() != n) in.fail();
  }
}

}  // namespace

bool GaussianEstimator::save(std::vector<std::byte>& memory) const {
  memory.clear();
  Packer out(memory);
  out.u8(static_cast<std::uint8_t>(options_.rule));
  out.i64(stamp_);
  out.u32(incarnation_);
  out.u32(static_cast<std::uint32_t>(degree_));
  for (const auto* beliefs : {&own_, &unsent_, &last_fresh_}) put_all(out, *beliefs);
  out.count(neighbours_.size());
  for (const Neighbour& neighbour : neighbours_) {
    out.u32(static_cast<std::uint32_t>(neighbour.id));
    out.flag(neighbour.heard);
    out.u32(neighbour.incarnation);
    out.u32(neighbour.count);
    put_all(out, neighbour.memory);
    out.count(neighbour.held.size());
    for (const Held& held : neighbour.held) {
      out.flag(held.waits);
      out.u32(static_cast<std::uint32_t>(held.degree));
      hearsay::put(out, held.said);
      hearsay::put(out, held.fresh);
    }
  }
  return true;
}

// What it said after it was saved it does not remember; its next words count as newer by their
// incarnation.
bool GaussianEstimator::recall(std::span<const std::byte> memory) {
  Unpacker in(memory);
  const int n = options_.dimension;
  if (in.u8() != static_cast<std::uint8_t>(options_.rule)) return false;
  const std::int64_t stamp = in.i64();
  const std::uint32_t incarnation = in.u32();
  const auto degree = static_cast<int>(in.u32());
  GaussianEstimator recalled(options_, {});
  for (auto* beliefs : {&recalled.own_, &recalled.unsent_, &recalled.last_fresh_}) {
    take_all(in, *beliefs, n);
  }
  const std::size_t neighbours = in.count(17);
  for (std::size_t i = 0; i < neighbours && in.good(); ++i) {
    Neighbour neighbour = make_neighbour(static_cast<AgentId>(in.u32()));
    neighbour.heard = in.flag();
    neighbour.incarnation = in.u32();
    neighbour.count = in.u32();
    take_all(in, neighbour.memory, n);
    if (in.count(45) != neighbour.held.size()) in.fail();
    for (Held& held : neighbour.held) {
      held.waits = in.flag();
      held.degree = static_cast<int>(in.u32());
      hearsay::take(in, held.said);
      hearsay::take(in, held.fresh);
    }
    recalled.neighbours_.push_back(std::move(neighbour));
  }
  if (!in.done() || stamp < 0) return false;
  own_ = std::move(recalled.own_);
  unsent_ = std::move(recalled.unsent_);
  last_fresh_ = std::move(recalled.last_fresh_);
  neighbours_ = std::move(recalled.neighbours_);
  stamp_ = stamp;
  incarnation_ = incarnation;
  degree_ = degree;
  new_incarnation();
  return true;
}

}  // namespace hearsay
