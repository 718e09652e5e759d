#include "filters/trails/space.hpp"

#include <algorithm>
#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::trails {
namespace {

constexpr std::uint32_t bits_least = 6;

std::int32_t cell_number(double coordinate_m, double cell_m) {
  return static_cast<std::int32_t>(std::floor(coordinate_m / cell_m));
}

}  // namespace

MetricIndex::MetricIndex(const Options& options) : cell_m_(options.cell_m) {
  require(cell_m_ >= 0.01 && cell_m_ <= 1e6, "metric index: a cell is 0.01 … 1e6 m wide");
  resize_lists(bits_least);
}

void MetricIndex::add(std::uint32_t slot, EventId event, const Point& at) {
  require(MetricSpace::sound(at), "metric index: a position that is not sound");
  require(slot < unused, "metric index: a slot that cannot be");
  if (slot >= nodes_.size()) nodes_.resize(std::size_t{slot} + 1);
  require(nodes_[slot].before == unused, "metric index: the slot is in use");
  nodes_[slot].at = at;
  nodes_[slot].event = event;
  link(slot);
  if (++size_ > heads_.size()) resize_lists(bits_ + 1);
}

void MetricIndex::remove(std::uint32_t slot) {
  require(slot < nodes_.size() && nodes_[slot].before != unused,
          "metric index: the slot is not in use");
  Node& node = nodes_[slot];
  if (node.before == none) {
    heads_[list_of(node.event, cell_of(node.at))] = node.next;
  } else {
    nodes_[node.before].next = node.next;
  }
  if (node.next != none) nodes_[node.next].before = node.before;
  node.before = unused;
  --size_;
}

void MetricIndex::link(std::uint32_t slot) {
  Node& node = nodes_[slot];
  std::uint32_t& head = heads_[list_of(node.event, cell_of(node.at))];
  node.next = head;
  node.before = none;
  if (head != none) nodes_[head].before = slot;
  head = slot;
}

void MetricIndex::resize_lists(std::uint32_t bits) {
  bits_ = bits;
  mask_ = (std::uint32_t{1} << bits) - 1;
  stride_ = (2654435769U >> (32 - bits)) | 1U;  // 2^32/φ: rows lie far apart in the lists
  heads_.assign(std::size_t{mask_} + 1, none);
  for (std::uint32_t slot = 0; slot < nodes_.size(); ++slot) {
    if (nodes_[slot].before != unused) link(slot);
  }
}

MetricIndex::Sight::Sight(const MetricReach& reach)
    : at(reach.at), radius_m(reach.radius_m), radius_squared(reach.radius_m * reach.radius_m) {
  require(MetricSpace::sound(at), "metric reach: a position that is not sound");
  require(radius_m >= 0.0, "metric reach: the radius is at least 0");
  if (!reach.field) return;
  const Field& field = *reach.field;
  require(std::isfinite(field.heading_rad), "metric reach: the heading must be finite");
  require(field.width_rad > 0.0 && field.width_rad <= 2.0 * math::pi,
          "metric reach: a field is in (0, 2π] wide");
  if (field.width_rad == 2.0 * math::pi) return;
  has_field = true;
  heading_x = math::cos(field.heading_rad);
  heading_y = math::sin(field.heading_rad);
  edge_cos = math::cos(0.5 * field.width_rad);
}

MetricIndex::Cell MetricIndex::cell_of(const Point& at) const {
  return {cell_number(at.x_m, cell_m_), cell_number(at.y_m, cell_m_)};
}

bool MetricIndex::is_in(const Point& at, const Cell& cell) const {
  const Cell of = cell_of(at);
  return of.column == cell.column && of.row == cell.row;
}

bool MetricIndex::lists_shared(const Block& block) const {
  // A block has no more columns than there are lists. Rows apart by so many lie so far apart in the
  // lists, one way round or the other.
  const auto columns = static_cast<std::uint32_t>(block.last.column - block.first.column) + 1;
  const auto rows = static_cast<std::uint32_t>(block.last.row - block.first.row) + 1;
  for (std::uint32_t apart = 1; apart < rows; ++apart) {
    const std::uint32_t lists = (apart * stride_) & mask_;
    if (lists < columns || mask_ + 1 - lists < columns) return true;
  }
  return false;
}

MetricIndex::Block MetricIndex::block_of(const Sight& sight) const {
  // A little wider, so that rounding leaves nobody out. In double first: it may be infinite.
  const double radius_m = sight.radius_m * (1.0 + 1e-9);
  const double column = std::floor((sight.at.x_m - radius_m) / cell_m_);
  const double row = std::floor((sight.at.y_m - radius_m) / cell_m_);
  const double last_column = std::floor((sight.at.x_m + radius_m) / cell_m_);
  const double last_row = std::floor((sight.at.y_m + radius_m) / cell_m_);
  const double cells = (last_column - column + 1.0) * (last_row - row + 1.0);
  if (!(cells < static_cast<double>(std::max<std::size_t>(size_, 9)))) return {.all = true};
  return {false,
          {static_cast<std::int32_t>(column), static_cast<std::int32_t>(row)},
          {static_cast<std::int32_t>(last_column), static_cast<std::int32_t>(last_row)}};
}

}  // namespace hearsay::trails
