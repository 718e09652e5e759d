// Fleets of agents that look at a grid and talk about it, each grid with its ledger and, for
// comparison, the same weights in plain arrays.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "filters/grid/ledger.hpp"
#include "tests/filters/grid/samples.hpp"

namespace hearsay::grid {

/// Weights by number and look, all in double, every sum written out.
class PlainWeights {
 public:
  PlainWeights(std::size_t numbers, std::size_t looks)
      : weights_(numbers, std::vector<double>(looks)) {}
  std::vector<double>& operator[](std::size_t number) { return weights_[number]; }
  const std::vector<double>& operator[](std::size_t number) const { return weights_[number]; }
  void set_sum(std::size_t number, const Shares& s, const PlainWeights& own,
               const PlainWeights& heard, const PlainWeights& common) {
    for (std::size_t k = 0; k < weights_[number].size(); ++k) {
      weights_[number][k] =
          s.own * own[number][k] + s.heard * heard[number][k] - s.common * common[number][k];
    }
  }

 private:
  std::vector<std::vector<double>> weights_;
};

/// Evidence and what is known of where it is from.
struct Told {
  std::vector<float> evidence;
  LookLedger ledger;
  PlainWeights plain;
};

template <typename Grid>
class Fleet {
 public:
  using Link = std::pair<std::size_t, std::size_t>;
  static constexpr std::size_t looks_max = 64;  // a cell
  struct Setup {
    Rule rule;
    std::size_t agents;
    std::vector<Link> links;
    double omega = usual_omega;
  };

  Fleet(const Setup& setup, const Grid& prior)
      : setup_(setup),
        shape_{prior.area().cells(), Grid::layers},
        book_(shape_),
        nothing_{copy_of(prior), LookLedger(shape_), PlainWeights(numbers(), looks_max)},
        told_(setup.agents, nothing_),
        grids_(setup.agents, prior),
        memory_(setup.agents * setup.agents, nothing_) {}

  std::size_t numbers() const { return nothing_count(shape_); }
  const LookBook& book() const { return book_; }
  const Grid& grid(std::size_t agent) const { return grids_[agent]; }
  const LookLedger& ledger(std::size_t agent) const { return told_[agent].ledger; }
  const PlainWeights& plain(std::size_t agent) const { return told_[agent].plain; }
  const std::vector<Link>& links() const { return setup_.links; }

  void look(std::size_t agent, const CellLook& look) {
    const std::uint32_t index = book_.add(look);
    add(std::span(&look, 1), grids_[agent]);
    told_[agent].ledger.looked(look.cell, index);
    for (std::size_t layer = 0; layer < Grid::layers; ++layer) {
      told_[agent].plain[static_cast<std::size_t>(look.cell) * Grid::layers + layer][index] += 1.0;
    }
  }

  /// Puts a message under way.
  void send(std::size_t from, std::size_t to) {
    Told said = told_[from];
    said.evidence = copy_of(grids_[from]);
    Told& memory = memory_of(from, to);
    if (info(setup_.rule).sends == Sends::evidence_less_heard) {
      less_heard(grids_[from].evidence(), memory.evidence, said.evidence);
      said.ledger.clear();
      said.ledger.difference(told_[from].ledger, memory.ledger);
      for (std::size_t i = 0; i < numbers(); ++i) {
        said.plain.set_sum(i, {1.0, 0.0, 1.0}, told_[from].plain, nothing_.plain, memory.plain);
      }
    }
    if (info(setup_.rule).memory == Memory::last_exchanged) memory = said;
    under_way_.push_back({from, to, std::move(said)});
  }
  std::size_t under_way() const { return under_way_.size(); }
  /// The n-th of the messages under way arrives, or the part of it from `first` on; returns at
  /// whom.
  std::size_t deliver(std::size_t n, int first_cell, int cells) {
    const Message message = std::move(under_way_[n]);
    under_way_.erase(under_way_.begin() + static_cast<std::ptrdiff_t>(n));
    Told& own = told_[message.to];
    Told& memory = memory_of(message.to, message.from);
    const std::size_t first = static_cast<std::size_t>(first_cell) * Grid::layers;
    const std::size_t count = static_cast<std::size_t>(cells) * Grid::layers;
    const Heard heard{first_cell, std::span(message.said.evidence).subspan(first, count),
                      std::span(memory.evidence).subspan(first, count)};
    std::vector<Shares> coefficients(count);
    shares(setup_.rule, grids_[message.to], heard, setup_.omega, coefficients);
    fuse(setup_.rule, grids_[message.to], heard, setup_.omega);
    own.ledger.combine(first_cell, coefficients, message.said.ledger, &memory.ledger);
    for (std::size_t i = 0; i < count; ++i) {
      own.plain.set_sum(first + i, coefficients[i], own.plain, message.said.plain, memory.plain);
    }
    if (info(setup_.rule).memory == Memory::nothing) return message.to;
    std::copy_n(heard.received.begin(), count,
                memory.evidence.begin() + static_cast<std::ptrdiff_t>(first));
    memory.ledger.copy_range(first_cell, cells, message.said.ledger);
    for (std::size_t i = first; i < first + count; ++i) {
      memory.plain[i] = message.said.plain[i];
    }
    return message.to;
  }
  void exchange(std::size_t from, std::size_t to) {
    send(from, to);
    deliver(under_way_.size() - 1, 0, shape_.cells);
  }

  /// One random thing: a look at ten cells, a message, or the arrival of one, whole or in part.
  /// Returns whose grid it was about.
  std::size_t step(Stream& random, bool with_looks, double scale) {
    const std::uint64_t kind = random.below(4);
    if (kind == 0 && with_looks) return look_around(random, scale);
    if (kind == 1 || under_way_.empty()) {
      Link link = setup_.links[random.below(setup_.links.size())];
      if (random.bernoulli(0.5)) std::swap(link.first, link.second);
      send(link.first, link.second);
      return link.first;
    }
    const auto cells = static_cast<std::uint64_t>(shape_.cells);
    auto from = static_cast<int>(random.below(cells + 1));
    auto to = static_cast<int>(random.below(cells + 1));
    if (from > to || random.bernoulli(0.3)) from = 0, to = shape_.cells;
    return deliver(random.below(under_way_.size()), from, to - from);
  }

 private:
  struct Message {
    std::size_t from, to;
    Told said;
  };
  static std::size_t nothing_count(const Shape& shape) {
    return static_cast<std::size_t>(shape.cells) * shape.layers;
  }
  Told& memory_of(std::size_t whose, std::size_t about) {
    return memory_[whose * setup_.agents + about];
  }
  std::size_t look_around(Stream& random, double scale) {
    const std::size_t agent = random.below(setup_.agents);
    const auto first = random.below(static_cast<std::uint64_t>(shape_.cells - 9));
    for (int i = 0; i < 10; ++i) {
      const double m = random.bernoulli(0.3) ? 0.0 : random.exponential(1.0);
      look(agent, {static_cast<int>(first) + i, scale * random.normal(), scale * m,
                   scale * random.exponential(1.0)});
    }
    return agent;
  }

  Setup setup_;
  Shape shape_;
  LookBook book_;
  Told nothing_;
  std::vector<Told> told_;
  std::vector<Grid> grids_;
  std::vector<Told> memory_;
  std::vector<Message> under_way_;
};

/// Four agents, each beside two others, or everyone beside everyone, or around the second.
inline std::vector<std::pair<std::size_t, std::size_t>> ring() {
  return {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
}
inline std::vector<std::pair<std::size_t, std::size_t>> full_graph() {
  return {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
}
inline std::vector<std::pair<std::size_t, std::size_t>> tree() { return {{0, 1}, {1, 2}, {1, 3}}; }

}  // namespace hearsay::grid
