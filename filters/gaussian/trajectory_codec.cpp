#include "filters/gaussian/trajectory_codec.hpp"

#include <limits>

#include "filters/gaussian/cdr.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

/// Where a Writer would be.
class Measure {
 public:
  void u32(std::size_t) { offset_ = cdr::aligned(offset_, 4) + 4; }
  void u64(std::uint64_t) { offset_ = cdr::aligned(offset_, 8) + 8; }
  void f64(double) { u64(0); }
  std::size_t size() const { return offset_; }

 private:
  std::size_t offset_ = 0;
};

template <class W>
void write(const TrajectoryStep& step, W& writer) {
  const Belief& belief = step.information;
  const Eigen::Index n = belief.dimension();
  require(n >= 1 && belief.omega.rows() == n && belief.omega.cols() == n &&
              (step.next.size() == 0 || (step.next.rows() == n && step.next.cols() == n)),
          "encode: the parts of a step disagree in dimension");
  writer.u64(static_cast<std::uint64_t>(step.stamp));
  writer.u32(static_cast<std::size_t>(n));
  for (const double value : belief.xi) writer.f64(value);
  writer.u32(static_cast<std::size_t>(n * (n + 1) / 2));
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i; j < n; ++j) writer.f64(belief.omega(i, j));
  }
  writer.u32(static_cast<std::size_t>(step.next.size()));
  for (Eigen::Index i = 0; i < step.next.rows(); ++i) {
    for (Eigen::Index j = 0; j < step.next.cols(); ++j) writer.f64(step.next(i, j));
  }
}

template <class W>
void write(const TrajectoryMessage& message, W& writer) {
  writer.u32(message.incarnation);
  writer.u32(message.count);
  writer.u32(message.trajectories.size());
  for (const TrajectoryEntry& entry : message.trajectories) {
    writer.u32(entry.subject);
    writer.u64(static_cast<std::uint64_t>(entry.first));
    writer.u32(entry.steps.size());
    for (const TrajectoryStep& step : entry.steps) write(step, writer);
  }
}

constexpr std::size_t step_bytes_min = 8 + 8 + 8 + 8 + 8 + 4;  // n = 1, without a next block
constexpr std::size_t entry_bytes_min = 4 + 8 + 4;

bool read(cdr::Reader& in, TrajectoryStep& step) {
  std::uint32_t n = 0, entries = 0, next = 0;
  if (!in.has_f64(1)) return false;
  step.stamp = in.i64();
  if (!in.u32(n) || n < 1 || n > static_cast<std::uint32_t>(dimension_max)) return false;
  if (!in.has_f64(n)) return false;
  Belief& belief = step.information;
  belief.xi.resize(n);
  for (Eigen::Index i = 0; i < belief.xi.size(); ++i) belief.xi(i) = in.f64();
  if (!in.u32(entries) || entries != n * (n + 1) / 2 || !in.has_f64(entries)) return false;
  belief.omega.resize(n, n);
  for (Eigen::Index i = 0; i < belief.omega.rows(); ++i) {
    for (Eigen::Index j = i; j < belief.omega.cols(); ++j) {
      belief.omega(i, j) = belief.omega(j, i) = in.f64();
    }
  }
  if (!in.u32(next) || (next != 0 && (next != n * n || !in.has_f64(next)))) return false;
  const std::uint32_t rows = next == 0 ? 0 : n;
  step.next.resize(rows, rows);
  for (Eigen::Index i = 0; i < step.next.rows(); ++i) {
    for (Eigen::Index j = 0; j < step.next.cols(); ++j) step.next(i, j) = in.f64();
  }
  return true;
}

bool read(cdr::Reader& in, TrajectoryEntry& entry) {
  std::uint32_t steps = 0;
  if (!in.u32(entry.subject) || !in.has_f64(1)) return false;
  entry.first = in.i64();
  // Before any storage is taken: a length field must not make us allocate what cannot follow.
  if (!in.u32(steps) || steps > in.left() / step_bytes_min) return false;
  entry.steps.resize(steps);
  for (TrajectoryStep& step : entry.steps) {
    if (!read(in, step)) return false;
  }
  return true;
}

}  // namespace

void encode(const TrajectoryMessage& message, std::vector<std::byte>& out) {
  Measure measure;
  write(message, measure);
  require(measure.size() < std::numeric_limits<std::uint32_t>::max(),
          "encode: too much for one message");
  cdr::Writer writer = cdr::begin(measure.size(), out);
  write(message, writer);
}

bool decode(std::span<const std::byte> bytes, TrajectoryMessage& out) {
  auto in = cdr::body_of(bytes);
  std::uint32_t count = 0;
  if (!in || !in->u32(out.incarnation) || !in->u32(out.count) || !in->u32(count)) return false;
  if (count > in->left() / entry_bytes_min) return false;
  out.trajectories.resize(count);
  for (TrajectoryEntry& entry : out.trajectories) {
    if (!read(*in, entry)) return false;
  }
  return in->left() == 0;
}

}  // namespace hearsay::gaussian
