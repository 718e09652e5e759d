// Variants of a scenario's text.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace hearsay {

/// `text` with each `from`, of which there is at least one, replaced.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), std::string::npos) << from;
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

}  // namespace hearsay
