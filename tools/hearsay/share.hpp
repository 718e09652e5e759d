// Where the files are that come with the program: scenarios, figure scripts.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hearsay::program {

/// The directory that holds scenarios/ and tools/figures/: $HEARSAY_SHARE, or share/hearsay beside
/// an installed program, or the source tree the program was built from.
/// @throws InputError if there is none.
std::filesystem::path share_directory();

/// Study files of a theme (a folder of scenarios/), by name.
std::vector<std::filesystem::path> studies_of(const std::filesystem::path& theme);

}  // namespace hearsay::program
