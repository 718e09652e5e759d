#include "net/radio_options.hpp"

#include <cmath>
#include <sstream>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

template <class T>
void require_option(bool holds, const char* name, const char* allowed, const T& found) {
  if (holds) return;
  std::ostringstream text;
  text << "radio: " << name << " must be " << allowed << ", not " << found;
  throw InputError(text.str());
}

void check(const QueueOptions& queue) {
  require_option(queue.packets_max >= 1, "queue_packets_max", "at least 1", queue.packets_max);
  if (queue.bytes_max) {
    require_option(*queue.bytes_max >= 1, "queue_bytes_max", "at least 1", *queue.bytes_max);
  }
  if (queue.wait_max) {
    require_option(*queue.wait_max > Duration(), "queue_wait_max_s", "greater than 0",
                   queue.wait_max->seconds());
  }
}

void check(const AcknowledgementOptions& acknowledgement) {
  require_option(acknowledgement.bytes >= 1, "acknowledgement.bytes", "at least 1",
                 acknowledgement.bytes);
  require_option(acknowledgement.interframe >= Duration(), "acknowledgement.interframe_s",
                 "at least 0", acknowledgement.interframe.seconds());
  require_option(acknowledgement.attempts_max >= 1 && acknowledgement.attempts_max <= 1000,
                 "acknowledgement.attempts_max", "in [1, 1000]", acknowledgement.attempts_max);
}

}  // namespace

void check(const RadioOptions& options) {
  require_option(options.rate_bps > 0.0 && std::isfinite(options.rate_bps), "rate_bps",
                 "positive and finite", options.rate_bps);
  if (options.mtu_bytes) {
    require_option(*options.mtu_bytes >= 1, "mtu_bytes", "at least 1", *options.mtu_bytes);
  }
  check(options.queue);
  require_option(options.capture_db >= 0.0, "capture_db", "at least 0", options.capture_db);
  require_option(options.latency >= Duration(), "latency_s", "at least 0",
                 options.latency.seconds());
  require_option(options.jitter.spread >= Duration(), "jitter.spread_s", "at least 0",
                 options.jitter.spread.seconds());
  require_option(options.propagation_m_per_s > 0.0, "propagation_m_per_s", "greater than 0",
                 options.propagation_m_per_s);
  check(options.acknowledgement);
}

}  // namespace hearsay
