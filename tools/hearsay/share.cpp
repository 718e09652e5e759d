#include "tools/hearsay/share.hpp"

#include <algorithm>
#include <cstdlib>

#include "sim/kernel/error.hpp"

namespace hearsay::program {

namespace fs = std::filesystem;

fs::path share_directory() {
  std::vector<fs::path> places;
  if (const char* given = std::getenv("HEARSAY_SHARE")) {
    places = {given};
  } else {
    std::error_code none;
    const fs::path self = fs::read_symlink("/proc/self/exe", none);
    if (!none) places.push_back(self.parent_path().parent_path() / "share" / "hearsay");
    places.push_back(HEARSAY_SOURCE_DIR);
  }
  for (const fs::path& place : places) {
    if (fs::is_directory(place / "scenarios")) return place;
  }
  throw InputError("the folder with scenarios/ and tools/figures/ is not at " +
                   places.back().string() + "; set HEARSAY_SHARE to where it is");
}

std::vector<fs::path> studies_of(const fs::path& theme) {
  std::vector<fs::path> studies;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(theme, none)) {
    if (entry.path().string().ends_with(".study.toml")) studies.push_back(entry.path());
  }
  std::sort(studies.begin(), studies.end());
  return studies;
}

}  // namespace hearsay::program
