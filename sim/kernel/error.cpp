#include "sim/kernel/error.hpp"

#include "sim/kernel/what_of.hpp"

namespace hearsay {

void broken(const char* what) { throw BrokenInvariant(what); }

std::string what_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& known) {
    return known.what();
  } catch (...) {
    return "an exception that is not a std::exception";
  }
}

}  // namespace hearsay
