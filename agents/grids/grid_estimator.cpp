#include "agents/grids/grid_estimator.hpp"

#include <algorithm>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay {

GridEstimator::GridEstimator(const grid::Area& area, const Options& options,
                             RiderPool<GridRider>* riders)
    : options_(options), belief_(area, options.belief), riders_(riders), ledger_(belief_.shape()) {
  const grid::RuleInfo& rule = grid::info(options_.rule);
  const std::size_t layers = belief_.shape().layers;
  require(layers == 1 ? rule.bernoulli : rule.beta,
          "GridEstimator: the rule is not for grids of this kind");
  require(grid::blocks_that_fit(options_.form, layers, options_.packet_bytes) > 0 &&
              grid::blocks_that_fit(grid::Form::whole, layers, options_.packet_bytes) > 0,
          "GridEstimator: no cell fits into a packet");
  require(options_.whole_every >= 0, "GridEstimator: whole_every must not be negative");
}

void GridEstimator::looked(std::span<const grid::CellLook> looks,
                           std::span<const std::uint32_t> indices) {
  belief_.add(looks);
  if (riders_) {
    require(indices.size() == looks.size(), "GridEstimator: a look has no index");
    for (std::size_t i = 0; i < looks.size(); ++i) ledger_.looked(looks[i].cell, indices[i]);
  }
  counts_.looks += looks.size();
}

bool GridEstimator::addresses() const {
  return grid::info(options_.rule).sends == grid::Sends::evidence_less_heard;
}

GridEstimator::Other& GridEstimator::other(AgentId id) {
  const auto at = std::lower_bound(others_.begin(), others_.end(), id,
                                   [](const Other& o, AgentId wanted) { return o.id < wanted; });
  if (at != others_.end() && at->id == id) return *at;
  Other fresh;
  fresh.id = id;
  fresh.common_ledger = grid::LookLedger(belief_.shape());
  return *others_.insert(at, std::move(fresh));
}

std::span<const float> GridEstimator::evidence_for(AgentId receiver) {
  if (!addresses()) return belief_.evidence();
  const Other& to = other(receiver);
  if (to.common.empty()) return belief_.evidence();
  less_.resize(belief_.evidence().size());
  grid::less_heard(belief_.evidence(), to.common, less_);
  return less_;
}

bool GridEstimator::tells_nothing(std::span<const float> evidence) const {
  return std::all_of(evidence.begin(), evidence.end(), [](float e) { return e == 0.0F; });
}

std::span<const std::vector<std::byte>> GridEstimator::speech(AgentId receiver,
                                                              std::uint64_t talk) {
  if (grid::info(options_.rule).sends == grid::Sends::nothing) return {};
  grid::Encoder::Message message;
  message.evidence = evidence_for(receiver);
  message.form = options_.form;
  if (options_.form == grid::Form::changed) {
    std::vector<float>* told = &sent_;
    if (addresses()) told = &other(receiver).sent;
    if (told->empty()) told->assign(message.evidence.size(), 0.0F);
    message.sent = *told;
    const bool whole =
        options_.whole_every > 0 && talk % static_cast<std::uint64_t>(options_.whole_every) == 0;
    if (whole) message.form = grid::Form::whole;
    if (!whole && std::ranges::equal(message.evidence, message.sent)) return {};
  }
  if (message.form != grid::Form::changed && tells_nothing(message.evidence)) return {};
  make_rider(receiver);
  message.incarnation = incarnation_;
  message.count = next_count_++;
  return encoder_.encode(message, belief_.shape(), options_.packet_bytes);
}

void GridEstimator::make_rider(AgentId receiver) {
  if (!riders_) return;
  GridRider* rider = nullptr;
  rider_ = riders_->make(rider);
  if (addresses()) {
    if (rider->ledger.shape().cells == 0) rider->ledger = grid::LookLedger(belief_.shape());
    rider->ledger.difference(ledger_, other(receiver).common_ledger);
  } else {
    rider->ledger = ledger_;
  }
}

void GridEstimator::sent(AgentId receiver, std::span<const std::byte> packet,
                         std::span<const AgentId> listeners) {
  const bool exchanged = grid::info(options_.rule).memory == grid::Memory::last_exchanged;
  if (options_.form != grid::Form::changed && !exchanged) return;
  const auto said = grid::Packet::parse(packet, belief_.shape());
  require(said.has_value(), "GridEstimator: that was no packet of its own");
  if (options_.form == grid::Form::changed) {
    said->apply(addresses() ? std::span<float>(other(receiver).sent) : std::span<float>(sent_));
  }
  if (!exchanged) return;
  for (const AgentId listener : listeners) {
    std::vector<float>& common = other(listener).common;
    if (common.empty()) common.assign(belief_.evidence().size(), 0.0F);
    said->apply(common);
    if (!riders_) continue;
    const auto layers = belief_.shape().layers;
    said->for_each_range([&](int first, std::span<const float> values) {
      other(listener).common_ledger.copy_range(first, static_cast<int>(values.size() / layers),
                                               ledger_);
    });
  }
}

bool GridEstimator::is_news(Other& from, const grid::PacketHead& head) {
  const auto order = std::pair(head.incarnation, head.count);
  const auto known = std::pair(from.incarnation, from.count);
  if (from.heard && order < known) return false;
  if (!from.heard || order > known || from.parts.size() != head.parts) {
    from.heard = true;
    from.incarnation = head.incarnation;
    from.count = head.count;
    from.parts.assign(head.parts, 0);
  }
  if (from.parts[head.part] != 0) return false;
  from.parts[head.part] = 1;
  return true;
}

void GridEstimator::heard(AgentId from, std::span<const std::byte> bytes, const Rider* rider) {
  const auto packet = grid::Packet::parse(bytes, belief_.shape());
  if (!packet || options_.rule == grid::Rule::none) {
    ++counts_.refused;
    return;
  }
  Other& sender = other(from);
  if (!is_news(sender, packet->head())) {
    ++counts_.refused;
    return;
  }
  const auto* const of_grid = dynamic_cast<const GridRider*>(rider);
  const grid::LookLedger* const ledger = riders_ && of_grid ? &of_grid->ledger : nullptr;
  packet->for_each_range(
      [&](int first, std::span<const float> values) { fuse(sender, first, values, ledger); });
  ++counts_.fusions;
}

void GridEstimator::fuse(Other& from, int first_cell, std::span<const float> values,
                         const grid::LookLedger* ledger) {
  const std::size_t layers = belief_.shape().layers;
  const bool remembers = grid::info(options_.rule).memory != grid::Memory::nothing;
  if (remembers && from.common.empty()) from.common.assign(belief_.evidence().size(), 0.0F);
  std::span<float> common;
  if (remembers) {
    const auto begin = static_cast<std::size_t>(first_cell) * layers;
    common = std::span(from.common).subspan(begin, values.size());
  }
  const grid::Heard heard{.first_cell = first_cell, .received = values, .common = common};
  if (ledger) {
    shares_.resize(values.size());
    belief_.shares(options_.rule, heard, options_.omega, shares_);
    ledger_.combine(first_cell, shares_, *ledger, remembers ? &from.common_ledger : nullptr);
  }
  belief_.fuse(options_.rule, heard, options_.omega);
  if (!remembers) return;
  std::copy(values.begin(), values.end(), common.begin());
  if (ledger) {
    from.common_ledger.copy_range(first_cell, static_cast<int>(values.size() / layers), *ledger);
  }
}

void GridEstimator::forget() {
  belief_.clear();
  ledger_.clear();
  others_.clear();
  std::fill(sent_.begin(), sent_.end(), 0.0F);
  ++incarnation_;
  next_count_ = 1;
}

}  // namespace hearsay
