// What can be set about radios: transmitter, channel, sharing, acknowledgements.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "net/access.hpp"
#include "net/faults.hpp"
#include "net/loss.hpp"
#include "net/propagation.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// What a transmitter does with a packet that finds its queue full.
enum class QueuePolicy : std::uint8_t {
  drop_new,     ///< drops it
  drop_oldest,  ///< drops the one that has waited longest
  /// As drop_new; but a packet of the kind, receiver and subject of one that waits always takes the
  /// place of that one, full or not: it is news of the same thing.
  replace,
};

struct QueueOptions {
  std::uint32_t packets_max = 64;          ///< waiting or being sent, ≥ 1
  std::optional<std::uint64_t> bytes_max;  ///< waiting or being sent, with headers, ≥ 1
  QueuePolicy policy = QueuePolicy::drop_new;
  /// A packet that has waited longer is not sent but expired, > 0.
  std::optional<Duration> wait_max;
};

/// Latency beside the constant one, drawn for each packet and link.
struct JitterOptions {
  enum class Law : std::uint8_t { none, uniform, exponential };
  Law law = Law::none;
  Duration spread;         ///< uniform: the most; exponential: the mean; ≥ 0
  bool reordering = true;  ///< false: a packet waits for those before it on its link
};

/// Repetition of addressed packets until they are acknowledged (Outgoing::acknowledged).
struct AcknowledgementOptions {
  std::uint32_t bytes = 14;  ///< of an acknowledgement on the air, ≥ 1
  Duration interframe;       ///< from a packet's arrival to its acknowledgement, ≥ 0
  int attempts_max = 7;      ///< 1 … 1000
};

struct RadioOptions {
  double rate_bps = 1e6;           ///< bits a second, > 0, finite
  std::uint32_t header_bytes = 0;  ///< added to each frame
  /// The most of a packet that a frame takes, without header, ≥ 1; none: a packet is one frame.
  std::optional<std::uint32_t> mtu_bytes;
  QueueOptions queue;
  bool half_duplex = false;  ///< who sends does not hear
  AccessOptions access;
  /// Where the channel is shared: a frame this much stronger than another survives, in dB;
  /// infinite: none does. A finite ratio needs positions.
  double capture_db = std::numeric_limits<double>::infinity();
  Duration latency;  ///< ≥ 0, from the last bit sent to arrival
  JitterOptions jitter;
  Loss loss;
  /// Who is in reach, and hears. Models other than a disk without end need positions; the topology
  /// joins whoever is within their reach.
  Propagation propagation;
  std::vector<Jammer> jammers;  ///< need positions
  /// > 0; the way to a hearer takes link length / speed more, to the nearest nanosecond. Infinite:
  /// no time. A finite speed needs positions.
  double propagation_m_per_s = std::numeric_limits<double>::infinity();
  AcknowledgementOptions acknowledgement;
  bool count_links = false;  ///< fates are counted a link, too
};

/// @throws InputError for an option outside its range; the message names it.
void check(const RadioOptions& options);

}  // namespace hearsay
