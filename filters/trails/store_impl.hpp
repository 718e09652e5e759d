// The functions of TrailStore. Included by store.hpp.
#pragma once

#include "filters/trails/store.hpp"

namespace hearsay::trails {

template <LocalizationSpace S>
TrailStore<S>::TrailStore(const StoreOptions& options, const typename S::Options& space)
    : options_(options), index_(space) {
  require(options.crumbs_max >= 1 && options.crumbs_max < none, "trail store: room for a crumb");
  require(options.events_max >= 1, "trail store: room for an event");
  require(options.age_max_s >= 0.0, "trail store: the age limit is at least 0");
  require(options.life_arrivals >= 0 && options.life_arrivals <= static_cast<int>(arrivals_most),
          "trail store: a life of 0 … 64 arrivals");
  require(options.ahead_max_s >= 0.0, "trail store: clocks differ by at least 0");
}

template <LocalizationSpace S>
void TrailStore<S>::advance(double now_s) {
  require(std::isfinite(now_s) && now_s >= now_s_, "trail store: time does not go back");
  now_s_ = now_s;
  for (Event& event : events_) {
    while (!event.heap.empty() && outlived(slots_[event.heap.front()].crumb, &event)) {
      remove_oldest(event);
      ++counts_.vanished;
    }
  }
}

template <LocalizationSpace S>
bool TrailStore<S>::outlived(const Crumb& crumb, const Event* event) const {
  if (now_s_ - crumb.created_s > options_.age_max_s) return true;
  const auto life = static_cast<std::size_t>(options_.life_arrivals);
  // As many later arrivals as a life has: the first of the latest `life` is later than the crumb.
  return life > 0 && event != nullptr && event->arrivals.size() == life &&
         event->arrivals.front().created_s > crumb.created_s;
}

template <LocalizationSpace S>
double TrailStore<S>::worn(const Crumb& crumb) const {
  double share =
      std::isfinite(options_.age_max_s) ? (now_s_ - crumb.created_s) / options_.age_max_s : 0.0;
  if (options_.life_arrivals > 0) {
    const auto event = std::lower_bound(events_.begin(), events_.end(), crumb.event,
                                        [](const Event& e, EventId n) { return e.event < n; });
    if (event != events_.end() && event->event == crumb.event) {
      const auto since =
          std::count_if(event->arrivals.begin(), event->arrivals.end(),
                        [&](const Age& arrival) { return arrival.created_s > crumb.created_s; });
      share = std::max(share, static_cast<double>(since) / options_.life_arrivals);
    }
  }
  return std::clamp(share, 0.0, 1.0);
}

template <LocalizationSpace S>
bool TrailStore<S>::sound(const Crumb& crumb) const {
  return crumb.event != no_event && crumb.distance_s >= 0.0F && std::isfinite(crumb.distance_s) &&
         std::isfinite(crumb.created_s) && crumb.created_s <= now_s_ + options_.ahead_max_s &&
         S::sound(crumb.position);
}

template <LocalizationSpace S>
Fate TrailStore<S>::fate_of(const Crumb& crumb) {
  if (!sound(crumb)) return Fate::refused;
  if (outlived(crumb, find(crumb.event))) return Fate::late;
  if (table_.find(crumb.identity)) return Fate::known;
  const Age age = age_of(crumb);
  if (floor_ && age <= *floor_) return Fate::no_room;
  if (find(crumb.event) == nullptr && events_.size() == options_.events_max) return Fate::no_room;
  if (size() < options_.crumbs_max) return Fate::taken;
  Event& event = oldest();
  const Age least = age_of(slots_[event.heap.front()].crumb);
  floor_ = std::min(age, least);
  if (age < least) return Fate::no_room;
  remove_oldest(event);
  ++counts_.dropped;
  return Fate::taken;
}

template <LocalizationSpace S>
Fate TrailStore<S>::merge(const Crumb& crumb, double now_s, RobotId from) {
  advance(now_s);
  const Fate fate = fate_of(crumb);
  switch (fate) {
    case Fate::taken:
      insert(crumb, from, *find_or_add(crumb.event));
      ++counts_.taken;
      break;
    case Fate::known:
      ++counts_.known;
      break;
    case Fate::late:
      ++counts_.late;
      break;
    case Fate::no_room:
      ++counts_.no_room;
      break;
    case Fate::refused:
      ++counts_.refused;
      break;
  }
  return fate;
}

template <LocalizationSpace S>
bool TrailStore<S>::merge(const Place& place, double now_s) {
  advance(now_s);
  if (place.event == no_event || !std::isfinite(place.time_s) || !S::sound(place.position) ||
      place.time_s > now_s_ + options_.ahead_max_s) {
    return false;
  }
  Event* const event = find_or_add(place.event);
  if (event == nullptr) return false;
  const Age age{place.time_s, place.identity};
  if (const auto life = static_cast<std::size_t>(options_.life_arrivals); life > 0) {
    const auto at = std::lower_bound(event->arrivals.begin(), event->arrivals.end(), age);
    if (at == event->arrivals.end() || *at != age) {
      event->arrivals.insert(at, age);
      if (event->arrivals.size() > life) event->arrivals.erase(event->arrivals.begin());
      advance(now_s);
    }
  }
  const auto at =
      std::lower_bound(places_.begin(), places_.end(), place.event,
                       [](const Place& known, EventId number) { return known.event < number; });
  if (at == places_.end() || at->event != place.event) {
    places_.insert(at, place);
    return true;
  }
  if (age <= Age{at->time_s, at->identity}) return false;
  *at = place;
  return true;
}

template <LocalizationSpace S>
void TrailStore<S>::clear() {
  for (std::uint32_t slot = first_; slot != none; slot = slots_[slot].next) {
    index_.remove(slot);
    table_.erase(slots_[slot].crumb.identity);
    free_.push_back(slot);
  }
  first_ = last_ = none;
  events_.clear();
  places_.clear();
  floor_.reset();
}

template <LocalizationSpace S>
auto TrailStore<S>::best(EventId event, const Reach& reach, double now_s) -> const Crumb* {
  advance(now_s);
  const Crumb* found = nullptr;
  index_.visit(event, reach, [&](std::uint32_t slot) {
    const Crumb& crumb = slots_[slot].crumb;
    if (found == nullptr || follows_before(crumb, *found)) found = &crumb;
  });
  return found;
}

template <LocalizationSpace S>
void TrailStore<S>::within(EventId event, const Reach& reach, double now_s,
                           std::vector<Crumb>& out) {
  advance(now_s);
  out.clear();
  const auto take = [&](std::uint32_t slot) { out.push_back(slots_[slot].crumb); };
  if (event != no_event) {
    index_.visit(event, reach, take);
  } else {
    for (const Event& each : events_) index_.visit(each.event, reach, take);
  }
  std::sort(out.begin(), out.end(), follows_before<Position>);
}

template <LocalizationSpace S>
auto TrailStore<S>::opposing(EventId goal, const Reach& reach, double now_s) -> const Crumb* {
  advance(now_s);
  const Crumb* found = nullptr;
  const auto compare = [&](std::uint32_t slot) {
    const Crumb& crumb = slots_[slot].crumb;
    if (crumb.goal == no_event || crumb.goal == goal) return;
    if (found == nullptr || age_of(*found) < age_of(crumb)) found = &crumb;
  };
  for (const Event& event : events_) index_.visit(event.event, reach, compare);
  return found;
}

template <LocalizationSpace S>
void TrailStore<S>::news(Cursor& cursor, const News& what, double now_s, std::vector<Crumb>& out) {
  advance(now_s);
  std::uint32_t slot = none;
  for (std::uint32_t s = last_; s != none && slots_[s].learned >= cursor.next;
       s = slots_[s].before) {
    slot = s;
  }
  for (std::size_t told = 0; slot != none; slot = slots_[slot].next) {
    const Slot& s = slots_[slot];
    const RobotId by = s.crumb.identity.robot;
    const bool own = by == options_.robot;
    const bool to_tell =
        (own || !what.own_only) && (what.to == no_robot || (by != what.to && s.from != what.to));
    if (to_tell) {
      if (told == what.crumbs_max) return;
      out.push_back(s.crumb);
      ++told;
    }
    cursor.next = s.learned + 1;
  }
  cursor.next = learned_;
}

template <LocalizationSpace S>
auto TrailStore<S>::place(EventId event) const -> const Place* {
  const auto at = std::lower_bound(places_.begin(), places_.end(), event,
                                   [](const Place& p, EventId number) { return p.event < number; });
  return at == places_.end() || at->event != event ? nullptr : &*at;
}

template <LocalizationSpace S>
auto TrailStore<S>::find(EventId event) -> Event* {
  const auto at = std::lower_bound(events_.begin(), events_.end(), event,
                                   [](const Event& e, EventId number) { return e.event < number; });
  return at == events_.end() || at->event != event ? nullptr : &*at;
}

template <LocalizationSpace S>
auto TrailStore<S>::find_or_add(EventId event) -> Event* {
  if (Event* const known = find(event)) return known;
  if (events_.size() >= options_.events_max) return nullptr;
  const auto at = std::lower_bound(events_.begin(), events_.end(), event,
                                   [](const Event& e, EventId number) { return e.event < number; });
  return &*events_.insert(at, Event{.event = event, .heap = {}, .arrivals = {}});
}

template <LocalizationSpace S>
auto TrailStore<S>::oldest() -> Event& {
  Event* found = nullptr;
  for (Event& event : events_) {
    if (event.heap.empty()) continue;
    if (found == nullptr ||
        age_of(slots_[event.heap.front()].crumb) < age_of(slots_[found->heap.front()].crumb)) {
      found = &event;
    }
  }
  require(found != nullptr, "trail store: no crumb is the oldest");
  return *found;
}

template <LocalizationSpace S>
void TrailStore<S>::insert(const Crumb& crumb, RobotId from, Event& event) {
  std::uint32_t slot = static_cast<std::uint32_t>(slots_.size());
  if (free_.empty()) {
    slots_.emplace_back();
    free_.reserve(slots_.capacity());
  } else {
    slot = free_.back();
    free_.pop_back();
  }
  slots_[slot] = {crumb, from, learned_++, last_, none};
  (last_ == none ? first_ : slots_[last_].next) = slot;
  last_ = slot;
  index_.add(slot, crumb.event, crumb.position);
  table_.insert(crumb.identity, slot);
  event.heap.push_back(slot);
  std::push_heap(event.heap.begin(), event.heap.end(), younger());
}

template <LocalizationSpace S>
void TrailStore<S>::remove_oldest(Event& event) {
  const std::uint32_t slot = event.heap.front();
  std::pop_heap(event.heap.begin(), event.heap.end(), younger());
  event.heap.pop_back();
  const Slot& gone = slots_[slot];
  (gone.before == none ? first_ : slots_[gone.before].next) = gone.next;
  (gone.next == none ? last_ : slots_[gone.next].before) = gone.before;
  index_.remove(slot);
  table_.erase(gone.crumb.identity);
  free_.push_back(slot);
}

}  // namespace hearsay::trails
