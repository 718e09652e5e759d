// How Cyclone DDS is set up. Not for users.
#pragma once

#include <cstdint>
#include <string>

namespace hearsay::live {

/// Cyclone's configuration (XML): everything on the loopback interface, or on the one named.
/// @throws InputError for a domain beyond 230, or a name that no interface has.
std::string cyclone_config(std::uint32_t domain, const std::string& interface);

}  // namespace hearsay::live
