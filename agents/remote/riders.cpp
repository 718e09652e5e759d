#include "agents/remote/riders.hpp"

#include "agents/packed_beliefs.hpp"
#include "agents/remote/protocol.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::remote {

void LedgerRiders::write(const Rider& rider, std::vector<std::byte>& out) {
  out.clear();
  const auto* const own = dynamic_cast<const LedgerRider*>(&rider);
  if (own) pack(*own, out);
}

RiderPtr LedgerRiders::read(std::span<const std::byte> bytes) {
  LedgerRider* rider = nullptr;
  RiderPtr made = pool_.make(rider);
  require(unpack(bytes, *rider), "an agent's ledger is malformed");
  return made;
}

void GridRiders::write(const Rider& rider, std::vector<std::byte>& out) {
  out.clear();
  const auto* const own = dynamic_cast<const GridRider*>(&rider);
  if (!own) return;
  Packer packer(out);
  put(packer, own->ledger);
}

RiderPtr GridRiders::read(std::span<const std::byte> bytes) {
  GridRider* rider = nullptr;
  RiderPtr made = pool_.make(rider);
  Unpacker in(bytes);
  take(in, shape_, rider->ledger);
  require(in.done(), "an agent's ledger of its grid is malformed");
  return made;
}

}  // namespace hearsay::remote
