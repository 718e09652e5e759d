#include "scenarios/tracks.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

#include "scenarios/csv.hpp"

namespace hearsay {
namespace {

enum Column : std::size_t { t_s, agent, x_m, y_m };

double coordinate_m(const CsvFile& csv, std::size_t row, Column column) {
  const double value = csv.number(row, column);
  if (std::abs(value) > 1e12) csv.reject(row, column, "must be within ±1e12 m");
  return value;
}

Time time_of(const CsvFile& csv, std::size_t row) {
  const double seconds = csv.number(row, t_s);
  if (seconds < 0.0) csv.reject(row, t_s, "must be at least 0");
  if (seconds > 1e9) csv.reject(row, t_s, "must be at most 1000000000");
  return Time::at(Duration::seconds(seconds));
}

}  // namespace

Tracks read_tracks(const std::string& file, const ScenarioUnderCheck& scenario) {
  const CsvFile csv(file, {.required = {"t_s", "agent", "x_m", "y_m"}});
  Tracks tracks(scenario.agents().size());
  std::vector<int> lines(tracks.size(), 0);  // of the last row of each
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    const Time time = time_of(csv, row);
    const auto who = static_cast<std::size_t>(scenario.resolve_agent(csv, row, agent));
    if (!tracks[who].empty() && time <= tracks[who].back().time) {
      csv.reject(row, t_s,
                 "must be after the time of the same agent on line " + std::to_string(lines[who]));
    }
    lines[who] = csv.line(row);
    tracks[who].push_back({time, {coordinate_m(csv, row, x_m), coordinate_m(csv, row, y_m)}});
  }
  return tracks;
}

}  // namespace hearsay
