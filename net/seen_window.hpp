// Which of the numbers 0, 1, 2, … were seen, in memory that does not grow.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace hearsay {

/// Remembers `span` numbers from the first one not seen. A number further ahead moves that
/// beginning on: what was missing and is left behind is given up.
class SeenWindow {
 public:
  static constexpr std::uint32_t span = 512;
  static constexpr std::size_t words = span / 64;
  enum class Place : std::uint8_t {
    fresh,   ///< not seen yet
    seen,    ///< seen
    behind,  ///< before the window, and not known whether seen or given up
  };

  Place place(std::uint32_t number) const {
    if (number < complete_) return Place::seen;
    if (number < base_) return Place::behind;
    const std::uint32_t i = number - base_;
    return i < span && (bits_[i / 64] >> (i % 64) & 1) != 0 ? Place::seen : Place::fresh;
  }
  /// Remembers a fresh number below 2^32 − 1.
  void mark(std::uint32_t number) {
    std::uint32_t i = number - base_;
    if (i >= span) {
      advance(i - span + 1);
      i = span - 1;
    }
    bits_[i / 64] |= std::uint64_t{1} << (i % 64);
    close_up();
  }
  /// Gives up what is missing before `number`.
  void give_up_before(std::uint32_t number) {
    if (number <= base_) return;
    advance(number - base_);
    close_up();
  }

  /// The first number of the window, and whether base + i was seen: bit i % 64 of word i / 64.
  std::uint32_t base() const { return base_; }
  const std::array<std::uint64_t, words>& bits() const { return bits_; }
  /// Words up to the last that is not 0.
  std::size_t words_used() const {
    std::size_t used = words;
    while (used > 0 && bits_[used - 1] == 0) --used;
    return used;
  }
  static SeenWindow of(std::uint32_t base, const std::array<std::uint64_t, words>& bits) {
    SeenWindow window;
    window.base_ = base;
    window.bits_ = bits;
    return window;
  }

 private:
  void close_up() {
    const bool complete = complete_ == base_;
    while ((bits_[0] & 1) != 0) advance(static_cast<std::uint32_t>(std::countr_one(bits_[0])));
    if (complete) complete_ = base_;
  }
  void advance(std::uint32_t by) {
    base_ += by;
    const std::size_t whole = std::min<std::size_t>(by / 64, words);
    const unsigned part = by % 64;
    for (std::size_t w = 0; w < words; ++w) {
      const std::uint64_t low = w + whole < words ? bits_[w + whole] : 0;
      const std::uint64_t high = w + whole + 1 < words ? bits_[w + whole + 1] : 0;
      bits_[w] = part == 0 ? low : (low >> part) | (high << (64 - part));
    }
  }

  std::uint32_t base_ = 0;
  std::uint32_t complete_ = 0;  // all before were seen
  std::array<std::uint64_t, words> bits_{};
};

}  // namespace hearsay
