// What the simulator charges for on the air are the types of air.idl, byte for byte.
#include <gtest/gtest.h>

#include "filters/gaussian/trajectory_codec.hpp"
#include "filters/grid/codec.hpp"
#include "filters/trails/codec.hpp"
#include "sim/kernel/error.hpp"
#include "tests/net/live/air_bed.hpp"

namespace hearsay::live {
namespace {

using TrailPlace = trails::PlaceOf<trails::Point>;
using TrailCrumb = trails::CrumbOf<trails::Point>;

constexpr Purpose content("messages on the air");
constexpr int draws = 120;
constexpr std::size_t no_mtu = std::size_t{1} << 30;

TEST(Air, TrajectoriesAreCyclones) {
  for (std::uint64_t draw = 0; draw < draws; ++draw) {
    Stream random = Stream::at(2, content, {2}, draw);
    const int n = 1 + static_cast<int>(random.below(6));
    gaussian::TrajectoryMessage m{word(random), word(random), {}};
    for (std::uint64_t i = random.below(4); i-- > 0;) {
      auto& entry = m.trajectories.emplace_back();
      entry = {word(random), stamp(random), {}};
      const bool whole = random.bernoulli(0.5);
      for (std::uint64_t k = random.below(6); k-- > 0;) {
        gaussian::Matrix next(whole && k > 0 ? n : 0, whole && k > 0 ? n : 0);
        for (double& value : next.reshaped()) value = random.normal();
        entry.steps.push_back({stamp(random), some_belief(random, n), next});
      }
    }
    Pool pool;
    hearsay_TrajectoryMessage c{m.incarnation, m.count, {}};
    const auto entries = pool.resize(c.trajectories, m.trajectories.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const auto& entry = m.trajectories[i];
      entries[i].subject = entry.subject;
      entries[i].first_ns = entry.first;
      const auto steps = pool.resize(entries[i].steps, entry.steps.size());
      for (std::size_t k = 0; k < steps.size(); ++k) {
        steps[k].stamp_ns = entry.steps[k].stamp;
        pool.copy(steps[k].information_vector, entry.steps[k].information.xi);
        pool.triangle(steps[k].information_matrix, entry.steps[k].information.omega);
        std::vector<double> by_rows;
        for (Eigen::Index r = 0; r < entry.steps[k].next.rows(); ++r) {
          for (Eigen::Index s = 0; s < n; ++s) by_rows.push_back(entry.steps[k].next(r, s));
        }
        pool.copy(steps[k].next_block, by_rows);
      }
    }
    Bytes bytes;
    encode(m, bytes);
    expect_same(hearsay_TrajectoryMessage_desc, &c, bytes);
    expect_packet<hearsay_TrajectoryPacket>(hearsay_TrajectoryPacket_desc, c, bytes, random);
  }
}

struct Blocks {
  std::vector<std::uint32_t> firsts, lengths;
  std::vector<float> values;
};

/// Found anew, cell by cell.
Blocks blocks_of(grid::Form form, const std::vector<float>& evidence,
                 const std::vector<float>& sent, std::size_t layers) {
  Blocks blocks;
  const auto cell = [&](const std::vector<float>& of, std::size_t i) {
    return std::vector<float>(of.begin() + static_cast<std::ptrdiff_t>(i * layers),
                              of.begin() + static_cast<std::ptrdiff_t>((i + 1) * layers));
  };
  for (std::size_t i = 0; i < evidence.size() / layers; ++i) {
    const std::vector<float> now = cell(evidence, i);
    if (form == grid::Form::changed && now == cell(sent, i)) continue;
    if (form == grid::Form::runs && i > 0 && now == cell(evidence, i - 1)) {
      ++blocks.lengths.back();
      continue;
    }
    blocks.firsts.push_back(static_cast<std::uint32_t>(i));
    blocks.lengths.push_back(1);
    blocks.values.insert(blocks.values.end(), now.begin(), now.end());
  }
  return blocks;
}

TEST(Air, GridsOfAllFormsAreCyclones) {
  for (std::uint64_t draw = 0; draw < draws; ++draw) {
    Stream random = Stream::at(2, content, {3}, draw);
    const grid::Shape shape{1 + static_cast<int>(random.below(60)), 1 + random.below(2)};
    const std::size_t numbers = static_cast<std::size_t>(shape.cells) * shape.layers;
    std::vector<float> evidence(numbers), sent(numbers);
    for (float& value : evidence) value = static_cast<float>(random.below(2));
    for (float& value : sent) value = static_cast<float>(random.below(2));
    grid::Encoder encoder;
    for (const auto form : {grid::Form::whole, grid::Form::changed, grid::Form::runs}) {
      const grid::Encoder::Message m{word(random), word(random), form, evidence, sent};
      const auto packets = encoder.encode(m, shape, no_mtu);
      ASSERT_EQ(packets.size(), 1u);
      const Blocks blocks = blocks_of(form, evidence, sent, shape.layers);
      EXPECT_EQ(packets[0].size(), packet_size(form, shape.layers, blocks.firsts.size()));
      const hearsay_GridHead head{m.incarnation,
                                  m.count,
                                  0,
                                  1,
                                  static_cast<std::uint32_t>(shape.cells),
                                  static_cast<std::uint8_t>(form),
                                  static_cast<std::uint8_t>(shape.layers)};
      Pool pool;
      if (form == grid::Form::whole) {
        hearsay_WholeGrid c{head, 0, {}};
        pool.copy(c.values, blocks.values);
        expect_same(hearsay_WholeGrid_desc, &c, packets[0]);
        expect_packet<hearsay_WholeGridPacket>(hearsay_WholeGridPacket_desc, c, packets[0], random);
      } else if (form == grid::Form::changed) {
        hearsay_ChangedGrid c{head, {}, {}};
        pool.copy(c.cells, blocks.firsts);
        pool.copy(c.values, blocks.values);
        expect_same(hearsay_ChangedGrid_desc, &c, packets[0]);
        expect_packet<hearsay_ChangedGridPacket>(hearsay_ChangedGridPacket_desc, c, packets[0],
                                                 random);
      } else {
        hearsay_GridRuns c{head, {}, {}, {}};
        pool.copy(c.firsts, blocks.firsts);
        pool.copy(c.lengths, blocks.lengths);
        pool.copy(c.values, blocks.values);
        expect_same(hearsay_GridRuns_desc, &c, packets[0]);
        expect_packet<hearsay_GridRunsPacket>(hearsay_GridRunsPacket_desc, c, packets[0], random);
      }
      const dds_topic_descriptor_t* const types[] = {
          &hearsay_WholeGrid_desc, &hearsay_ChangedGrid_desc, &hearsay_GridRuns_desc};
      for (const Bytes& part : encoder.encode(m, shape, 100)) {  // cut into several
        EXPECT_EQ(through_cyclone(*types[static_cast<int>(form)], part), part);
      }
    }
  }
}

hearsay_Identity in_c(const trails::Identity& i) { return {i.robot, i.incarnation, i.number}; }

TEST(Air, TrailsAreCyclones) {
  for (std::uint64_t draw = 0; draw < draws; ++draw) {
    Stream random = Stream::at(2, content, {4}, draw);
    const auto point = [&] { return trails::point(random.normal(), random.normal()); };
    const auto identity = [&] {
      return trails::Identity{word(random), word(random), word(random)};
    };
    std::vector<TrailPlace> places;
    for (std::uint32_t i = static_cast<std::uint32_t>(random.below(4)); i-- > 0;) {
      const auto event = static_cast<trails::EventId>(3 * places.size() + 1);
      places.push_back({event, point(), random.normal(), identity()});
    }
    std::vector<TrailCrumb> crumbs;
    for (std::uint64_t i = random.below(6); i-- > 0;) {
      const auto event = static_cast<trails::EventId>(random.below(1000));
      const auto distance_m = static_cast<float>(random.uniform());
      crumbs.push_back({event, static_cast<trails::EventId>(random.below(1000)), point(),
                        distance_m, random.normal(), identity()});
    }
    const std::uint32_t sender = word(random), incarnation = word(random), count = word(random);
    trails::MetricEncoder encoder;
    const auto packets = encoder.encode({sender, incarnation, count, places, crumbs}, no_mtu);
    ASSERT_EQ(packets.size(), 1u);
    EXPECT_EQ(packets[0].size(), trails::packet_size(2, places.size(), crumbs.size()));

    Pool pool;
    hearsay_TrailPart c{{sender, incarnation, count, 0, 1, 2}, {}, {}, {}};
    std::vector<float> positions;
    const auto c_places = pool.resize(c.places, places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      c_places[i] = {places[i].time_s, places[i].event, in_c(places[i].identity)};
      positions.insert(positions.end(), {places[i].position.x_m, places[i].position.y_m});
    }
    const auto c_crumbs = pool.resize(c.crumbs, crumbs.size());
    for (std::size_t i = 0; i < crumbs.size(); ++i) {
      const TrailCrumb& crumb = crumbs[i];
      c_crumbs[i] = {crumb.created_s, crumb.event, crumb.goal, in_c(crumb.identity),
                     crumb.distance_s};
      positions.insert(positions.end(), {crumb.position.x_m, crumb.position.y_m});
    }
    pool.copy(c.positions, positions);
    expect_same(hearsay_TrailPart_desc, &c, packets[0]);
    expect_packet<hearsay_TrailPacket>(hearsay_TrailPacket_desc, c, packets[0], random);
  }
}

TEST(Air, OctetsAreCyclones) {
  for (std::uint64_t draw = 0; draw < draws; ++draw) {
    Stream random = Stream::at(2, content, {5}, draw);
    const Envelope envelope = some_envelope(random);
    const std::string kind = some_text(random, random.below(20));
    Bytes message(random.below(50));
    for (std::byte& octet : message) octet = static_cast<std::byte>(random.bits());
    Pool pool;
    hearsay_OctetsPacket c{in_c(envelope), pool.text(kind), {}};
    pool.octets(c.message, message);
    Bytes bytes;
    pack_octets(envelope, kind, message, bytes);
    expect_same(hearsay_OctetsPacket_desc, &c, bytes);
    Envelope back;
    std::string back_kind;
    std::span<const std::byte> inside;
    ASSERT_TRUE(unpack_octets(bytes, back, back_kind, inside));
    EXPECT_EQ(back, envelope);
    EXPECT_EQ(back_kind, kind);
    EXPECT_EQ(Bytes(inside.begin(), inside.end()), message);
    bytes.pop_back();
    EXPECT_FALSE(unpack_octets(bytes, back, back_kind, inside));
  }
}

TEST(Air, AnAcknowledgementIsAnEnvelope) {
  Stream random = Stream::at(2, content, {6}, 0);
  const Envelope envelope = some_envelope(random);
  const hearsay_AcknowledgementPacket c{in_c(envelope)};
  Bytes bytes;
  pack(envelope, gaussian::cdr::header, bytes);
  expect_same(hearsay_AcknowledgementPacket_desc, &c, bytes);
}

TEST(Air, WhatHasNoEnvelopeIsNoPacket) {
  Bytes bytes;
  pack({}, gaussian::cdr::header, bytes);
  Envelope envelope;
  std::span<std::byte> inside;
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_FALSE(unpack(std::span(bytes).first(length), envelope, inside)) << length;
  }
  bytes[1] = std::byte{0};  // big-endian
  EXPECT_FALSE(unpack(bytes, envelope, inside));
  EXPECT_THROW(pack({}, std::span(bytes).first(3), bytes), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::live
