// How well a frame gets over a distance: who is in reach, and how likely one that is there hears.
//
// Three models:
// - disk: everybody within a range hears everything (the unit disk graph).
// - grey zone: everybody within inner_m hears everything; from there the share of frames heard
//   falls linearly to none at outer_m (a quasi unit disk graph, F. Kuhn, R. Wattenhofer,
//   A. Zollinger, Ad-hoc networks beyond unit disk graphs, DIALM-POMC 2003, with a linear fall).
// - log-distance: PL(d) = PL0 + 10 n log10(d/d0) + X dB, where X ~ N(0, σ²) is fixed for a pair of
//   agents and the same both ways (T. S. Rappaport, Wireless communications, 2nd ed. 2002, section
//   4.9). With γ the signal-to-noise ratio as a power ratio, a bit is wrong with probability
//   ½ exp(−γ/1.28) and a frame of B bytes right with (1 − BER)^(8B): non-coherent FSK with a noise
//   bandwidth of 30 kHz at 19.2 kbit/s, no coding (M. Zuniga, B. Krishnamachari, Analyzing the
//   transitional region in low power wireless links, IEEE SECON 2004).
//
// The distance is the caller's: quality() is to be asked once a link and distance.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "net/link_draw.hpp"

namespace hearsay {

struct GreyZone {
  double inner_m = 0.0;  ///< ≥ 0
  double outer_m = 0.0;  ///< > 0, ≥ inner_m; nobody hears from there on
};

struct LogDistance {
  double exponent = 3.0;               ///< n, 1 … 10; 2 in free space
  double reference_loss_db = 46.6777;  ///< PL0 at reference_m, −200 … 200
  double reference_m = 1.0;            ///< d0, > 0; who is nearer is taken to be there
  double shadowing_sigma_db = 0.0;     ///< σ, 0 … 30
  double transmit_dbm = 0.0;           ///< −200 … 200
  double noise_dbm = -105.0;           ///< noise floor, −200 … 200
  /// > 0; nobody hears beyond. Default: where even a shadowing of +3σ leaves a frame of 8 bytes
  /// less than 1 % success.
  std::optional<double> range_m = {};

  static constexpr double reach_sigmas = 3.0;
  static constexpr std::uint32_t reach_frame_bytes = 8;
  static constexpr double reach_success = 0.01;
};

/// What is wrong with the values, as "outer_m must be …"; empty if nothing is.
std::string wrong_with(const GreyZone& zone);
std::string wrong_with(const LogDistance& path);

/// What a link is worth at a distance: all that frame_success() needs.
struct LinkQuality {
  double success = 1.0;          ///< of a frame of any length, before log_bit_success
  double log_bit_success = 0.0;  ///< ln(1 − BER), ≤ 0
  double snr_db = std::numeric_limits<double>::infinity();  ///< infinite but for log-distance
};

/// The frames of a packet as they are on the air, headers included.
struct FrameSizes {
  std::uint32_t frames = 1;
  std::uint32_t frame_bytes = 0;  ///< of each but the last
  std::uint32_t last_bytes = 0;   ///< of the last
  std::uint32_t bytes(std::uint32_t frame) const {
    return frame + 1 < frames ? frame_bytes : last_bytes;
  }
};

class Propagation {
 public:
  /// Distance does not matter: a disk without end.
  Propagation() = default;
  /// @throws InputError unless 0 < range_m < ∞. Somebody at range_m hears.
  static Propagation disk(double range_m);
  /// @throws InputError with what is wrong_with(zone).
  static Propagation grey_zone(const GreyZone& zone);
  /// @throws InputError with what is wrong_with(path).
  static Propagation log_distance(const LogDistance& path);

  /// True of a disk: whoever is within reach hears every frame, so that nobody need ask.
  bool certain() const { return model_ == Model::disk; }
  /// True of log-distance: powers are those of the radio, and jammers have a power, too.
  bool has_powers() const { return model_ == Model::log_distance; }
  /// Nobody beyond hears anything or counts as a potential receiver. Infinite without a model.
  double reach_m() const { return reach_m_; }

  /// X of the pair, the same for (a, b) and (b, a): the draw named (seed, "shadowing", pair). 0 but
  /// for log-distance. The path loss grows by it.
  double shadowing_db(std::uint64_t seed, AgentId a, AgentId b) const;

  /// Of a link over `distance_m` ≥ 0. `interference_mw` ≥ 0 comes on top of the noise floor; it has
  /// an effect on log-distance alone.
  LinkQuality quality(double distance_m, double shadowing_db = 0.0,
                      double interference_mw = 0.0) const;

  /// What is lost on the way, in dB, without shadowing. For disk and grey zone, which know no
  /// powers, 20 log10(d) from 1 m on.
  double path_loss_db(double distance_m) const;

  /// Power at the receiver, to compare senders with. For disk and grey zone a sender has
  /// 0 dBm: differences of it have a meaning, values have none.
  double received_dbm(double distance_m, double shadowing_db = 0.0) const;

 private:
  enum class Model : std::uint8_t { disk, grey_zone, log_distance };
  Model model_ = Model::disk;
  double reach_m_ = std::numeric_limits<double>::infinity();
  GreyZone zone_;
  LogDistance path_;
  double noise_mw_ = 0.0;
};

/// Probability that a frame of so many bytes is heard.
double frame_success(const LinkQuality& quality, std::uint32_t frame_bytes);

/// Whether frame `frame` (from 0) of the packet, of so many bytes, is heard: the draw named (seed,
/// "reception of a tick" or "… packet", link, index), uniform `frame`, is below its success. Costs
/// grow with `frame`. No draw is made where success is 0 or 1.
bool frame_heard(const LinkQuality& quality, const PacketOnLink& packet, std::uint32_t frame,
                 std::uint32_t frame_bytes);

/// The same of frame 0, of which the success is known.
bool first_frame_heard(double success, const PacketOnLink& packet);

/// Whether all frames of the packet are heard.
/// @throws BrokenInvariant for more than frames_max frames.
bool packet_heard(const LinkQuality& quality, const PacketOnLink& packet, const FrameSizes& sizes);

/// 10^(dbm/10), and back; mw > 0.
double mw_of_dbm(double dbm);
double dbm_of_mw(double mw);

}  // namespace hearsay
