// What a world and its agents say to each other, as bytes: little-endian XCDR1 of the types of the
// same names in net/live/idl/live.idl. Nothing here knows DDS.
//
// encode() overwrites `out` and reuses its capacity; it throws BrokenInvariant for lengths beyond
// the bounds below, texts with a NUL, and beliefs of which the parts disagree. decode() reuses the
// storage of `out`; it is false, `out` unspecified, unless the bytes are exactly one well-formed
// message within the bounds. Numbers are taken as they are, also NaN.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "filters/gaussian/codec.hpp"
#include "net/live/envelope.hpp"

namespace hearsay::live {

/// Programs of another protocol are refused.
inline constexpr std::uint32_t protocol = 1;

inline constexpr std::size_t name_bytes_max = 1024;
inline constexpr std::size_t text_bytes_max = 65536;
inline constexpr std::size_t content_bytes_max = std::size_t{32} << 20;
inline constexpr std::size_t numbers_max = 64;  ///< of a state
inline constexpr std::size_t beliefs_max = 65536;
inline constexpr std::size_t rows_max = 65536;
/// Of any sample on any topic.
inline constexpr std::size_t sample_bytes_max = std::size_t{48} << 20;

/// An agent asks to take part.
struct Hello {
  std::uint32_t protocol = live::protocol;
  std::uint32_t agent = 0;
  std::uint64_t process = 0;  ///< differs from process to process
  std::string scenario;       ///< the hash of its configuration
  std::string version;        ///< of the program
  bool remembers = false;     ///< what it knew before it went silent
  bool operator==(const Hello&) const = default;
};

/// The world's answer, to the process that asked.
struct Welcome {
  std::uint32_t agent = 0;
  std::uint64_t process = 0;
  bool accepted = false;
  bool lockstep = false;
  std::uint64_t seed = 0;
  std::int64_t now_ns = 0;
  double speed = 1.0;  ///< simulated seconds a second
  std::string reason;  ///< why not
  bool operator==(const Welcome&) const = default;
};

/// An order to an agent of hearsay's own, or an answer of one.
struct Frame {
  std::uint32_t agent = 0;
  std::uint64_t number = 0;
  std::vector<std::byte> content;
  bool operator==(const Frame&) const = default;
};

struct Clock {
  enum class State : std::uint8_t { waiting, running, ended };
  std::int64_t now_ns = 0;
  std::int64_t end_ns = 0;
  double speed = 1.0;
  State state = State::waiting;
  std::string reason;  ///< why it ended
  bool operator==(const Clock&) const = default;
};

/// What a sensor of the agent says of a subject, as information: ξ and Ω.
struct Measurement {
  std::uint32_t agent = 0;
  std::uint32_t subject = 0;
  std::uint64_t number = 0;
  std::int64_t now_ns = 0;
  gaussian::Belief information;
};

struct Truth {
  std::int64_t now_ns = 0;
  std::uint32_t subject = 0;
  std::vector<double> state;
  bool operator==(const Truth&) const = default;
};

/// What an agent records.
struct Row {
  enum class Kind : std::uint8_t { series, scalar, event };
  Kind kind = Kind::series;
  std::int64_t now_ns = 0;
  std::string name;
  std::string text;
  double value = 0.0;
  bool operator==(const Row&) const = default;
};
struct Counts {
  std::uint64_t measurements = 0;
  std::uint64_t fusions = 0;
  std::uint64_t skipped = 0;
  std::uint64_t refused = 0;
  std::uint64_t late = 0;
  double fusion_gain_max = 0.0;
  bool operator==(const Counts&) const = default;
};
struct Report {
  std::uint32_t agent = 0;
  std::int64_t now_ns = 0;
  bool last = false;
  std::uint64_t missed = 0;  ///< deadlines
  Counts counts;
  std::vector<gaussian::BeliefEntry> beliefs;
  std::vector<Row> rows;
};

void encode(const Hello& message, std::vector<std::byte>& out);
void encode(const Welcome& message, std::vector<std::byte>& out);
void encode(const Frame& message, std::vector<std::byte>& out);
void encode(const Clock& message, std::vector<std::byte>& out);
void encode(const Measurement& message, std::vector<std::byte>& out);
void encode(const Truth& message, std::vector<std::byte>& out);
void encode(const Report& message, std::vector<std::byte>& out);

bool decode(std::span<const std::byte> bytes, Hello& out);
bool decode(std::span<const std::byte> bytes, Welcome& out);
bool decode(std::span<const std::byte> bytes, Frame& out);
bool decode(std::span<const std::byte> bytes, Clock& out);
bool decode(std::span<const std::byte> bytes, Measurement& out);
bool decode(std::span<const std::byte> bytes, Truth& out);
bool decode(std::span<const std::byte> bytes, Report& out);

}  // namespace hearsay::live
