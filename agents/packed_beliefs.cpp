#include "agents/packed_beliefs.hpp"

#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay {

void put(Packer& out, const gaussian::Belief& belief) {
  const int n = belief.dimension();
  out.u8(static_cast<std::uint8_t>(n));
  for (int i = 0; i < n; ++i) out.f64(belief.xi(i));
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) out.f64(belief.omega(i, j));
  }
}

void take(Unpacker& in, gaussian::Belief& belief) {
  const int n = in.u8();
  if (n > gaussian::dimension_max) {
    in.fail();
    return;
  }
  belief.xi.resize(n);
  belief.omega.resize(n, n);
  for (int i = 0; i < n; ++i) belief.xi(i) = in.f64();
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) belief.omega(i, j) = in.f64();
  }
}

void put(Packer& out, const Ledger& ledger) {
  const Ledger::Parts parts = ledger.parts();
  out.u8(static_cast<std::uint8_t>(parts.dimension));
  out.flag(parts.moves);
  out.flag(parts.exact);
  out.numbers(parts.weights);
  out.numbers(parts.matrices);
  out.numbers(parts.drift);
  out.bytes(std::as_bytes(std::span(parts.reach)));
}

void take(Unpacker& in, Ledger& ledger) {
  Ledger::Parts parts;
  parts.dimension = in.u8();
  parts.moves = in.flag();
  parts.exact = in.flag();
  parts.weights = in.numbers();
  parts.matrices = in.numbers();
  parts.drift = in.numbers();
  for (const std::byte reached : in.bytes()) {
    parts.reach.push_back(std::to_integer<std::uint8_t>(reached));
  }
  if (!in.good()) return;
  try {
    ledger = Ledger::from(std::move(parts));
  } catch (const BrokenInvariant&) {
    in.fail();
  }
}

void put(Packer& out, const TrackedBelief& tracked) {
  put(out, tracked.belief);
  put(out, tracked.ledger);
}

void take(Unpacker& in, TrackedBelief& tracked) {
  take(in, tracked.belief);
  take(in, tracked.ledger);
}

// Numbers that have met no look are left out.
void put(Packer& out, const grid::LookLedger& ledger) {
  const grid::Shape& shape = ledger.shape();
  const std::size_t numbers = static_cast<std::size_t>(shape.cells) * shape.layers;
  out.count(numbers);
  for (std::size_t number = 0; number < numbers; ++number) {
    const std::span<const float> weights = ledger.weights(number);
    if (weights.empty()) continue;
    out.count(number);
    out.count(weights.size());
    for (const float weight : weights) out.f32(weight);
  }
  out.count(numbers);
}

void take(Unpacker& in, const grid::Shape& shape, grid::LookLedger& ledger) {
  const std::size_t numbers = static_cast<std::size_t>(shape.cells) * shape.layers;
  ledger = grid::LookLedger(shape);
  if (in.u32() != numbers) in.fail();
  std::vector<float> weights;
  for (std::size_t number = in.u32(); number < numbers && in.good(); number = in.u32()) {
    weights.resize(in.count(4));
    for (float& weight : weights) weight = in.f32();
    ledger.assign(number, weights);
  }
}

}  // namespace hearsay
