#include "sim/kernel/canon.hpp"

#include <algorithm>

namespace hearsay {

Canon::Canon(DigestSink* sink) : sink_(sink) {
  if (sink != nullptr) buffer_.resize(piece_bytes + row_bytes_max);
}

void Canon::text(std::string_view value) {
  if (sink_ == nullptr) return;
  put(value.size(), buffer_.data() + used_);
  used_ += 8;
  for (;;) {
    if (used_ >= piece_bytes) pass_on();
    if (value.empty()) return;
    const std::size_t part = std::min(value.size(), piece_bytes - used_);
    std::memcpy(buffer_.data() + used_, value.data(), part);
    used_ += part;
    value.remove_prefix(part);
  }
}

void Canon::pass_on() {
  sink_->update(std::span(buffer_).first(piece_bytes));
  used_ -= piece_bytes;
  std::memcpy(buffer_.data(), buffer_.data() + piece_bytes, used_);
}

void Canon::flush() {
  if (used_ == 0) return;
  sink_->update(std::span(buffer_).first(used_));
  used_ = 0;
}

}  // namespace hearsay
