#include "agents/grids/grid_belief.hpp"

#include <algorithm>
#include <type_traits>

#include "filters/grid/gain.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using Grid = std::variant<grid::BernoulliGrid, grid::BetaGrid>;

Grid made(const grid::Area& area, const GridBelief::Options& options) {
  if (const auto* bernoulli = std::get_if<grid::BernoulliGrid::Options>(&options)) {
    return grid::BernoulliGrid(area, *bernoulli);
  }
  return grid::BetaGrid(area, std::get<grid::BetaGrid::Options>(options));
}

}  // namespace

GridBelief::GridBelief(const grid::Area& area, const Options& options)
    : grid_(made(area, options)) {}

const grid::Area& GridBelief::area() const {
  return std::visit([](const auto& g) -> const grid::Area& { return g.area(); }, grid_);
}

grid::Shape GridBelief::shape() const {
  return std::visit(
      [](const auto& g) {
        return grid::Shape{g.area().cells(), std::remove_cvref_t<decltype(g)>::layers};
      },
      grid_);
}

std::span<const float> GridBelief::evidence() const {
  return std::visit([](const auto& g) { return g.evidence(); }, grid_);
}

void GridBelief::assign(std::span<const float> evidence) {
  const std::span<float> own = std::visit([](auto& g) { return g.evidence_mutable(); }, grid_);
  require(evidence.size() == own.size(), "GridBelief: evidence of a grid of another shape");
  std::ranges::copy(evidence, own.begin());
}

void GridBelief::add(std::span<const grid::CellLook> looks) {
  std::visit([&](auto& g) { grid::add(looks, g); }, grid_);
}

void GridBelief::fuse(grid::Rule rule, const grid::Heard& heard, double omega) {
  std::visit([&](auto& g) { grid::fuse(rule, g, heard, omega); }, grid_);
}

void GridBelief::shares(grid::Rule rule, const grid::Heard& heard, double omega,
                        std::span<grid::Shares> out) const {
  std::visit([&](const auto& g) { grid::shares(rule, g, heard, omega, out); }, grid_);
}

void GridBelief::clear() {
  std::visit([](auto& g) { g.clear(); }, grid_);
}

double GridBelief::expected_gain(std::span<const grid::CellInView> cells) const {
  return std::visit([&](const auto& g) { return grid::expected_gain(g, cells); }, grid_);
}

std::optional<double> GridBelief::probability(int cell) const {
  if (const auto* bernoulli = std::get_if<grid::BernoulliGrid>(&grid_)) {
    return bernoulli->probability(cell);
  }
  return std::get<grid::BetaGrid>(grid_).mean(cell);
}

std::optional<grid::Beta> GridBelief::beta(int cell) const {
  const auto* beta = std::get_if<grid::BetaGrid>(&grid_);
  if (beta == nullptr) return std::nullopt;
  return beta->at(cell);
}

std::optional<double> GridBelief::total_entropy() const {
  return std::visit([](const auto& g) { return std::optional<double>(g.total_entropy()); }, grid_);
}

std::optional<double> GridBelief::divergence(const GridBelief& other) const {
  require(grid_.index() == other.grid_.index(), "GridBelief: grids of two kinds do not compare");
  return std::visit(
      [&](const auto& g) {
        using Kind = std::remove_cvref_t<decltype(g)>;
        return std::optional<double>(g.divergence(std::get<Kind>(other.grid_)));
      },
      grid_);
}

int GridBelief::mark_above(double threshold, std::vector<unsigned char>& marks) const {
  return std::visit([&](const auto& g) { return g.mark_above(threshold, marks); }, grid_);
}

std::span<const grid::Region> GridBelief::regions(grid::RegionFinder& finder,
                                                  double threshold) const {
  return std::visit([&](const auto& g) { return finder.find(g, threshold); }, grid_);
}

}  // namespace hearsay
