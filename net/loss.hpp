// What the channel loses though it is in range: nothing, each frame by chance (Bernoulli), or in
// bursts (Gilbert–Elliott).
//
// Draws are keyed (net/link_draw.hpp). A packet is lost if any of its frames is, so under another
// rule with longer messages at least the same packets are lost.
//
// Gilbert–Elliott (E. N. Gilbert, Capacity of a burst-noise channel, Bell System Technical Journal
// 39, 1960; E. O. Elliott, ibid. 42, 1963): a chain of two states makes one step a packet's index
// and loses frames with a probability that depends on the state. The state at index i is a function
// of (seed, link, numbering, i) alone, found by looking backwards: with u the uniform of step i,
//   after good: bad if u < p;   after bad: bad if u < 1 − r,
// so u decides alone unless it lies between p and 1 − r; there the state stays (p < 1 − r) or
// changes (p > 1 − r), and the step before is asked. At index 0 the state has its stationary law:
// bad if u < p/(p + r). No link has memory, any index may be asked in any order, and indices that
// nobody asks for are steps all the same. The state is decided d steps back with probability
// |1 − p − r|^d, so it takes 1/min(p + r, 2 − p − r) draws on average: about the length of a burst.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "net/link_draw.hpp"

namespace hearsay {

/// A Gilbert–Elliott channel. The state changes once an index.
struct GilbertElliott {
  /// p + r must be in [this, 2 − this]: it bounds the draws a packet costs, and a chain with
  /// p = r = 1 would alternate for ever.
  static constexpr double slowest = 1e-6;

  double good_to_bad = 0.0;  ///< p, in [0, 1]
  double bad_to_good = 1.0;  ///< r, in (0, 1]; bursts of the bad state last 1/r indices on average
  double loss_good = 0.0;    ///< of a frame in the good state, in [0, 1]
  double loss_bad = 1.0;     ///< of a frame in the bad state, in [0, 1]

  /// Stationary probability of the bad state: p/(p + r).
  double share_bad() const { return good_to_bad / (good_to_bad + bad_to_good); }
  /// Stationary probability that a packet of one frame is lost.
  double loss_rate() const;
};

/// What is wrong with the values, as "bad_to_good must be above 0, not …"; empty if nothing is.
std::string wrong_with(const GilbertElliott& chain);

/// A channel by what it does: how much it loses, and for how long it stays bad.
struct BurstLoss {
  double loss_rate = 0.0;   ///< stationary, of packets of one frame; loss_good … below loss_bad
  double mean_burst = 1.0;  ///< mean stay in the bad state, in indices, 1 … 1e6
  double loss_good = 0.0;   ///< as in GilbertElliott
  double loss_bad = 1.0;    ///< as in GilbertElliott; above loss_good
};

/// As above. Not every combination exists: since p ≤ 1, a share b of bad states needs
/// mean_burst ≥ b/(1 − b).
std::string wrong_with(const BurstLoss& loss);

/// r = 1/mean_burst, and p such that the stationary loss is loss_rate.
/// @throws InputError with what is wrong_with(loss) or with the chain.
GilbertElliott chain_of(const BurstLoss& loss);

/// The loss of one directed link.
struct LinkLoss {
  AgentId from = no_agent;
  AgentId to = no_agent;
  double probability = 0.0;  ///< [0, 1]
};

class Loss {
 public:
  /// Nothing is lost.
  Loss() = default;

  /// Each frame is lost with `probability`, on the links listed in `links` with theirs instead.
  /// @throws InputError for a probability outside [0, 1] or a link that is listed twice.
  static Loss bernoulli(double probability, std::vector<LinkLoss> links = {});

  /// @throws InputError with what is wrong_with(chain).
  static Loss gilbert_elliott(const GilbertElliott& chain);

  /// True if nothing is ever lost, so that nobody need ask.
  bool never() const { return model_ == Model::none; }

  /// Whether the packet, of `frames` frames, is lost on its link.
  /// @throws BrokenInvariant for an index of 2^48 or more, or more than frames_max frames.
  bool lost(const PacketOnLink& packet, std::uint32_t frames = 1) const {
    if (plain_ && frames == 1) [[likely]] {
      return first_frame_draw(packet, draws) < probability_;
    }
    return any_lost(packet, frames);
  }

  /// Whether the Gilbert–Elliott channel is in its bad state then; false in other models.
  bool bad(const PacketOnLink& packet) const;

 private:
  enum class Model : std::uint8_t { none, bernoulli, gilbert_elliott };
  // The first frame's draw is the one that packets have had before there were frames.
  static constexpr PurposeOnLink draws{Purpose("loss of a tick"), Purpose("loss of a packet"),
                                       Purpose("loss of a repetition")};
  // By value, so that who asks many times in a row may keep the packet in registers.
  bool any_lost(PacketOnLink packet, std::uint32_t frames) const;
  double frame_loss(const PacketOnLink& packet) const;

  Model model_ = Model::none;
  bool plain_ = false;           // Bernoulli, the same on all links
  double probability_ = 0.0;     // Bernoulli
  std::vector<LinkLoss> links_;  // Bernoulli, sorted by (from, to)
  GilbertElliott chain_;
};

}  // namespace hearsay
