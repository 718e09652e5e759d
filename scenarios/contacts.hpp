// Contact traces: who was in contact with whom, recorded elsewhere, in a CSV file.
//
//   t_s,a,b,state
//   0,uav0,uav1,up
//   12.5,uav1,uav0,down
//
// A row says that from t_s on the two agents hear each other (up) or do not (down); before its
// first row a pair is down. Agents stand there by name or number, in either order.
#pragma once

#include <string>
#include <vector>

#include "net/link_plan.hpp"
#include "scenarios/scenario_under_check.hpp"

namespace hearsay {

/// The rows of a trace, sorted by time, as plan_contacts() wants them.
/// @throws InputError "trace.csv:3: …" for what CsvFile refuses, for times out of order or outside
/// 0 … 1e9 s, an agent that is not there or in contact with itself, a state other than up or down,
/// and a pair that goes up while it is up or down while it is down: then the trace lacks a row, and
/// nobody knows which.
std::vector<LinkChange> read_contacts(const std::string& file, const ScenarioUnderCheck& scenario);

}  // namespace hearsay
