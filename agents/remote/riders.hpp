// How ledgers pass between processes, which share no memory: the riders of an agent's packets as
// bytes.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "agents/estimator.hpp"
#include "agents/grids/grid_estimator.hpp"

namespace hearsay::remote {

class RiderCodec {
 public:
  virtual ~RiderCodec() = default;
  /// In place of what `out` held: nothing for a rider of another kind, which nobody here reads.
  virtual void write(const Rider& rider, std::vector<std::byte>& out) = 0;
  /// @throws BrokenInvariant for bytes that are no rider.
  virtual RiderPtr read(std::span<const std::byte> bytes) = 0;
};

/// Of estimators.
class LedgerRiders final : public RiderCodec {
 public:
  /// `pool` outlives this.
  explicit LedgerRiders(LedgerPool& pool) : pool_(pool) {}
  void write(const Rider& rider, std::vector<std::byte>& out) override;
  RiderPtr read(std::span<const std::byte> bytes) override;

 private:
  LedgerPool& pool_;
};

/// Of explorers.
class GridRiders final : public RiderCodec {
 public:
  /// Of grids of this shape. `pool` outlives this.
  GridRiders(RiderPool<GridRider>& pool, const grid::Shape& shape) : pool_(pool), shape_(shape) {}
  void write(const Rider& rider, std::vector<std::byte>& out) override;
  RiderPtr read(std::span<const std::byte> bytes) override;

 private:
  RiderPool<GridRider>& pool_;
  grid::Shape shape_;
};

}  // namespace hearsay::remote
