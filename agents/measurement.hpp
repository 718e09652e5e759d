// Measurements as agents get them: as information, from whichever sensor.
#pragma once

#include <cstddef>

#include "filters/gaussian/belief.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// A measurement known beforehand, such as one read from a log.
struct Observation {
  Time time;
  int subject;
  gaussian::Belief information;
};

/// What was measured now: information about a subject's state, or about the first numbers of it.
struct Measurement {
  int subject = 0;
  gaussian::Belief information;
  std::size_t index = 0;  ///< in the subject's MeasurementBook
};

/// Gets an agent's measurements; called in Phase::measure.
class MeasurementReceiver {
 public:
  virtual ~MeasurementReceiver() = default;
  virtual void on_measurement(const Measurement& measurement) = 0;
};

}  // namespace hearsay
