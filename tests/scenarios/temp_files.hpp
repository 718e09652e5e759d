// Files that a test writes into a directory of its own.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "scenarios/loader.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {

/// The test works in an empty directory, so that files have short names in messages.
class InTempDirectory : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    before_ = std::filesystem::current_path();
    directory_ = std::filesystem::path(::testing::TempDir()) /
                 ("hearsay-" + std::string(info->test_suite_name()) + "-" + info->name());
    std::filesystem::remove_all(directory_);
    std::filesystem::create_directories(directory_);
    std::filesystem::current_path(directory_);
  }
  void TearDown() override {
    std::filesystem::current_path(before_);
    std::filesystem::remove_all(directory_);
  }

  static void write(const std::string& file, const std::string& content) {
    std::ofstream(file, std::ios::binary) << content;
  }

  std::filesystem::path before_, directory_;
};

/// What the InputError thrown by `call` says; "no error" if there is none.
template <class Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

inline std::vector<Override> sets(const std::vector<std::string>& texts) {
  std::vector<Override> overrides;
  for (const std::string& text : texts) overrides.push_back(parse_set(text));
  return overrides;
}

/// A valid scenario; the line numbers in tests count from its first line.
inline const std::string ring =
    R"(duration_s = 60
seed = 7

[world]
targets = [{ name = "alarm", position_m = [40.0, 25.0] }]

[radio]
topology = "ring"
rate_bps = 250_000
loss = { model = "bernoulli", probability = 0.1 }

[[agents]]
count = 4
sensor = { kind = "position", period_s = 1.0, sigma_m = 5.0 }
estimator = { kind = "static-gaussian", fusion = "ci-det" }
talk = { policy = "periodic", period_s = 5.0 }

[record]
series = ["nees"]
)";

}  // namespace hearsay
