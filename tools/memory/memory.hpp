// What a program holds and asks for, for tests and benchmarks: linking this library replaces
// operator new.
#pragma once

#include <cstddef>

namespace hearsay::memory {

/// Calls of operator new so far.
std::size_t allocations();
/// Bytes held now, as the C library has rounded them.
std::size_t bytes_held();

}  // namespace hearsay::memory
