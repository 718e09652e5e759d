#include "net/faults.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <tuple>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

constexpr Purpose dropout("dropout");

template <class... Parts>
std::string text_of(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

void refuse(const std::string& what, const std::string& wrong) {
  if (!wrong.empty()) throw InputError(what + ": " + wrong);
}

bool positive(double value) { return value > 0.0 && std::isfinite(value); }

// Of a random time: at least a nanosecond, so that outages are never empty nor touch, and in reach
// of the clock.
Duration span_of(double s) {
  return std::max(Duration::nanoseconds(1), Duration::seconds(std::min(s, 9e9)));
}

Time later(Time time, Duration span) {
  return span < Time::never() - time ? time + span : Time::never();
}

// Takes `outage` in if it overlaps or touches.
bool joined(Outage& into, const Outage& outage) {
  if (into.agent != outage.agent || outage.from > into.until) return false;
  into.until = std::max(into.until, outage.until);
  into.forgets |= outage.forgets;
  return true;
}

}  // namespace

std::vector<Outage> merged(std::vector<Outage> outages) {
  std::sort(outages.begin(), outages.end(), [](const Outage& a, const Outage& b) {
    return std::tie(a.agent, a.from) < std::tie(b.agent, b.from);
  });
  std::vector<Outage> out;
  for (const Outage& outage : outages) {
    if (outage.until <= outage.from) continue;
    if (out.empty() || !joined(out.back(), outage)) out.push_back(outage);
  }
  return out;
}

std::string wrong_with(const Outage& outage) {
  const double from_s = outage.from.seconds();
  if (outage.from < Time()) return text_of("from_s must be at least 0, not ", from_s);
  if (outage.until > outage.from) return {};
  return text_of("until_s must be after from_s (", from_s, "), not ", outage.until.seconds());
}

std::string wrong_with(const OutageRate& rate) {
  const auto not_positive = [](const char* name, double found) {
    return text_of(name, " must be positive and finite, not ", found);
  };
  if (!positive(rate.mean_up_s)) return not_positive("mean_up_s", rate.mean_up_s);
  if (rate.mean_down_s && !positive(*rate.mean_down_s)) {
    return not_positive("mean_down_s", *rate.mean_down_s);
  }
  if (rate.outages_max > OutageRate{}.outages_max) {
    return text_of("outages_max must be at most 2^47, not ", rate.outages_max);
  }
  return {};
}

Dropouts::Dropouts(Options options) : seed_(options.seed), end_(options.end) {
  const auto name = [](AgentId agent) { return "dropouts of agent " + std::to_string(agent); };
  for (const Outage& outage : options.schedule) refuse(name(outage.agent), wrong_with(outage));
  for (const OutageRate& rate : options.rates) refuse(name(rate.agent), wrong_with(rate));
  planned_ = merged(std::move(options.schedule));
  std::stable_sort(options.rates.begin(), options.rates.end(),
                   [](const OutageRate& a, const OutageRate& b) { return a.agent < b.agent; });
  for (const Outage& outage : planned_) agents_.push_back(outage.agent);
  for (const OutageRate& rate : options.rates) agents_.push_back(rate.agent);
  std::sort(agents_.begin(), agents_.end());
  agents_.erase(std::unique(agents_.begin(), agents_.end()), agents_.end());

  std::size_t planned = 0;
  for (const AgentId agent : agents_) {
    first_planned_.push_back(planned);
    while (planned < planned_.size() && planned_[planned].agent == agent) ++planned;
    first_source_.push_back(sources_.size());
    std::uint32_t cause = 0;
    for (std::size_t i = sources_.size();
         i < options.rates.size() && options.rates[i].agent == agent; ++i) {
      sources_.push_back({options.rates[i], Entity::sensor(agent, cause++)});
    }
  }
  planned_at_ = first_planned_;
  first_planned_.push_back(planned);
  first_source_.push_back(sources_.size());
  heads_.resize(sources_.size());
  for (std::size_t i = 0; i < sources_.size(); ++i) advance(sources_[i], heads_[i]);
}

// Draws the source's next outage.
void Dropouts::advance(Source& source, std::optional<Outage>& head) const {
  head.reset();
  if (source.made >= source.rate.outages_max) return;
  Stream draws = Stream::at(seed_, dropout, source.entity, source.made++);
  const OutageRate& rate = source.rate;
  Outage outage{.agent = rate.agent, .forgets = rate.forgets};
  outage.from = later(source.up_since, span_of(draws.exponential(1.0 / rate.mean_up_s)));
  if (outage.from >= end_) return;
  if (rate.mean_down_s) {
    outage.until = later(outage.from, span_of(draws.exponential(1.0 / *rate.mean_down_s)));
  }
  source.up_since = outage.until;
  head = outage;
}

// The earliest of what the agent's causes have next, if it begins by `latest`.
std::optional<Outage> Dropouts::take_first(std::size_t row, Time latest) {
  std::optional<Outage>* head = nullptr;
  for (std::size_t i = first_source_[row]; i < first_source_[row + 1]; ++i) {
    if (heads_[i] && (!head || heads_[i]->from < (*head)->from)) head = &heads_[i];
  }
  std::size_t& at = planned_at_[row];
  const bool plan = at < first_planned_[row + 1] && (!head || planned_[at].from < (*head)->from);
  if (!plan && !head) return std::nullopt;
  const Outage first = plan ? planned_[at] : **head;
  if (first.from > latest || first.from >= end_) return std::nullopt;
  if (plan) {
    ++at;
  } else {
    const auto i = static_cast<std::size_t>(head - heads_.data());
    advance(sources_[i], heads_[i]);
  }
  return first;
}

std::optional<Outage> Dropouts::next(AgentId agent) {
  const auto found = std::lower_bound(agents_.begin(), agents_.end(), agent);
  if (found == agents_.end() || *found != agent) return std::nullopt;
  const auto row = static_cast<std::size_t>(found - agents_.begin());
  std::optional<Outage> outage = take_first(row, Time::never());
  while (outage && outage->until != Time::never()) {
    const std::optional<Outage> more = take_first(row, outage->until);
    if (!more) return outage;
    joined(*outage, *more);
  }
  no_more(row);
  return outage;
}

// After a death.
void Dropouts::no_more(std::size_t row) {
  planned_at_[row] = first_planned_[row + 1];
  for (std::size_t i = first_source_[row]; i < first_source_[row + 1]; ++i) heads_[i].reset();
}

std::string wrong_with(const Jammer& jammer) {
  if (jammer.radius_m.has_value() == jammer.power_dbm.has_value()) {
    return "needs either radius_m or power_dbm";
  }
  if (jammer.radius_m && !positive(*jammer.radius_m)) {
    return text_of("radius_m must be positive and finite, not ", *jammer.radius_m);
  }
  if (jammer.power_dbm && !(std::fabs(*jammer.power_dbm) <= 200.0)) {
    return text_of("power_dbm must be between -200 and 200, not ", *jammer.power_dbm);
  }
  for (const double x : jammer.position_m) {
    if (!std::isfinite(x)) return text_of("position_m must be finite, not ", x);
  }
  const std::string times = wrong_with(Outage{.from = jammer.from, .until = jammer.until});
  if (!times.empty()) return times;
  if (jammer.period < Duration()) {
    return text_of("period_s must be at least 0, not ", jammer.period.seconds());
  }
  if (jammer.duty > 0.0 && jammer.duty <= 1.0) return {};
  return text_of("duty must be in (0, 1], not ", jammer.duty);
}

bool is_on(const Jammer& jammer, Time from, Time until) {
  const Time begin = std::max(from, jammer.from);
  const Time end = std::min(std::max(until, later(from, Duration::nanoseconds(1))), jammer.until);
  if (begin >= end) return false;
  if (jammer.period <= Duration()) return true;
  const Duration since = (begin - jammer.from) % jammer.period;
  const Duration pulse = span_of(jammer.period.seconds() * jammer.duty);
  return since < pulse || jammer.period - since < end - begin;
}

Jammers::Jammers(std::vector<Jammer> jammers) : jammers_(std::move(jammers)) {
  for (std::size_t i = 0; i < jammers_.size(); ++i) {
    refuse("jammer " + std::to_string(i), wrong_with(jammers_[i]));
  }
}

bool Jammers::jams(const Point& receiver_m, Time from, Time until) const {
  return std::any_of(jammers_.begin(), jammers_.end(), [&](const Jammer& jammer) {
    return jammer.radius_m &&
           squared_distance_m2(jammer.position_m, receiver_m) <=
               *jammer.radius_m * *jammer.radius_m &&
           is_on(jammer, from, until);
  });
}

double Jammers::interference_mw(const Point& receiver_m, Time from, Time until,
                                const Propagation& propagation) const {
  double sum_mw = 0.0;
  for (const Jammer& jammer : jammers_) {
    if (!jammer.power_dbm) continue;
    require(propagation.has_powers(), "a jammer with a power needs a propagation with powers");
    if (!is_on(jammer, from, until)) continue;
    const double distance_m = std::sqrt(squared_distance_m2(jammer.position_m, receiver_m));
    sum_mw += mw_of_dbm(*jammer.power_dbm - propagation.path_loss_db(distance_m));
  }
  return sum_mw;
}

}  // namespace hearsay
