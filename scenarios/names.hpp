// "Did you mean …?": the known name nearest to one that is not known.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hearsay {

/// Insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b` (optimal
/// string alignment), counted in bytes.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The first of the nearest names, if it is within max(1, length/3) edits of `name`.
std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> known);

/// "a, b, c".
std::string join(std::span<const std::string> names);

/// What follows an unknown name in a message: "; allowed: a, b, c; did you mean 'b'?". The list is
/// left out where a near name is found in a list of more than sixteen.
std::string allowed_names(std::string_view name, std::span<const std::string> known);

/// As allowed_names(), but the list only where no name is near.
std::string near_or_allowed(std::string_view name, std::span<const std::string> known);

}  // namespace hearsay
