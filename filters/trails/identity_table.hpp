// Where the crumb of an identity is kept. Looked up, never gone through: nothing depends on the
// order of its entries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "filters/trails/trail.hpp"

namespace hearsay::trails {

/// Open addressing, at most half full; grows, and does not allocate once it has.
class IdentityTable {
 public:
  IdentityTable() : entries_(16) {}

  std::optional<std::uint32_t> find(const Identity& identity) const;
  /// An identity that is not in the table. @throws BrokenInvariant if it is.
  void insert(const Identity& identity, std::uint32_t slot);
  /// @throws BrokenInvariant if it is not in the table.
  void erase(const Identity& identity);
  std::size_t size() const { return size_; }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
  struct Entry {
    Identity identity;
    std::uint32_t slot = none;
  };
  std::size_t home(const Identity& identity) const;
  std::size_t after(std::size_t i) const { return (i + 1) & (entries_.size() - 1); }
  /// Of the identity, or of the free entry where it would stand.
  std::size_t spot(const Identity& identity) const;

  std::vector<Entry> entries_;
  std::size_t size_ = 0;
};

}  // namespace hearsay::trails
