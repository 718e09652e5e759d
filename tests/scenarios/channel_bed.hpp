// Scenarios of three agents that stand somewhere, to which a test adds a channel and failures.
#pragma once

#include <string>
#include <vector>

#include "temp_files.hpp"

namespace hearsay {

class ChannelBed : public InTempDirectory {
 protected:
  // Line 1 is the duration; what is given begins on line 2.
  static Scenario load(const std::string& lines, const std::vector<std::string>& set = {}) {
    write("s.toml", "duration_s = 1\n" + lines + agents);
    return load_scenario("s.toml", sets(set), {});
  }
  static std::string error(const std::string& lines, const std::vector<std::string>& set = {}) {
    return error_of([&] { load(lines, set); });
  }
  static std::string by_position(const std::string& propagation) {
    return "[radio]\ntopology = \"by-position\"\npropagation = { " + propagation + " }\n";
  }

  static inline const std::string agents =
      "[[agents]]\nname = \"base\"\nposition_m = [0, 0]\n"
      "[[agents]]\nname = \"a\"\ncount = 2\ncircle = { radius_m = 5 }\n";
};

}  // namespace hearsay
