#include "net/live/topics.hpp"

#include <hearsay/idl/air.h>
#include <hearsay/idl/live.h>

#include <algorithm>
#include <array>
#include <optional>

#include "net/live/descriptors.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::live {
namespace {

constexpr std::string_view air_prefix = "hearsay_air_";

/// The kinds of Gaussian beliefs that have no other form over a window of time.
struct GaussianKind {
  std::string_view name;
  Type still, moving;
};
constexpr std::array<GaussianKind, 6> gaussian_kinds = {{
    {"gaussian", Type::gaussian, Type::stamped_gaussian},
    {"gaussian-split", Type::split, Type::stamped_split},
    {"gaussian-consensus", Type::consensus, Type::stamped_consensus},
    {"gaussian-hybrid", Type::hybrid, Type::stamped_hybrid},
    {"gaussian-diagonal", Type::diagonal, Type::stamped_diagonal},
    {"gaussian-quantised", Type::quantised, Type::stamped_quantised},
}};

/// The kinds of which the name says all.
struct PlainKind {
  std::string_view name;
  Type type;
};
constexpr std::array<PlainKind, 5> plain_kinds = {{
    {"position", Type::stamped_gaussian},
    {"tracks", Type::stamped_gaussian},
    {"trails", Type::trajectory},
    {"trail", Type::trail},
    {"acknowledgement", Type::acknowledgement},
}};

bool is_letter_or_digit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

std::string air_name(std::string_view kind) {
  std::string name(air_prefix);
  for (const char c : kind) name += is_letter_or_digit(c) ? c : '_';
  return name;
}

std::optional<TopicId> gaussian_topic(std::string_view kind, States states) {
  const auto* known = std::find_if(gaussian_kinds.begin(), gaussian_kinds.end(),
                                   [&](const GaussianKind& k) { return k.name == kind; });
  if (known == gaussian_kinds.end()) return std::nullopt;
  switch (states) {
    case States::still:
      return TopicId{known->still, air_name(kind)};
    case States::moving:
      return TopicId{known->moving, air_name(kind) + "_moving"};
    case States::trajectory:
      return TopicId{Type::trajectory, air_name(kind) + "_trajectory"};
  }
  broken("air_topic: an unknown kind of state");
}

std::vector<TopicId> grid_topics() {
  return {{Type::whole_grid, air_name("grid_whole")},
          {Type::changed_grid, air_name("grid_changed")},
          {Type::grid_runs, air_name("grid_runs")}};
}

}  // namespace

TopicId hello_topic() { return {Type::hello, "hearsay_hello"}; }
TopicId welcome_topic() { return {Type::welcome, "hearsay_welcome"}; }
TopicId order_topic() { return {Type::frame, "hearsay_order"}; }
TopicId answer_topic() { return {Type::frame, "hearsay_answer"}; }
TopicId clock_topic() { return {Type::clock, "hearsay_clock"}; }
TopicId measurement_topic() { return {Type::measurement, "hearsay_measurement"}; }
TopicId truth_topic() { return {Type::truth, "hearsay_truth"}; }
TopicId report_topic() { return {Type::report, "hearsay_report"}; }

std::vector<TopicId> air_topics(std::string_view kind, States states) {
  require(!kind.empty(), "air_topics: a kind has a name");
  if (kind == "grid") return grid_topics();
  if (auto topic = gaussian_topic(kind, states)) return {*std::move(topic)};
  for (const PlainKind& known : plain_kinds) {
    if (known.name == kind) return {{known.type, air_name(kind)}};
  }
  return {{Type::octets, air_name(kind)}};
}

TopicId air_topic(std::string_view kind, States states, std::span<const std::byte> message) {
  std::vector<TopicId> topics = air_topics(kind, states);
  if (topics.size() == 1) return std::move(topics.front());
  constexpr std::size_t form_at = 4 + 20;  // behind the header and five words of GridHead
  require(message.size() > form_at, "air_topic: a message that is no grid");
  const auto form = std::to_integer<std::size_t>(message[form_at]);
  require(form < topics.size(), "air_topic: a grid of an unknown form");
  return std::move(topics[form]);
}

bool is_fleet_name(std::string_view name) {
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
    return is_letter_or_digit(c) || c == '-' || c == '_';
  });
}

std::string fleet_partition(std::string_view fleet) { return std::string(fleet); }
std::string agent_partition(std::string_view fleet, std::uint32_t agent) {
  return std::string(fleet) + '.' + std::to_string(agent);
}
std::string air_partition(std::string_view fleet) { return std::string(fleet) + ".air"; }

const dds_topic_descriptor_t& descriptor_of(Type type) {
  static const std::array<const dds_topic_descriptor_t*, type_count> all = {
      &hearsay_Hello_desc,
      &hearsay_Welcome_desc,
      &hearsay_Frame_desc,
      &hearsay_Clock_desc,
      &hearsay_Measurement_desc,
      &hearsay_Truth_desc,
      &hearsay_Report_desc,
      &hearsay_GaussianPacket_desc,
      &hearsay_SplitPacket_desc,
      &hearsay_ConsensusPacket_desc,
      &hearsay_HybridPacket_desc,
      &hearsay_DiagonalPacket_desc,
      &hearsay_QuantisedPacket_desc,
      &hearsay_StampedGaussianPacket_desc,
      &hearsay_StampedSplitPacket_desc,
      &hearsay_StampedConsensusPacket_desc,
      &hearsay_StampedHybridPacket_desc,
      &hearsay_StampedDiagonalPacket_desc,
      &hearsay_StampedQuantisedPacket_desc,
      &hearsay_TrajectoryPacket_desc,
      &hearsay_WholeGridPacket_desc,
      &hearsay_ChangedGridPacket_desc,
      &hearsay_GridRunsPacket_desc,
      &hearsay_TrailPacket_desc,
      &hearsay_AcknowledgementPacket_desc,
      &hearsay_OctetsPacket_desc,
  };
  return *all[static_cast<std::size_t>(type)];
}

}  // namespace hearsay::live
