// Heights of the cells of an area, in a CSV file.
//
//   x0,x1,x2
//   0,1.5,2
//   0,0.5,1
//
// A row of cells a line, that of the greatest y first, as on a map; the columns rise with x. Metres
// over the plane z = 0, from which altitudes count, too.
#pragma once

#include "scenarios/scenario_under_check.hpp"

namespace hearsay {

/// Reads world.area.heights, if given, into world.area.relief.
/// @throws InputError "hills.csv:3: …" for what CsvFile refuses, another number of columns or rows
/// than the area has, heights beyond ±1e6 m, or not below the altitude of every explorer that
/// looks.
void take_heights(ScenarioUnderCheck& file);

}  // namespace hearsay
