// Counts what a benchmark asks the heap for. For one source file of a program: it replaces malloc,
// in which both operator new and Eigen's heap end.
#pragma once

#include <cstddef>
#include <cstdlib>

namespace hearsay::bench {

/// Calls of malloc so far.
inline std::size_t allocations = 0;

}  // namespace hearsay::bench

// __libc_malloc is glibc's own name for it.
extern "C" {
void* __libc_malloc(std::size_t size);
void* malloc(std::size_t size) {
  ++hearsay::bench::allocations;
  return __libc_malloc(size);
}
}
