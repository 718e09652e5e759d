// What an exception says.
#pragma once

#include <exception>
#include <string>

namespace hearsay {

/// `error` is not null.
std::string what_of(const std::exception_ptr& error);

}  // namespace hearsay
