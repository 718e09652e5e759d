// Simulated time: a strong type over 64-bit nanoseconds since the start of the run.
//
// `Duration` is a span, `Time` an instant; an instant minus an instant is a span, and nothing else
// converts. Range: about ±292 years. There is no static now(): the clock belongs to a Simulation.
#pragma once

#include <compare>
#include <cstdint>

namespace hearsay {

/// A span of simulated time, exact to the nanosecond. May be negative.
class Duration {
 public:
  constexpr Duration() = default;

  /// `ns` nanoseconds.
  static constexpr Duration nanoseconds(std::int64_t ns) { return Duration(ns); }

  /// `s` seconds, rounded to the nearest nanosecond (ties away from zero).
  /// @throws std::out_of_range if `s` is not finite or beyond ±9e9 s.
  static Duration seconds(double s);

  constexpr std::int64_t nanoseconds() const { return ns_; }
  constexpr double seconds() const { return static_cast<double>(ns_) / 1e9; }

  constexpr auto operator<=>(const Duration&) const = default;
  constexpr Duration operator-() const { return Duration(-ns_); }
  constexpr Duration operator+(Duration other) const { return Duration(ns_ + other.ns_); }
  constexpr Duration operator-(Duration other) const { return Duration(ns_ - other.ns_); }
  constexpr Duration operator*(std::int64_t factor) const { return Duration(ns_ * factor); }
  constexpr Duration operator/(std::int64_t divisor) const { return Duration(ns_ / divisor); }
  /// How many whole times `other` fits into this span (truncated towards zero). `other` ≠ 0.
  constexpr std::int64_t operator/(Duration other) const { return ns_ / other.ns_; }
  constexpr Duration operator%(Duration other) const { return Duration(ns_ % other.ns_); }
  constexpr Duration& operator+=(Duration other) { return *this = *this + other; }
  constexpr Duration& operator-=(Duration other) { return *this = *this - other; }

 private:
  explicit constexpr Duration(std::int64_t ns) : ns_(ns) {}
  std::int64_t ns_ = 0;
};

/// An instant of simulated time, counted from the start of the run.
class Time {
 public:
  constexpr Time() = default;

  /// The instant `since_start` after the start of the run.
  static constexpr Time at(Duration since_start) { return Time(since_start); }
  static constexpr Time nanoseconds(std::int64_t ns) { return Time(Duration::nanoseconds(ns)); }
  /// Later than any event can be.
  static constexpr Time never() { return nanoseconds(INT64_MAX); }

  constexpr Duration since_start() const { return since_start_; }
  constexpr std::int64_t nanoseconds() const { return since_start_.nanoseconds(); }
  constexpr double seconds() const { return since_start_.seconds(); }

  constexpr auto operator<=>(const Time&) const = default;
  constexpr Time operator+(Duration span) const { return Time(since_start_ + span); }
  constexpr Time operator-(Duration span) const { return Time(since_start_ - span); }
  constexpr Duration operator-(Time other) const { return since_start_ - other.since_start_; }

 private:
  explicit constexpr Time(Duration since_start) : since_start_(since_start) {}
  Duration since_start_;
};

inline namespace literals {
constexpr Duration operator""_ns(unsigned long long n) {
  return Duration::nanoseconds(static_cast<std::int64_t>(n));
}
constexpr Duration operator""_us(unsigned long long n) {
  return Duration::nanoseconds(static_cast<std::int64_t>(n) * 1'000);
}
constexpr Duration operator""_ms(unsigned long long n) {
  return Duration::nanoseconds(static_cast<std::int64_t>(n) * 1'000'000);
}
constexpr Duration operator""_s(unsigned long long n) {
  return Duration::nanoseconds(static_cast<std::int64_t>(n) * 1'000'000'000);
}
constexpr Duration operator""_min(unsigned long long n) {
  return Duration::nanoseconds(static_cast<std::int64_t>(n) * 60'000'000'000);
}
}  // namespace literals

}  // namespace hearsay
