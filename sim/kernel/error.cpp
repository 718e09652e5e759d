#include "sim/kernel/error.hpp"

namespace hearsay {

void broken(const char* what) { throw BrokenInvariant(what); }

}  // namespace hearsay
