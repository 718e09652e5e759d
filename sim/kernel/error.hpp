// The two kinds of failure that are exceptions. (What goes wrong in the simulated world is a
// value.)
#pragma once

#include <stdexcept>
#include <string>

namespace hearsay {

/// What the user gave cannot be used: a scenario file, an option, a log, a database. The program
/// prints what() and ends with exit code 2, without having written anything.
/// what() reads "file:line: message" (parts that are not known are left out).
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
  InputError(const std::string& file, int line, const std::string& message)
      : std::runtime_error(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " + message) {}
};

/// An invariant of the program does not hold. Thrown inside a run it ends that run with the agent's
/// name and the simulated time; outside it is a bug.
class BrokenInvariant : public std::logic_error {
 public:
  explicit BrokenInvariant(const std::string& what) : std::logic_error(what) {}
};

/// @throws BrokenInvariant with `what`. Out of line, so that who requires much stays small.
[[noreturn]] void broken(const char* what);

/// @throws BrokenInvariant with `what` unless `holds`. Checked in every build.
inline void require(bool holds, const char* what) {
  if (!holds) broken(what);
}

}  // namespace hearsay
