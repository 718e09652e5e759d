// Grids as bytes: little-endian XCDR1, the encoding of these DDS types:
//
//   struct GridHead    { unsigned long incarnation, count;  // of the message
//                        unsigned long part, parts;         // this packet of the message's
//                        unsigned long cells;               // of the whole grid
//                        octet form, layers; };             // 0 whole, 1 changed, 2 runs
//   struct WholeGrid   { GridHead head; unsigned long first;      // cells first, first + 1, …
//                        sequence<float> values; };               // layers a cell
//   struct ChangedGrid { GridHead head; sequence<unsigned long> cells;  // rising
//                        sequence<float> values; };                     // layers a cell
//   struct GridRuns    { GridHead head; sequence<unsigned long> firsts, lengths;  // rising, apart
//                        sequence<float> values; };                               // layers a run
//
// A message is cut into packets of at most an MTU. Each packet stands alone: it says what the
// sender's evidence is in certain cells, and a lost one leaves just those unsaid. (incarnation,
// count) orders a sender's messages across reboots.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hearsay::grid {

enum class Form : std::uint8_t {
  whole,    ///< every cell
  changed,  ///< cells that differ from what was sent before
  runs,     ///< every cell, neighbours in number of equal values told once
};

/// Of a grid: its cells and numbers a cell (1: Bernoulli, 2: Beta).
struct Shape {
  int cells = 0;
  std::size_t layers = 1;
};
inline constexpr std::size_t layers_max = 2;

/// Exact bytes of a packet that holds `blocks` cells (whole, changed) or runs.
std::size_t packet_size(Form form, std::size_t layers, std::size_t blocks);
/// How many blocks fit into `mtu` bytes; 0 if none does.
std::size_t blocks_that_fit(Form form, std::size_t layers, std::size_t mtu);

/// What a message of a form takes, headers of packets included.
struct MessageSize {
  std::size_t blocks = 0, packets = 0, bytes = 0;
};
/// `evidence`: of all cells. `sent`: the same as it was sent before; looked at for Form::changed
/// alone. A message of changes without any change is one packet without blocks. @throws
/// BrokenInvariant for lengths that disagree with the shape, or an mtu in which no block fits.
MessageSize message_size(Form form, const Shape& shape, std::span<const float> evidence,
                         std::span<const float> sent, std::size_t mtu);

/// Cuts messages into packets; its storage is reused (no allocation once warm).
class Encoder {
 public:
  struct Message {
    std::uint32_t incarnation = 0, count = 0;
    Form form = Form::whole;
    std::span<const float> evidence;
    std::span<const float> sent = {};  ///< Form::changed alone
  };
  /// The packets, valid until the next call. @throws BrokenInvariant as message_size(), and for
  /// numbers that are not finite.
  std::span<const std::vector<std::byte>> encode(const Message& message, const Shape& shape,
                                                 std::size_t mtu);

 private:
  std::vector<std::vector<std::byte>> packets_;
};

struct PacketHead {
  std::uint32_t incarnation = 0, count = 0;
  std::uint32_t part = 0, parts = 1;
  Form form = Form::whole;
};

/// A packet that was found to be well-formed. Refers to the bytes it was made from.
class Packet {
 public:
  /// Nothing unless the bytes are exactly one well-formed packet about a grid of this shape: also
  /// if it is truncated or has trailing bytes, part ≥ parts, parts > cells, cells beyond the grid,
  /// not rising or overlapping, empty runs, lengths that disagree, or numbers that are not finite.
  /// Allocates nothing.
  static std::optional<Packet> parse(std::span<const std::byte> bytes, const Shape& shape);

  const PacketHead& head() const { return head_; }
  std::size_t blocks() const { return blocks_; }

  /// Calls f(first cell, numbers: layers a cell) for ranges of neighbours in number, rising. A
  /// range has at most 256 numbers, so that nothing is allocated: filters/grid/fusion.hpp takes
  /// them as they come.
  template <typename F>
  void for_each_range(F&& f) const {
    std::array<float, range_numbers> values;
    Cursor at;
    while (at.block < blocks_) {
      int first = 0;
      const std::size_t numbers = next_range(at, values, first);
      f(first, std::span<const float>(values.data(), numbers));
    }
  }
  /// Writes what the packet says into a copy of the sender's evidence. @throws BrokenInvariant
  /// unless it has the length of the grid's.
  void apply(std::span<float> evidence) const;

 private:
  static constexpr std::size_t range_numbers = 256;
  struct Cursor {
    std::size_t block = 0;   ///< next block
    std::size_t within = 0;  ///< cells of it that were already given
  };
  std::size_t next_range(Cursor& at, std::span<float> values, int& first) const;
  int first_of(std::size_t block) const;
  std::size_t length_of(std::size_t block) const;
  void values_of(std::size_t block, float* out) const;
  bool cells_in_order() const;
  bool all_finite() const;

  PacketHead head_;
  Shape shape_;
  std::size_t blocks_ = 0;
  std::uint32_t first_ = 0;                               ///< whole
  std::span<const std::byte> firsts_, lengths_, values_;  ///< as they came
};

}  // namespace hearsay::grid
