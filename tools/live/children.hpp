// The processes of a fleet as children of this one: started together, shown, ended together.
#pragma once

#include <string>
#include <vector>

namespace hearsay::fleet {

struct ChildSpec {
  std::string name;                    ///< as it is shown
  std::vector<std::string> arguments;  ///< of this very program
};

struct ChildrenResult {
  int code = 0;                    ///< of the first child, or 1 if one of the others failed
  std::vector<std::string> lines;  ///< what the first child printed, but for its status
};

/// A line that a child prints to say how it is begins with this.
inline constexpr const char* status_mark = "status ";

/// Starts them; the first is the one on which the others depend. Shows one line of status for each
/// on a terminal, and passes on what they say on standard error, with their names. When the first
/// ends, when one of the others fails (being killed is no failure: the fleet goes on without it),
/// or when this process is asked to stop, all are asked to stop, and killed if they do not within a
/// few seconds. None is left when this returns; they end, too, if this process is killed.
ChildrenResult run_children(const std::vector<ChildSpec>& specs);

}  // namespace hearsay::fleet
