#include "scenarios/heights.hpp"

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "filters/grid/relief.hpp"
#include "scenarios/csv.hpp"
#include "scenarios/explorers.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

/// The explorer with a sensor that flies lowest.
struct Lowest {
  double altitude_m = 0.0;
  std::size_t agent = 0;
  bool any = false;
};
Lowest lowest_of(const Scenario& scenario) {
  Lowest lowest;
  for (std::size_t i = 0; i < scenario.agents.size(); ++i) {
    const AgentSpec& agent = scenario.agents[i];
    if (agent.kind != "explorer" || agent.sensor.kind == "none") continue;
    const double altitude_m = agent.motion.value().altitude_m;
    if (!lowest.any || altitude_m < lowest.altitude_m) lowest = {altitude_m, i, true};
  }
  return lowest;
}

CsvFile::Columns columns_of(const AreaSpec& area) {
  CsvFile::Columns columns;
  for (int column = 0; column < area.columns; ++column) {
    columns.required.push_back("x" + std::to_string(column));
  }
  columns.optional.push_back("x" + std::to_string(area.columns));  // one too many
  return columns;
}

double height_at(const CsvFile& csv, std::size_t row, std::size_t column, const Lowest& lowest) {
  const double height_m = csv.number(row, column);
  if (std::abs(height_m) > 1e6) csv.reject(row, column, "must be within ±1e6 m");
  if (lowest.any && height_m >= lowest.altitude_m) {
    csv.reject(row, column,
               "must be less than agents[" + std::to_string(lowest.agent) +
                   "].motion.altitude_m (" + to_toml(lowest.altitude_m) + " m)");
  }
  return height_m;
}

}  // namespace

void take_heights(ScenarioUnderCheck& file) {
  if (!file.scenario.world.area || !file.scenario.world.area->heights) return;
  AreaSpec& area = *file.scenario.world.area;
  const std::string& name = *area.heights;
  if (name.empty()) {
    const KeyPath top, world = top["world"], path = world["area"];
    file.fail(path["heights"], "missing; which CSV file x0,x1,x2 and so on");
  }
  const CsvFile csv(name, columns_of(area));
  const auto columns = static_cast<std::size_t>(area.columns);
  if (csv.has(columns)) {
    throw InputError(name, 0,
                     "has a column 'x" + std::to_string(columns) + "', but world.area.columns is " +
                         std::to_string(columns));
  }
  if (csv.rows() != static_cast<std::size_t>(area.rows)) {
    throw InputError(name, 0,
                     "number of rows is " + std::to_string(csv.rows()) +
                         ", but world.area.rows is " + std::to_string(area.rows));
  }
  const Lowest lowest = lowest_of(file.scenario);
  std::vector<double> heights_m(csv.rows() * columns);
  for (std::size_t line = 0; line < csv.rows(); ++line) {
    const std::size_t row = csv.rows() - 1 - line;
    for (std::size_t column = 0; column < columns; ++column) {
      heights_m[row * columns + column] = height_at(csv, line, column, lowest);
    }
  }
  area.relief =
      std::make_shared<const grid::Relief>(area_of(file.scenario.world), std::move(heights_m));
}

}  // namespace hearsay
