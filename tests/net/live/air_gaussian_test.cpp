// What beliefs cost on the air is the size of the types of air.idl, byte for byte.
#include <gtest/gtest.h>

#include "filters/gaussian/message_forms.hpp"
#include "tests/net/live/air_bed.hpp"

namespace hearsay::live {
namespace {

using gaussian::Message;
using gaussian::MessageExtras;
using gaussian::MessageForm;

constexpr Purpose content("beliefs on the air");
constexpr int draws = 120;

/// Message, packet, and the same of moving states. S: stamped, P: packet.
template <class P, class S, class SP, class C>
void expect_form(MessageForm form, const Message& m, const MessageExtras& extras, const C& c,
                 const dds_topic_descriptor_t* const (&types)[4], Stream& random) {
  Bytes bytes;
  encode(form, m, extras, bytes);
  expect_same(*types[0], &c, bytes);
  expect_packet<P>(*types[1], c, bytes, random);

  const gaussian::StampedMessage stamped{stamp(random), m};
  encode(form, stamped, extras, bytes);
  const S s{stamped.stamp, c};
  expect_same(*types[2], &s, bytes);
  expect_packet<SP>(*types[3], s, bytes, random);
}

struct Draw {
  Message message;
  MessageExtras extras;
  int n = 1;
};
/// Beliefs of one dimension 1 … 6, with what any form has beside them.
Draw some_beliefs(Stream& random) {
  Draw draw;
  draw.n = 1 + static_cast<int>(random.below(6));
  draw.message.incarnation = word(random);
  draw.message.count = word(random);
  draw.extras.degree = word(random);
  draw.extras.bits = 4 + static_cast<int>(random.below(13));
  for (std::uint64_t i = random.below(4); i-- > 0;) {
    draw.message.beliefs.push_back({word(random), some_belief(random, draw.n)});
    draw.extras.fresh.push_back(some_belief(random, draw.n));
    const auto quantised = quantise(draw.message.beliefs.back().belief, draw.extras.bits);
    if (!quantised) ADD_FAILURE() << "a belief that cannot be quantised";
    draw.extras.quantised.push_back(quantised.value_or(gaussian::QuantisedBelief{}));
  }
  return draw;
}

template <class C>
C head_of(const Message& m) {
  C c{};
  c.incarnation = m.incarnation;
  c.count = m.count;
  return c;
}

/// The sequence of C beliefs, filled in as `more` says beside subject and ξ.
template <class Sequence, class F>
void fill(Pool& pool, Sequence& sequence, const Message& m, F&& more) {
  const auto beliefs = pool.resize(sequence, m.beliefs.size());
  for (std::size_t i = 0; i < beliefs.size(); ++i) {
    beliefs[i].subject = m.beliefs[i].subject;
    pool.copy(beliefs[i].information_vector, m.beliefs[i].belief.xi);
    more(beliefs[i], m.beliefs[i].belief, i);
  }
}

#define HEARSAY_FORM(Name)                                                         \
  expect_form<hearsay_##Name##Packet, hearsay_Stamped##Name##Message,              \
              hearsay_Stamped##Name##Packet>(                                      \
      form, d.message, d.extras, c,                                                \
      {&hearsay_##Name##Message_desc, &hearsay_##Name##Packet_desc,                \
       &hearsay_Stamped##Name##Message_desc, &hearsay_Stamped##Name##Packet_desc}, \
      one.random)

/// One random message, whatever its form.
struct Case {
  Stream random;
  Draw d;
  Pool pool;

  explicit Case(std::uint64_t draw)
      : random(Stream::at(2, content, {1}, draw)), d(some_beliefs(random)) {}
  void sizes(MessageForm form) const {
    Bytes bytes;
    encode(form, d.message, d.extras, bytes);
    EXPECT_EQ(bytes.size(), encoded_size(form, d.message.beliefs.size(), d.n, d.extras.bits));
  }
};

template <class F>
void for_each_draw(F&& f) {
  for (std::uint64_t draw = 0; draw < draws; ++draw) {
    Case one(draw);
    f(one, one.d, one.pool);
  }
}

TEST(Air, GaussianIsCyclones) {
  for_each_draw([](Case& one, const Draw& d, Pool& pool) {
    const MessageForm form = MessageForm::plain;
    auto c = head_of<hearsay_GaussianMessage>(d.message);
    fill(pool, c.beliefs, d.message, [&](auto& to, const auto& belief, std::size_t) {
      pool.triangle(to.information_matrix, belief.omega);
    });
    HEARSAY_FORM(Gaussian);
    one.sizes(form);
    EXPECT_EQ(cyclone_bytes(hearsay_GaussianMessage_desc, &c).size(),
              gaussian::encoded_size(d.message.beliefs.size(), d.n));
  });
}

TEST(Air, SplitIsCyclones) {
  for_each_draw([](Case& one, const Draw& d, Pool& pool) {
    const MessageForm form = MessageForm::split;
    auto c = head_of<hearsay_SplitMessage>(d.message);
    fill(pool, c.beliefs, d.message, [&](auto& to, const auto& belief, std::size_t i) {
      pool.triangle(to.information_matrix, belief.omega);
      pool.triangle(to.independent_matrix, d.extras.fresh[i].omega);
    });
    HEARSAY_FORM(Split);
    one.sizes(form);
  });
}

TEST(Air, ConsensusIsCyclones) {
  for_each_draw([](Case& one, const Draw& d, Pool& pool) {
    const MessageForm form = MessageForm::consensus;
    auto c = head_of<hearsay_ConsensusMessage>(d.message);
    c.degree = d.extras.degree;
    fill(pool, c.beliefs, d.message, [&](auto& to, const auto& belief, std::size_t) {
      pool.triangle(to.information_matrix, belief.omega);
    });
    HEARSAY_FORM(Consensus);
    one.sizes(form);
  });
}

TEST(Air, HybridIsCyclones) {
  for_each_draw([](Case& one, const Draw& d, Pool& pool) {
    const MessageForm form = MessageForm::hybrid;
    auto c = head_of<hearsay_HybridMessage>(d.message);
    c.degree = d.extras.degree;
    fill(pool, c.beliefs, d.message, [&](auto& to, const auto& belief, std::size_t i) {
      pool.triangle(to.information_matrix, belief.omega);
      pool.copy(to.fresh_vector, d.extras.fresh[i].xi);
      pool.triangle(to.fresh_matrix, d.extras.fresh[i].omega);
    });
    HEARSAY_FORM(Hybrid);
    one.sizes(form);
  });
}

TEST(Air, DiagonalIsCyclones) {
  for_each_draw([](Case& one, const Draw& d, Pool& pool) {
    const MessageForm form = MessageForm::diagonal;
    auto c = head_of<hearsay_DiagonalMessage>(d.message);
    fill(pool, c.beliefs, d.message, [&](auto& to, const auto& belief, std::size_t) {
      const gaussian::Vector diagonal = belief.omega.diagonal();
      pool.copy(to.diagonal, diagonal);
    });
    HEARSAY_FORM(Diagonal);
    one.sizes(form);
  });
}

/// As message_forms.hpp has the body, bit by bit.
Bytes quantised_body(const gaussian::QuantisedBelief& q, int bits) {
  Bytes body;
  for (std::size_t i = 0; i < static_cast<std::size_t>(q.dimension); ++i) {
    body.push_back(static_cast<std::byte>(q.exponents[i]));
    for (int k = 0; k < 4; ++k) body.push_back(static_cast<std::byte>(q.means[i] >> (8 * k)));
  }
  const std::size_t start = body.size();
  const int entries = q.dimension * (q.dimension + 1) / 2;
  body.resize(start + static_cast<std::size_t>(entries * bits + 7) / 8);
  for (int b = 0; b < entries * bits; ++b) {
    const bool set = (q.entries[static_cast<std::size_t>(b / bits)] >> (b % bits) & 1) != 0;
    if (set) body[start + static_cast<std::size_t>(b / 8)] |= static_cast<std::byte>(1 << b % 8);
  }
  return body;
}

TEST(Air, QuantisedIsCyclones) {
  for_each_draw([](Case& one, const Draw& d, Pool& pool) {
    const MessageForm form = MessageForm::quantised;
    auto c = head_of<hearsay_QuantisedMessage>(d.message);
    c.dimension = static_cast<std::uint8_t>(d.message.beliefs.empty() ? 0 : d.n);
    c.bits = static_cast<std::uint8_t>(d.extras.bits);
    const auto beliefs = pool.resize(c.beliefs, d.message.beliefs.size());
    for (std::size_t i = 0; i < beliefs.size(); ++i) {
      beliefs[i].subject = d.message.beliefs[i].subject;
      const Bytes body = quantised_body(d.extras.quantised[i], d.extras.bits);
      pool.octets(beliefs[i].body, body);
    }
    HEARSAY_FORM(Quantised);
    one.sizes(form);
  });
}

}  // namespace
}  // namespace hearsay::live
