#include "net/places.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr double cell_min_m = 1e-3;  // so that numbers of cells are exact
constexpr double coordinate_max_m = 1e13;
constexpr double rounding = 0x1p-48;  // of a sum of some coordinates, amply
constexpr double units = 65536.0;     // a cell's side in those of PlaceGrid::Filed
constexpr int agents_max = 10'000'000;

void check(double value, bool zero_allowed, const char* name) {
  if (std::isfinite(value) && (value > 0.0 || (zero_allowed && value == 0.0))) return;
  std::ostringstream text;
  text << name << " must be " << (zero_allowed ? "at least 0" : "above 0") << " and finite, not "
       << value;
  throw InputError(text.str());
}

int checked(int agents) {
  if (agents >= 1 && agents <= agents_max) return agents;
  throw InputError("places are for 1 … 10000000 agents, not " + std::to_string(agents));
}

std::uint16_t to_units(double part) {
  return static_cast<std::uint16_t>(std::clamp(part * units, 0.0, units - 1.0));
}

}  // namespace

struct Places::Look {
  Point place_m;
  double half_m;       // of a square that has all candidates
  float squared_half;  // of the circle, in units
};

struct Places::Cells {
  std::int64_t first_column, last_column, first_row, last_row;
};

Places::Places(int agents, double reach_m, double slack_m)
    : reach_m_(reach_m), slack_m_(slack_m), grid_(checked(agents)) {
  check(reach_m, false, "reach_m");
  check(slack_m, true, "slack_m");
  cell_m_ = std::max(reach_m + slack_m, cell_min_m);
  cells_per_m_ = 1.0 / cell_m_;
  legs_.assign(static_cast<std::size_t>(agents), {Leg{.begin = Time::never()}});
}

std::int64_t Places::cell_number(double coordinate_m) const {
  const double cells = coordinate_m * cells_per_m_;
  const auto towards_zero = static_cast<std::int64_t>(cells);
  return towards_zero - (cells < static_cast<double>(towards_zero));
}

Time Places::set(AgentId agent, const Leg& leg, Time now) {
  require(agent >= 0 && agent < agents(), "an agent that there is not was given a place");
  require(leg.begin <= now && now < leg.end, "an agent was given a leg at a time outside it");
  legs_[static_cast<std::size_t>(agent)].leg = leg;
  return refresh(agent, now);
}

Time Places::refresh(AgentId agent, Time now) {
  const Leg& leg = this->leg(agent);
  const Point here_m = leg.at(now);
  std::int64_t cell[2];
  std::uint16_t part[2];
  for (const std::size_t axis : {0u, 1u}) {
    require(std::abs(here_m[axis]) <= coordinate_max_m, "an agent is beyond ±1e13 m");
    largest_m_ = std::max({largest_m_, std::abs(here_m[axis]), std::abs(leg.from_m[axis])});
    cell[axis] = cell_number(here_m[axis]);
    part[axis] = to_units(here_m[axis] * cells_per_m_ - static_cast<double>(cell[axis]));
  }
  grid_.put({part[0], part[1], agent}, cell[0], cell[1]);
  const double vx = leg.velocity_m_per_s[0], vy = leg.velocity_m_per_s[1];
  const double speed_m_per_s = std::sqrt(vx * vx + vy * vy);
  require(slack_m_ > 0.0 || speed_m_per_s == 0.0, "something moves among places without slack");
  const double span_ns = slack_m_ / speed_m_per_s * 1e9;
  if (!(span_ns < static_cast<double>((leg.end - now).nanoseconds()))) return leg.end;
  return now + Duration::nanoseconds(std::max(static_cast<std::int64_t>(span_ns), std::int64_t{1}));
}

std::span<const Nearby> Places::near(AgentId agent, Time time) {
  const Leg& own = leg(agent);
  require(own.begin <= time && time <= own.end, "a look-up is not within the leg of its agent");
  return look(own.at(time), reach_m_, time, agent);
}

std::span<const Nearby> Places::around(const Point& place_m, double reach_m, Time time) {
  check(reach_m, true, "reach_m");
  return look(place_m, reach_m, time, no_agent);
}

std::span<const Nearby> Places::look(const Point& place_m, double reach_m, Time time,
                                     AgentId except) {
  const double far_m = std::abs(place_m[0]) + std::abs(place_m[1]);
  require(std::isfinite(far_m), "a look-up needs a place");
  const double half_m = reach_m + slack_m_ + rounding * (largest_m_ + far_m + reach_m + cell_m_);
  const double half_units = half_m * cells_per_m_ * units * (1.0 + 1e-5) + 2.0;
  candidate_count_ = 0;
  collect({.place_m = place_m,
           .half_m = half_m,
           .squared_half = static_cast<float>(half_units * half_units)});
  for (std::size_t i = 0; i < candidate_count_; ++i) {  // on their way while these are sorted
    __builtin_prefetch(&legs_[static_cast<std::size_t>(candidates_[i])]);
  }
  sort_candidates();
  if (hits_.size() < candidate_count_) hits_.resize(2 * candidate_count_);
  const double squared_reach_m2 = reach_m * reach_m;
  std::size_t count = 0;
  for (std::size_t i = 0; i < candidate_count_; ++i) {
    const double d2_m2 = squared_distance_m2(place_m, at(sorted_[i], time));
    hits_[count] = {sorted_[i], d2_m2};  // to be kept or written over: cheaper than a branch
    count += (d2_m2 <= squared_reach_m2) & (sorted_[i] != except);
  }
  return std::span(hits_).first(count);
}

void Places::collect(const Look& look) {
  constexpr std::int64_t side = PlaceGrid::tile_side;
  const double cells_a_side = 2.0 * look.half_m * cells_per_m_ + 2.0;
  if (cells_a_side * cells_a_side > 64.0 + agents()) {  // quicker to ask everybody
    candidates_.resize(legs_.size());
    for (AgentId a = 0; a < agents(); ++a) {
      if (grid_.has(a)) candidates_[candidate_count_++] = a;
    }
    return;
  }
  const Cells cells{
      cell_number(look.place_m[0] - look.half_m), cell_number(look.place_m[0] + look.half_m),
      cell_number(look.place_m[1] - look.half_m), cell_number(look.place_m[1] + look.half_m)};
  for (std::int64_t v = PlaceGrid::tile_of(cells.first_row);
       v <= PlaceGrid::tile_of(cells.last_row); ++v) {
    for (std::int64_t u = PlaceGrid::tile_of(cells.first_column);
         u <= PlaceGrid::tile_of(cells.last_column); ++u) {
      const PlaceGrid::Line* tile = grid_.tile(u, v);
      if (tile != nullptr) collect_from_tile(look, cells, tile, u * side, v * side);
    }
  }
}

void Places::collect_from_tile(const Look& look, const Cells& cells, const PlaceGrid::Line* tile,
                               std::int64_t column, std::int64_t row) {
  constexpr std::int64_t side = PlaceGrid::tile_side;
  const std::int64_t first_i = std::max(cells.first_column - column, std::int64_t{0});
  const std::int64_t last_i = std::min(cells.last_column - column, side - 1);
  const std::int64_t first_j = std::max(cells.first_row - row, std::int64_t{0});
  const std::int64_t last_j = std::min(cells.last_row - row, side - 1);
  for (std::int64_t j = first_j; j <= last_j; ++j) {
    for (std::int64_t i = first_i; i <= last_i; ++i) __builtin_prefetch(&tile[j * side + i]);
  }
  const double x = look.place_m[0] * cells_per_m_ - static_cast<double>(column);
  const double y = look.place_m[1] * cells_per_m_ - static_cast<double>(row);
  for (std::int64_t j = first_j; j <= last_j; ++j) {
    const auto y_units = static_cast<float>((y - static_cast<double>(j)) * units);
    for (std::int64_t i = first_i; i <= last_i; ++i) {
      const auto x_units = static_cast<float>((x - static_cast<double>(i)) * units);
      const PlaceGrid::Line* line = &tile[j * side + i];
      collect_from(look, *line, x_units, y_units);
      while (line->next != PlaceGrid::none) {
        line = &grid_.line(line->next);
        collect_from(look, *line, x_units, y_units);
      }
    }
  }
}

void Places::collect_from(const Look& look, const PlaceGrid::Line& line, float x, float y) {
  constexpr std::size_t room = PlaceGrid::line_room;
  if (candidates_.size() < candidate_count_ + room) {
    candidates_.resize(2 * candidate_count_ + 8 * room);
  }
  std::array<std::int32_t, 8> inside;
  for (std::size_t i = 0; i < 8; ++i) {
    const float dx = static_cast<float>(line.x[i]) - x;
    const float dy = static_cast<float>(line.y[i]) - y;
    inside[i] = dx * dx + dy * dy <= look.squared_half;
  }
  AgentId* to = candidates_.data() + candidate_count_;
  for (std::size_t i = 0; i < room; ++i) {
    *to = line.agent[i];  // to be kept or written over: cheaper than a branch
    to += inside[i] & static_cast<std::int32_t>(i < line.count);
  }
  candidate_count_ = static_cast<std::size_t>(to - candidates_.data());
}

void Places::sort_candidates() {
  const std::size_t n = candidate_count_;
  if (sorted_.size() < n) sorted_.resize(2 * n);
  if (n > 32) {
    std::copy_n(candidates_.begin(), n, sorted_.begin());
    std::sort(sorted_.begin(), sorted_.begin() + static_cast<std::ptrdiff_t>(n));
    return;
  }
  // The rank of each among all, for compilers to look at several at once.
  std::array<std::int32_t, 32> all;
  all.fill(INT32_MAX);
  std::copy_n(candidates_.begin(), n, all.begin());
  const std::size_t padded = (n + 3) / 4 * 4;
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t mine = all[i];
    std::int32_t rank = 0;
    for (std::size_t j = 0; j < padded; ++j) rank += all[j] < mine;
    sorted_[static_cast<std::size_t>(rank)] = mine;
  }
}

}  // namespace hearsay
