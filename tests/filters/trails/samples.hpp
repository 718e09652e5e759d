// Crumbs, places and a second localization-space for the tests of this family.
#pragma once

#include <array>
#include <cmath>
#include <ostream>
#include <string_view>
#include <vector>

#include "filters/trails/store.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay::trails {

inline Stream stream(std::string_view purpose) {
  return Stream(1, Purpose(purpose), Entity::agent(0));
}

inline Point random_point(Stream& random, double half_side_m) {
  return point(random.uniform(-half_side_m, half_side_m),
               random.uniform(-half_side_m, half_side_m));
}

/// Laid before `until_s`; d from few values, so that there are equal ones.
inline Crumb random_crumb(Stream& random, std::uint32_t number, double half_side_m,
                          double until_s) {
  return {.event = static_cast<EventId>(random.below(3)),
          .goal = random.bernoulli(0.3) ? no_event : static_cast<EventId>(random.below(3)),
          .position = random_point(random, half_side_m),
          .distance_s = static_cast<float>(random.below(20)),
          .created_s = std::floor(random.uniform(0.0, until_s)),
          .identity = {static_cast<RobotId>(random.below(4)), 1, number}};
}
inline std::vector<Crumb> random_crumbs(Stream& random, std::size_t count, double half_side_m,
                                        double until_s) {
  std::vector<Crumb> crumbs;
  for (std::size_t i = 0; i < count; ++i) {
    crumbs.push_back(random_crumb(random, static_cast<std::uint32_t>(i), half_side_m, until_s));
  }
  return crumbs;
}

template <typename Value>
void shuffle(std::vector<Value>& values, Stream& random) {
  for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.below(i)]);
}

/// For gtest.
inline void PrintTo(const Crumb& crumb, std::ostream* out) {
  *out << "crumb " << crumb.identity.robot << '.' << crumb.identity.number << " of event "
       << crumb.event << ", d " << crumb.distance_s << ", t " << crumb.created_s;
}

/// What a store holds, by identity.
template <typename S>
auto content(const TrailStore<S>& store) {
  std::vector<typename TrailStore<S>::Crumb> crumbs;
  store.for_each([&](const auto& crumb) { crumbs.push_back(crumb); });
  std::sort(crumbs.begin(), crumbs.end(),
            [](const auto& a, const auto& b) { return a.identity < b.identity; });
  return crumbs;
}

/// Views as positions: near is what is similar, and every view is looked at.
struct ViewSpace {
  using Position = std::array<float, 3>;
  struct Reach {
    Position seen{};
    double similarity_min = 0.9;
  };
  struct Options {};
  static constexpr std::size_t numbers = 3;
  static double similarity(const Position& a, const Position& b) {
    double dot = 0.0, aa = 0.0, bb = 0.0;
    for (std::size_t i = 0; i < numbers; ++i) {
      dot += double{a[i]} * b[i];
      aa += double{a[i]} * a[i];
      bb += double{b[i]} * b[i];
    }
    return dot / std::sqrt(aa * bb);
  }
  class Index {
   public:
    explicit Index(const Options&) {}
    void add(std::uint32_t slot, EventId event, const Position& view) {
      if (slot >= views_.size()) views_.resize(slot + 1);
      views_[slot] = {event, view};
    }
    void remove(std::uint32_t slot) { views_[slot] = {}; }
    template <typename F>
    void visit(EventId event, const Reach& reach, F&& f) const {
      for (std::uint32_t slot = 0; slot < views_.size(); ++slot) {
        const View& view = views_[slot];
        if (view.event != event) continue;
        if (similarity(view.seen, reach.seen) >= reach.similarity_min) f(slot);
      }
    }

   private:
    struct View {
      EventId event = no_event;
      Position seen{};
    };
    std::vector<View> views_;
  };
  static bool sound(const Position& view) {
    bool some = false;
    for (const float value : view) {
      if (!std::isfinite(value)) return false;
      some = some || value != 0.0F;
    }
    return some;
  }
  static void put(const Position& view, std::span<float> out) {
    std::copy(view.begin(), view.end(), out.begin());
  }
  static Position get(std::span<const float> in) { return {in[0], in[1], in[2]}; }
};
static_assert(LocalizationSpace<ViewSpace>);

}  // namespace hearsay::trails
