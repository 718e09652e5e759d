// Tracks: where agents were when, recorded elsewhere, in a CSV file.
//
//   t_s,agent,x_m,y_m
//   0,uav0,10,20
//   12.5,uav0,40,25
//
// Between its rows an agent goes straight; before the first and after the last it stands still.
// Agents stand there by name or number; rows of different agents may come in any order.
#pragma once

#include <string>

#include "scenarios/motion_spec.hpp"
#include "scenarios/scenario_under_check.hpp"

namespace hearsay {

/// @throws InputError "tracks.csv:3: …" for what CsvFile refuses, an agent that is not there, times
/// outside 0 … 1e9 s or not after those of the agent's rows before, and coordinates beyond ±1e12 m.
Tracks read_tracks(const std::string& file, const ScenarioUnderCheck& scenario);

}  // namespace hearsay
