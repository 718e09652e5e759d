#include "agents/trails/trail_estimator.hpp"

#include <optional>

namespace hearsay {

TrailEstimator::TrailEstimator(const Options& options)
    : options_(options),
      store_(options.store, {.cell_m = options.cell_m}),
      return_(options.interval_s),
      temporary_({.interval_s = options.interval_s, .crumbs_max = options.trail_crumbs_max}),
      numbers_(options.store.robot) {}

void TrailEstimator::merge(const trails::Crumb& crumb, double now_s) {
  store_.merge(crumb, now_s, options_.store.robot);
  ++counts_.laid;
}

std::span<const trails::Crumb> TrailEstimator::visit(trails::EventId event, const trails::Point& at,
                                                     double now_s, double way) {
  store_.merge(trails::Place{event, at, now_s, numbers_.take()}, now_s);
  places_changed_ = true;
  if (options_.laying == trails::Laying::at_once) {
    return_.visit(event, way);
    return {};
  }
  const auto crumbs = temporary_.complete(event, way, numbers_);
  for (const trails::Crumb& crumb : crumbs) merge(crumb, now_s);
  return crumbs;
}

trails::Laid TrailEstimator::lay(double now_s, const trails::Point& at, double way,
                                 trails::EventId goal) {
  if (options_.laying == trails::Laying::completed) {
    const trails::Laid laid = temporary_.lay(now_s, at, way);
    if (laid == trails::Laid::abandoned) ++counts_.abandoned;
    return laid;
  }
  const auto crumb =
      return_.lay(now_s, at, way, options_.names_goal ? goal : trails::no_event, numbers_);
  if (!crumb) return trails::Laid::nothing;
  laid_ = *crumb;
  merge(laid_, now_s);
  return trails::Laid::crumb;
}

void TrailEstimator::carried() {
  temporary_.clear();
  return_ = trails::ReturnTrail<trails::Point>(options_.interval_s);
}

void TrailEstimator::forget() {
  store_.clear();
  carried();
  numbers_ = trails::Numbering(options_.store.robot, ++incarnation_);
  messages_ = 0;
  places_changed_ = false;
}

std::span<const trails::Identity> TrailEstimator::heard(std::span<const std::byte> bytes,
                                                        double now_s) {
  taken_.clear();
  const auto packet = trails::MetricPacket::parse(bytes);
  if (!packet) {
    ++counts_.refused;
    return taken_;
  }
  heard_from_ = packet->head().sender;
  places_.clear();
  for (std::size_t i = 0; i < packet->places(); ++i) places_.push_back(packet->place(i));
  trails::Similarity map;
  if (!options_.as_is) {
    common_places(places_, store_.places(), pairs_);
    const auto alignment = align(pairs_, options_.align);
    if (!alignment) {
      ++counts_.no_frame;
      return taken_;
    }
    map = alignment->map;
  }
  for (const trails::Place& place : places_) {
    places_changed_ |= store_.merge(mapped(place, map), now_s) && options_.relay;
  }
  for (std::size_t i = 0; i < packet->crumbs(); ++i) {
    const trails::Crumb crumb = mapped(packet->crumb(i), map);
    ++counts_.heard;
    const auto fate = store_.merge(crumb, now_s, heard_from_);
    if (fate == trails::Fate::taken) taken_.push_back(crumb.identity);
  }
  return taken_;
}

std::span<const std::vector<std::byte>> TrailEstimator::speech(double now_s) {
  news_.clear();
  store_.news(told_, {.own_only = !options_.relay, .crumbs_max = trails::packet_crumbs_max}, now_s,
              news_);
  if (news_.empty() && !places_changed_) return {};
  places_changed_ = false;
  return encoder_.encode({.sender = options_.store.robot,
                          .incarnation = incarnation_,
                          .count = messages_++,
                          .places = store_.places(),
                          .crumbs = news_},
                         options_.packet_bytes);
}

}  // namespace hearsay
