#include "filters/trails/identity_table.hpp"

#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay::trails {

std::size_t IdentityTable::home(const Identity& identity) const {
  // Consecutive numbers of a robot to spread; the finish of SplitMix64.
  std::uint64_t x = (std::uint64_t{identity.robot} << 32) + identity.number;
  x += std::uint64_t{identity.incarnation} * 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return static_cast<std::size_t>(x ^ (x >> 31)) & (entries_.size() - 1);
}

std::size_t IdentityTable::spot(const Identity& identity) const {
  std::size_t i = home(identity);
  while (entries_[i].slot != none && entries_[i].identity != identity) i = after(i);
  return i;
}

std::optional<std::uint32_t> IdentityTable::find(const Identity& identity) const {
  const Entry& entry = entries_[spot(identity)];
  if (entry.slot == none) return std::nullopt;
  return entry.slot;
}

void IdentityTable::insert(const Identity& identity, std::uint32_t slot) {
  require(slot != none, "identity table: a slot that cannot be");
  if (2 * (size_ + 1) > entries_.size()) {
    const std::vector<Entry> old = std::exchange(entries_, std::vector<Entry>(2 * entries_.size()));
    for (const Entry& entry : old) {
      if (entry.slot != none) entries_[spot(entry.identity)] = entry;
    }
  }
  Entry& entry = entries_[spot(identity)];
  require(entry.slot == none, "identity table: the identity is there already");
  entry = {identity, slot};
  ++size_;
}

void IdentityTable::erase(const Identity& identity) {
  std::size_t hole = spot(identity);
  require(entries_[hole].slot != none, "identity table: the identity is not there");
  // Close the gap: who stands behind it, and would be looked for from before it, moves up.
  for (std::size_t i = after(hole); entries_[i].slot != none; i = after(i)) {
    const std::size_t mask = entries_.size() - 1,
                      from_home = (i - home(entries_[i].identity)) & mask;
    if (from_home >= ((i - hole) & mask)) {
      entries_[hole] = entries_[i];
      hole = i;
    }
  }
  entries_[hole].slot = none;
  --size_;
}

}  // namespace hearsay::trails
