// Laying key = value over a parsed scenario file.
#pragma once

#include <span>
#include <string>

#include "scenarios/document.hpp"
#include "scenarios/loader.hpp"

namespace hearsay {

/// What a message about this override begins with.
std::string origin_text(const Override& override_);

/// Sets one key in the tree. A key without a number in brackets sets every element of the array.
/// A table replaces what was there. @throws InputError for a key that is not in the schema, an
/// element that is not in the file, or a value that is not TOML.
void apply(const Override& override_, TomlNode& root);

/// A scenario from a parsed file, with overrides laid over it, and all checks done.
Scenario build_scenario(TomlNode root, const std::string& file, std::span<const Override> overrides,
                        const KnownNames& names);

}  // namespace hearsay
