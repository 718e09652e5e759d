#include "net/loss.hpp"

#include <algorithm>
#include <sstream>
#include <tuple>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr PurposeOnLink state{Purpose("state of the channel at a tick"),
                              Purpose("state of the channel at a packet"),
                              Purpose("not drawn: the state is the first attempt's")};

template <class... Parts>
std::string text_of(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

bool is_probability(double p) { return p >= 0.0 && p <= 1.0; }

std::string outside(const std::string& name, double found) {
  return text_of(name, " must be in [0, 1], not ", found);
}

std::string wrong_with_states(double loss_good, double loss_bad) {
  if (!is_probability(loss_good)) return outside("loss_good", loss_good);
  if (!is_probability(loss_bad)) return outside("loss_bad", loss_bad);
  return {};
}

void refuse(const std::string& wrong) {
  if (!wrong.empty()) throw InputError("loss: " + wrong);
}

double share_bad(const BurstLoss& burst) {
  return (burst.loss_rate - burst.loss_good) / (burst.loss_bad - burst.loss_good);
}

bool before(const LinkLoss& a, const LinkLoss& b) {
  return std::tie(a.from, a.to) < std::tie(b.from, b.to);
}

}  // namespace

double GilbertElliott::loss_rate() const {
  return loss_good + share_bad() * (loss_bad - loss_good);
}

std::string wrong_with(const GilbertElliott& chain) {
  const double p = chain.good_to_bad;
  const double r = chain.bad_to_good;
  if (!is_probability(p)) return outside("good_to_bad", p);
  if (!(r > 0.0 && r <= 1.0)) return text_of("bad_to_good must be in (0, 1], not ", r);
  const double least = GilbertElliott::slowest;
  if (!(p + r >= least && p + r <= 2.0 - least)) {
    return text_of("good_to_bad + bad_to_good must be between ", least, " and 2 − ", least,
                   ", not ", p, " + ", r);
  }
  return wrong_with_states(chain.loss_good, chain.loss_bad);
}

std::string wrong_with(const BurstLoss& burst) {
  const std::string states = wrong_with_states(burst.loss_good, burst.loss_bad);
  if (!states.empty()) return states;
  if (!(burst.loss_good < burst.loss_bad)) {
    return text_of("loss_good must be below loss_bad (", burst.loss_bad, "), not ",
                   burst.loss_good);
  }
  const double longest = 1.0 / GilbertElliott::slowest;
  if (!(burst.mean_burst >= 1.0 && burst.mean_burst <= longest)) {
    return text_of("mean_burst must be between 1 and ", longest, " packets, not ",
                   burst.mean_burst);
  }
  if (!(burst.loss_rate >= burst.loss_good && burst.loss_rate < burst.loss_bad)) {
    return text_of("the loss rate must be at least loss_good (", burst.loss_good,
                   ") and below loss_bad (", burst.loss_bad, "), not ", burst.loss_rate);
  }
  const double b = share_bad(burst);
  constexpr double rounding = 1e-12;  // 0.9 / (1 − 0.9) is a little more than 9
  if (burst.mean_burst < b / (1.0 - b) * (1.0 - rounding)) {
    return text_of("a loss rate of ", burst.loss_rate, " needs a mean_burst of at least ",
                   b / (1.0 - b), " packets, not ", burst.mean_burst);
  }
  return {};
}

GilbertElliott chain_of(const BurstLoss& burst) {
  refuse(wrong_with(burst));
  const double b = share_bad(burst);
  const double r = 1.0 / burst.mean_burst;
  const GilbertElliott chain{.good_to_bad = std::min(1.0, r * b / (1.0 - b)),
                             .bad_to_good = r,
                             .loss_good = burst.loss_good,
                             .loss_bad = burst.loss_bad};
  refuse(wrong_with(chain));
  return chain;
}

Loss Loss::bernoulli(double probability, std::vector<LinkLoss> links) {
  if (!is_probability(probability)) refuse(outside("probability", probability));
  std::sort(links.begin(), links.end(), before);
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto& [from, to, p] = links[i];
    const std::string link = text_of("link ", from, " → ", to);
    if (!is_probability(p)) refuse(outside("probability of " + link, p));
    if (i > 0 && !before(links[i - 1], links[i])) refuse(link + " is listed twice");
  }
  Loss made;
  made.model_ = probability > 0.0 || !links.empty() ? Model::bernoulli : Model::none;
  made.plain_ = made.model_ == Model::bernoulli && links.empty();
  made.probability_ = probability;
  made.links_ = std::move(links);
  return made;
}

Loss Loss::gilbert_elliott(const GilbertElliott& chain) {
  refuse(wrong_with(chain));
  Loss made;
  made.model_ = Model::gilbert_elliott;
  made.chain_ = chain;
  return made;
}

bool Loss::bad(const PacketOnLink& packet) const {
  if (model_ != Model::gilbert_elliott) return false;
  const double p = chain_.good_to_bad;
  const double stays_bad = 1.0 - chain_.bad_to_good;
  const double low = std::min(p, stays_bad);
  const double high = std::max(p, stays_bad);
  const bool changes = p > stays_bad;  // what a u in between does to the state before
  const Purpose purpose = state.of(packet.numbering);
  bool odd = false;
  for (std::uint64_t i = packet.index;; --i) {
    const double u = Stream::uniform_at(packet.seed, purpose, packet.link(), i);
    if (i == 0) return (u < chain_.share_bad()) != odd;
    if (u < low || u >= high) return (u < low) != odd;
    odd ^= changes;
  }
}

double Loss::frame_loss(const PacketOnLink& packet) const {
  if (model_ == Model::none) return 0.0;
  if (model_ == Model::gilbert_elliott) return bad(packet) ? chain_.loss_bad : chain_.loss_good;
  if (links_.empty()) return probability_;
  const LinkLoss wanted{packet.from, packet.to, 0.0};
  const auto at = std::lower_bound(links_.begin(), links_.end(), wanted, before);
  return at == links_.end() || before(wanted, *at) ? probability_ : at->probability;
}

bool Loss::any_lost(PacketOnLink packet, std::uint32_t frames) const {
  require(frames <= frames_max, "loss: a packet has too many frames");
  const double p = frame_loss(packet);
  if (p <= 0.0 || frames == 0) return false;
  if (p >= 1.0) return true;
  if (first_frame_draw(packet, draws) < p) return true;
  if (frames == 1) return false;
  FrameDraws of_frames(packet, draws);
  for (std::uint32_t f = 0; f < frames; ++f) {
    if (of_frames.next() < p) return true;
  }
  return false;
}

}  // namespace hearsay
