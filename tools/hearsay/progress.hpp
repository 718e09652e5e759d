// A progress bar on a terminal; silent in a pipe.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace hearsay::program {

class Progress {
 public:
  /// `title` stands before the bar. Nothing is shown unless standard error is a terminal.
  explicit Progress(std::string title);
  /// Clears the line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::int64_t done, std::int64_t total);

 private:
  std::string title_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point begin_;
};

}  // namespace hearsay::program
