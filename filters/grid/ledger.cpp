#include "filters/grid/ledger.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay::grid {
namespace {

void require_shape(const Shape& shape) {
  require(shape.cells >= 0 && shape.layers >= 1 && shape.layers <= layers_max,
          "ledger of looks: a shape that no grid has");
}
bool alike(const Shape& a, const Shape& b) { return a.cells == b.cells && a.layers == b.layers; }

/// Within bounds. Compares bits, which for floats of one sign are in the order of the numbers:
/// compilers vectorise it, and half the weights being 0 at random costs no branches.
float kept(double weight) {
  constexpr auto least = std::bit_cast<std::int32_t>(1e-30F);
  constexpr auto greatest = std::bit_cast<std::int32_t>(1e30F);
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(weight));
  const auto size = static_cast<std::int32_t>(bits & 0x7fffffffU);
  const std::int32_t bounded = size > greatest ? greatest : size;
  const std::int32_t result = size < least ? 0 : bounded;
  return std::bit_cast<float>(static_cast<std::uint32_t>(result) | (bits & 0x80000000U));
}

/// sums[k] += share·weights[from + k] for k < n, as far as there are weights.
void add(double* sums, double share, std::span<const float> weights, std::size_t from,
         std::size_t n) {
  if (from >= weights.size()) return;
  const float* const w = weights.data() + from;
  const std::size_t end = std::min(n, weights.size() - from);
  for (std::size_t k = 0; k < end; ++k) sums[k] += share * static_cast<double>(w[k]);
}

}  // namespace

LookBook::LookBook(const Shape& shape) : shape_(shape) {
  require_shape(shape);
  looks_.resize(static_cast<std::size_t>(shape.cells));
}

std::uint32_t LookBook::add(const CellLook& look) {
  require(look.cell >= 0 && look.cell < shape_.cells, "LookBook: no cell of this number");
  for (std::size_t layer = 0; layer < shape_.layers; ++layer) {
    require(std::isfinite(added(look, layer)), "LookBook: a look adds finite evidence");
  }
  std::vector<CellLook>& looks = looks_[static_cast<std::size_t>(look.cell)];
  looks.push_back(look);
  ++size_;
  return static_cast<std::uint32_t>(looks.size() - 1);
}

std::span<const CellLook> LookBook::looks(int cell) const {
  require(cell >= 0 && cell < shape_.cells, "LookBook: no cell of this number");
  return looks_[static_cast<std::size_t>(cell)];
}

double LookBook::added(const CellLook& look, std::size_t layer) const {
  if (shape_.layers == 1) return look.ratio;
  return layer == 0 ? look.m : look.n;
}

double LookBook::weighted_sum(std::size_t number, std::span<const float> weights) const {
  const std::span<const CellLook> all = looks(static_cast<int>(number / shape_.layers));
  const std::size_t layer = number % shape_.layers;
  double sum = 0.0;
  for (std::size_t k = 0; k < std::min(all.size(), weights.size()); ++k) {
    sum += static_cast<double>(weights[k]) * added(all[k], layer);
  }
  return sum;
}

LookLedger::LookLedger(const Shape& shape) : shape_(shape) {
  require_shape(shape);
  pages_.resize((numbers() + page_rows - 1) / page_rows);
}

const LookLedger::Row& LookLedger::row(std::size_t number) const {
  const std::shared_ptr<Page>& page = pages_[number / page_rows];
  return page ? (*page)[number % page_rows] : no_row;
}

LookLedger::Row& LookLedger::slot(std::size_t number) {
  std::shared_ptr<Page>& page = pages_[number / page_rows];
  if (!page) page = std::make_shared<Page>();
  if (page.use_count() > 1) page = std::make_shared<Page>(*page);
  return (*page)[number % page_rows];
}

std::span<const float> LookLedger::weights(std::size_t number) const {
  require(number < numbers(), "LookLedger: no cell of this number");
  const Row& at = row(number);
  return at ? std::span<const float>(*at) : std::span<const float>();
}

void LookLedger::looked(int cell, std::uint32_t index) {
  require(cell >= 0 && cell < shape_.cells, "LookLedger: no cell of this number");
  for (std::size_t layer = 0; layer < shape_.layers; ++layer) {
    Row& at = slot(static_cast<std::size_t>(cell) * shape_.layers + layer);
    if (!at || at.use_count() > 1) {
      constexpr std::size_t room = 4;  // for the next looks
      auto own = std::make_shared<std::vector<float>>();
      own->reserve(std::max<std::size_t>(at ? at->size() : 0, index + std::size_t{1}) + room);
      if (at) own->assign(at->begin(), at->end());
      at = std::move(own);
    }
    if (index >= at->size()) at->resize(index + std::size_t{1}, 0.0F);
    (*at)[index] = kept(static_cast<double>((*at)[index]) + 1.0);
  }
}

void LookLedger::take(std::size_t number, const Row& other) {
  if (row(number) != other) slot(number) = other;
}

std::span<const float> LookLedger::sum(const Terms& terms, std::size_t from, std::size_t size,
                                       Block& out) {
  const std::size_t n = std::min(block, size - from);
  std::array<double, block> sums;
  std::fill_n(sums.begin(), n, 0.0);
  for (const Term& term : terms) add(sums.data(), term.share, term.weights, from, n);
  for (std::size_t k = 0; k < n; ++k) out[k] = kept(sums[k]);
  return std::span(out).first(n);
}

bool LookLedger::are_sum(std::span<const float> weights, const Terms& terms) {
  Block out;
  for (std::size_t from = 0; from < weights.size(); from += block) {
    const std::span<const float> part = sum(terms, from, weights.size(), out);
    if (!std::equal(part.begin(), part.end(), weights.data() + from)) return false;
  }
  return true;
}

void LookLedger::write_sum(const Terms& terms, std::span<float> out) {
  Block apart;  // since `out` may be one of the terms
  for (std::size_t from = 0; from < out.size(); from += block) {
    const std::span<const float> part = sum(terms, from, out.size(), apart);
    std::copy(part.begin(), part.end(), out.data() + from);
  }
}

void LookLedger::put(std::size_t number, const Terms& terms) {
  std::size_t size = 0;
  for (const Term& term : terms) size = std::max(size, term.weights.size());
  const std::span<const float> present = weights(number);
  if (present.size() == size && are_sum(present, terms)) return;
  Row& at = slot(number);
  if (at && at.use_count() == 1 && at->capacity() >= size) {
    at->resize(size);  // in place: terms that look at this row still may
    write_sum(terms, *at);
    return;
  }
  auto own = std::make_shared<std::vector<float>>(size);
  write_sum(terms, *own);
  at = std::move(own);
}

void LookLedger::combine(int first_cell, std::span<const Shares> shares, const LookLedger& heard,
                         const LookLedger* common) {
  require(alike(shape_, heard.shape_) && (common == nullptr || alike(shape_, common->shape_)),
          "LookLedger: ledgers of grids of different shapes");
  require(this != &heard && this != common, "LookLedger: a ledger combined with itself");
  const std::size_t first = static_cast<std::size_t>(first_cell) * shape_.layers;
  require(first_cell >= 0 && first <= numbers() && shares.size() <= numbers() - first &&
              shares.size() % shape_.layers == 0,
          "LookLedger: a range of cells that is not in the grid");
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const std::size_t number = first + i;
    const Shares& s = shares[i];
    const Row& own = s.own != 0.0 ? row(number) : no_row;
    const Row& received = s.heard != 0.0 ? heard.row(number) : no_row;
    const Row& known = s.common != 0.0 && common != nullptr ? common->row(number) : no_row;
    // Most rows are the same as the last time: no sum then, and no row of its own.
    const bool no_news = received == known && (!received || s.heard == s.common);
    const bool agree = own == received && !known && s.own + s.heard == 1.0;
    if ((no_news && (!own || s.own == 1.0)) || agree) {
      take(number, own);
      continue;
    }
    if (!own && !known && s.heard == 1.0) {
      take(number, received);
      continue;
    }
    const auto term = [](double share, const Row& of) { return of ? Term{share, *of} : Term{}; };
    put(number, {term(s.own, own), term(s.heard, received), term(-s.common, known)});
  }
}

void LookLedger::difference(const LookLedger& own, const LookLedger& heard) {
  require(alike(shape_, own.shape_) && alike(shape_, heard.shape_),
          "LookLedger: ledgers of grids of different shapes");
  require(this != &own && this != &heard, "LookLedger: a ledger combined with itself");
  for (std::size_t page = 0; page < pages_.size(); ++page) {
    if (!heard.pages_[page]) {
      pages_[page] = own.pages_[page];
      continue;
    }
    if (own.pages_[page] == heard.pages_[page]) {
      pages_[page].reset();
      continue;
    }
    const std::size_t end = std::min(numbers(), (page + 1) * page_rows);
    for (std::size_t number = page * page_rows; number < end; ++number) {
      const Row& a = own.row(number);
      const Row& b = heard.row(number);
      if (!b) {
        take(number, a);
      } else if (a == b) {
        take(number, nullptr);
      } else {
        put(number, {Term{1.0, a ? std::span<const float>(*a) : std::span<const float>()},
                     Term{-1.0, *b}, Term{}});
      }
    }
  }
}

void LookLedger::copy_range(int first_cell, int count, const LookLedger& from) {
  require(alike(shape_, from.shape_), "LookLedger: ledgers of grids of different shapes");
  require(first_cell >= 0 && count >= 0 && first_cell <= shape_.cells &&
              count <= shape_.cells - first_cell,
          "LookLedger: a range of cells that is not in the grid");
  std::size_t number = static_cast<std::size_t>(first_cell) * shape_.layers;
  const std::size_t end = number + static_cast<std::size_t>(count) * shape_.layers;
  while (number < end) {
    const std::size_t page = number / page_rows;
    const std::size_t page_end = std::min(numbers(), (page + 1) * page_rows);
    const bool whole = number == page * page_rows && end >= page_end;
    const std::size_t stop = std::min(end, page_end);
    if (whole || pages_[page] == from.pages_[page]) {
      pages_[page] = from.pages_[page];
    } else {
      for (std::size_t i = number; i < stop; ++i) take(i, from.row(i));
    }
    number = stop;
  }
}

void LookLedger::assign(std::size_t number, std::span<const float> weights) {
  require(number < numbers(), "LookLedger: no cell of this number");
  take(number, weights.empty()
                   ? no_row
                   : std::make_shared<std::vector<float>>(weights.begin(), weights.end()));
}

void LookLedger::clear() { std::fill(pages_.begin(), pages_.end(), nullptr); }

LookMultiplicity multiplicity(const LookLedger& ledger, const LookBook& book) {
  require(alike(ledger.shape(), book.shape()), "multiplicity: shapes differ");
  LookMultiplicity out;
  double sum = 0.0;
  double max = -std::numeric_limits<double>::infinity();
  std::size_t above_one = 0, missing = 0;
  for (int cell = 0; cell < book.shape().cells; ++cell) {
    const std::span<const CellLook> looks = book.looks(cell);
    if (looks.empty()) continue;
    for (std::size_t layer = 0; layer < book.shape().layers; ++layer) {
      const std::span<const float> weights =
          ledger.weights(static_cast<std::size_t>(cell) * book.shape().layers + layer);
      for (std::size_t k = 0; k < looks.size(); ++k) {
        if (book.added(looks[k], layer) == 0.0) continue;
        const double w = k < weights.size() ? static_cast<double>(weights[k]) : 0.0;
        if (!(std::fabs(w) > 1e-6)) {
          ++missing;
          continue;
        }
        ++out.looks;
        sum += w;
        max = std::max(max, w);
        above_one += w > 1.0 + 1e-4 ? 1 : 0;
      }
    }
  }
  const std::size_t all = out.looks + missing;
  if (all > 0) out.share_missing = static_cast<double>(missing) / static_cast<double>(all);
  if (out.looks == 0) {
    out.mean = std::numeric_limits<double>::quiet_NaN();
    return out;
  }
  out.mean = sum / static_cast<double>(out.looks);
  out.max = max;
  out.share_above_one = static_cast<double>(above_one) / static_cast<double>(out.looks);
  return out;
}

double largest_gap(const LookLedger& ledger, const LookBook& book,
                   std::span<const float> evidence) {
  require(alike(ledger.shape(), book.shape()) &&
              evidence.size() == static_cast<std::size_t>(book.shape().cells) * book.shape().layers,
          "largest_gap: shapes differ");
  double gap = 0.0;
  for (std::size_t number = 0; number < evidence.size(); ++number) {
    const double sum = book.weighted_sum(number, ledger.weights(number));
    gap = std::max(gap, std::fabs(static_cast<double>(evidence[number]) - sum));
  }
  return gap;
}

}  // namespace hearsay::grid
