#include "agents/dead_reckoning.hpp"

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {

DeadReckoning::DeadReckoning(Duration memory, Duration step) : memory_(memory), step_(step) {
  require(memory > Duration() && step > Duration(), "dead reckoning: memory and step above 0");
  ring_.resize(static_cast<std::size_t>(memory / step) + 2);
  ring_.front() = now_;
  count_ = 1;
}

void DeadReckoning::drive(Time until, double forward_m_per_s, double turn_rad_per_s, double dt_s) {
  now_ = {until, localization::driven(now_.pose, forward_m_per_s, turn_rad_per_s, dt_s)};
  if (until - kept(count_ - 1).time < step_) return;
  if (count_ == ring_.size()) {
    begin_ = (begin_ + 1) % ring_.size();
    --count_;
  }
  ring_[(begin_ + count_) % ring_.size()] = now_;
  ++count_;
}

std::optional<Eigen::Vector2d> DeadReckoning::behind(Time then) const {
  if (then > now_.time || then < kept(0).time || now_.time - then > memory_) return std::nullopt;
  std::size_t low = 0, high = count_;  // the last kept sample that is not after `then`
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (kept(middle).time <= then ? low : high) = middle;
  }
  const Sample& before = kept(low);
  const Sample& after = low + 1 < count_ ? kept(low + 1) : now_;
  const auto span = static_cast<double>((after.time - before.time).nanoseconds());
  const auto part = static_cast<double>((then - before.time).nanoseconds());
  const double share = span > 0.0 ? part / span : 0.0;
  const double dx = before.pose.x_m + share * (after.pose.x_m - before.pose.x_m) - now_.pose.x_m;
  const double dy = before.pose.y_m + share * (after.pose.y_m - before.pose.y_m) - now_.pose.y_m;
  const double c = math::cos(now_.pose.heading_rad), s = math::sin(now_.pose.heading_rad);
  return Eigen::Vector2d(c * dx + s * dy, c * dy - s * dx);
}

}  // namespace hearsay
