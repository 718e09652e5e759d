#include "tools/hearsay/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

namespace hearsay::program {

Progress::Progress(std::string title)
    : title_(std::move(title)),
      terminal_(isatty(STDERR_FILENO) == 1),
      begin_(std::chrono::steady_clock::now()) {}

Progress::~Progress() {
  if (shown_) fmt::print(stderr, "\r\033[K");
}

void Progress::show(std::int64_t done, std::int64_t total) {
  if (!terminal_ || total <= 0) return;
  shown_ = true;
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin_;
  const double rate = static_cast<double>(done) / std::max(passed.count(), 1e-3);
  const double left_s = rate > 0.0 ? static_cast<double>(total - done) / rate : 0.0;
  constexpr int width = 30;
  const int filled = static_cast<int>(width * done / total);
  fmt::print(stderr, "\r\033[K{} [{}{}] {}/{} runs, {:.0f} a second, {:.0f} s left", title_,
             std::string(static_cast<std::size_t>(filled), '#'),
             std::string(static_cast<std::size_t>(width - filled), '.'), done, total, rate, left_s);
  std::fflush(stderr);
}

}  // namespace hearsay::program
