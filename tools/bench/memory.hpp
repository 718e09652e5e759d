// What a benchmark's program holds and asks for: linking this library replaces operator new.
#pragma once

#include <cstddef>

namespace hearsay::bench {

/// Calls of operator new so far.
std::size_t allocations();
/// Bytes held now, as the C library has rounded them.
std::size_t bytes_held();

}  // namespace hearsay::bench
