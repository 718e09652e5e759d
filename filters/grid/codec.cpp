#include "filters/grid/codec.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "filters/gaussian/cdr.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::grid {
namespace {

using gaussian::cdr::Reader;
using gaussian::cdr::Writer;

constexpr std::size_t head_size = 24;  // five words, two octets, to a multiple of 4

/// Bytes of a packet's body without blocks, and a block's.
struct Layout {
  std::size_t fixed, each;
};
Layout layout(Form form, std::size_t layers) {
  require(layers >= 1 && layers <= layers_max, "grid codec: one or two numbers a cell");
  switch (form) {
    case Form::whole:
      return {head_size + 8, 4 * layers};
    case Form::changed:
      return {head_size + 8, 4 + 4 * layers};
    case Form::runs:
      return {head_size + 12, 8 + 4 * layers};
  }
  broken("grid codec: an unknown form");
}

struct Block {
  std::size_t first, length;
};

bool equal_cells(std::span<const float> values, std::size_t layers, std::size_t a, std::size_t b) {
  return std::equal(values.begin() + static_cast<std::ptrdiff_t>(a * layers),
                    values.begin() + static_cast<std::ptrdiff_t>((a + 1) * layers),
                    values.begin() + static_cast<std::ptrdiff_t>(b * layers));
}

/// Walks through the blocks of a message in order.
class Blocks {
 public:
  Blocks(Form form, const Shape& shape, std::span<const float> evidence,
         std::span<const float> sent)
      : form_(form), shape_(shape), evidence_(evidence), sent_(sent) {
    const std::size_t numbers = static_cast<std::size_t>(shape.cells) * shape.layers;
    require(shape.cells >= 1 && evidence.size() == numbers,
            "grid codec: evidence does not have the length of the grid");
    require(form != Form::changed || sent.size() == numbers,
            "grid codec: what was sent does not have the length of the grid");
  }
  /// Nothing after the last.
  std::optional<Block> next() {
    const auto cells = static_cast<std::size_t>(shape_.cells);
    if (form_ == Form::changed) {
      while (at_ < cells && !changed(at_)) ++at_;
    }
    if (at_ >= cells) return std::nullopt;
    const std::size_t first = at_++;
    if (form_ == Form::runs) {
      while (at_ < cells && equal_cells(evidence_, shape_.layers, first, at_)) ++at_;
    }
    return Block{first, at_ - first};
  }
  std::span<const float> values(const Block& block) const {
    return evidence_.subspan(block.first * shape_.layers, shape_.layers);
  }
  std::size_t layers() const { return shape_.layers; }

 private:
  bool changed(std::size_t cell) const {
    for (std::size_t i = cell * shape_.layers; i < (cell + 1) * shape_.layers; ++i) {
      if (evidence_[i] != sent_[i]) return true;
    }
    return false;
  }
  Form form_;
  Shape shape_;
  std::span<const float> evidence_, sent_;
  std::size_t at_ = 0;
};

void write_head(Writer& writer, const Encoder::Message& message, const Shape& shape,
                std::size_t part, std::size_t parts) {
  writer.u32(message.incarnation);
  writer.u32(message.count);
  writer.u32(part);
  writer.u32(parts);
  writer.u32(static_cast<std::size_t>(shape.cells));
  writer.octet(static_cast<std::uint8_t>(message.form));
  writer.octet(static_cast<std::uint8_t>(shape.layers));
}

/// The next `count` blocks, after the head: each sequence is a pass of its own.
void write_blocks(Writer& writer, Form form, Blocks& blocks, std::size_t count) {
  const auto pass = [count](Blocks walk, auto&& write) {
    for (std::size_t i = 0; i < count; ++i) write(walk, *walk.next());
    return walk;
  };
  if (form == Form::whole) {
    Blocks ahead = blocks;
    writer.u32(ahead.next()->first);
  } else {
    writer.u32(count);
    pass(blocks, [&](const Blocks&, const Block& b) { writer.u32(b.first); });
  }
  if (form == Form::runs) {
    writer.u32(count);
    pass(blocks, [&](const Blocks&, const Block& b) { writer.u32(b.length); });
  }
  writer.u32(count * blocks.layers());
  blocks = pass(blocks, [&](const Blocks& walk, const Block& b) {
    for (const float value : walk.values(b)) {
      require(std::isfinite(value), "grid codec: evidence must be finite");
      writer.u32(std::bit_cast<std::uint32_t>(value));
    }
  });
}

}  // namespace

std::size_t packet_size(Form form, std::size_t layers, std::size_t blocks) {
  const Layout l = layout(form, layers);
  return gaussian::cdr::header.size() + l.fixed + l.each * blocks;
}

std::size_t blocks_that_fit(Form form, std::size_t layers, std::size_t mtu) {
  const std::size_t fixed = packet_size(form, layers, 0);
  return mtu < fixed ? 0 : (mtu - fixed) / layout(form, layers).each;
}

MessageSize message_size(Form form, const Shape& shape, std::span<const float> evidence,
                         std::span<const float> sent, std::size_t mtu) {
  const std::size_t fit = blocks_that_fit(form, shape.layers, mtu);
  require(fit >= 1, "grid codec: no block fits into the MTU");
  MessageSize size;
  Blocks blocks(form, shape, evidence, sent);
  while (blocks.next()) ++size.blocks;
  size.packets = std::max<std::size_t>(1, (size.blocks + fit - 1) / fit);
  size.bytes = size.packets * packet_size(form, shape.layers, 0) +
               size.blocks * layout(form, shape.layers).each;
  return size;
}

std::span<const std::vector<std::byte>> Encoder::encode(const Message& message, const Shape& shape,
                                                        std::size_t mtu) {
  const MessageSize size = message_size(message.form, shape, message.evidence, message.sent, mtu);
  const std::size_t fit = blocks_that_fit(message.form, shape.layers, mtu);
  if (packets_.size() < size.packets) packets_.resize(size.packets);
  Blocks blocks(message.form, shape, message.evidence, message.sent);
  for (std::size_t part = 0; part < size.packets; ++part) {
    const std::size_t count = std::min(fit, size.blocks - part * fit);
    const std::size_t bytes = packet_size(message.form, shape.layers, count);
    Writer writer = gaussian::cdr::begin(bytes - gaussian::cdr::header.size(), packets_[part]);
    write_head(writer, message, shape, part, size.packets);
    write_blocks(writer, message.form, blocks, count);
  }
  return std::span(packets_).first(size.packets);
}

// What arrives.

namespace {

std::uint32_t word(std::span<const std::byte> words, std::size_t i) {
  return gaussian::cdr::load<std::uint32_t>(words.data() + 4 * i);
}

/// A sequence of 4-byte words. False if it is not all there.
bool read_words(Reader& reader, std::span<const std::byte>& out) {
  std::uint32_t count = 0;
  if (!reader.u32(count) || count > reader.left() / 4) return false;
  out = reader.octets(std::size_t{4} * count);
  return true;
}

bool read_head(Reader& reader, const Shape& shape, PacketHead& head) {
  std::uint32_t cells = 0;
  std::uint8_t form = 0, layers = 0;
  if (!reader.u32(head.incarnation) || !reader.u32(head.count) || !reader.u32(head.part) ||
      !reader.u32(head.parts) || !reader.u32(cells) || !reader.octet(form) ||
      !reader.octet(layers)) {
    return false;
  }
  if (cells != static_cast<std::uint32_t>(shape.cells) || layers != shape.layers) return false;
  if (head.part >= head.parts || head.parts > cells) return false;
  if (form > static_cast<std::uint8_t>(Form::runs)) return false;
  head.form = static_cast<Form>(form);
  return true;
}

}  // namespace

std::optional<Packet> Packet::parse(std::span<const std::byte> bytes, const Shape& shape) {
  require(shape.cells >= 1 && shape.layers >= 1 && shape.layers <= layers_max,
          "grid codec: a grid has cells, and one or two numbers a cell");
  std::optional<Reader> reader = gaussian::cdr::body_of(bytes);
  Packet packet;
  packet.shape_ = shape;
  if (!reader || !read_head(*reader, shape, packet.head_)) return std::nullopt;
  const Form form = packet.head_.form;
  if (form == Form::whole) {
    if (!reader->u32(packet.first_)) return std::nullopt;
  } else if (!read_words(*reader, packet.firsts_)) {
    return std::nullopt;
  }
  if (form == Form::runs && !read_words(*reader, packet.lengths_)) return std::nullopt;
  if (!read_words(*reader, packet.values_) || reader->left() != 0) return std::nullopt;
  const std::size_t a_block = 4 * shape.layers;
  if (packet.values_.size() % a_block != 0) return std::nullopt;
  packet.blocks_ = packet.values_.size() / a_block;
  if (form != Form::whole && packet.firsts_.size() != 4 * packet.blocks_) return std::nullopt;
  if (form == Form::runs && packet.lengths_.size() != 4 * packet.blocks_) return std::nullopt;
  if (!packet.cells_in_order() || !packet.all_finite()) return std::nullopt;
  return packet;
}

int Packet::first_of(std::size_t block) const {
  return static_cast<int>(head_.form == Form::whole ? first_ + block : word(firsts_, block));
}

std::size_t Packet::length_of(std::size_t block) const {
  return head_.form == Form::runs ? word(lengths_, block) : 1;
}

void Packet::values_of(std::size_t block, float* out) const {
  for (std::size_t i = 0; i < shape_.layers; ++i) {
    out[i] = std::bit_cast<float>(word(values_, block * shape_.layers + i));
  }
}

bool Packet::cells_in_order() const {
  const auto cells = static_cast<std::size_t>(shape_.cells);
  if (head_.form == Form::whole) return first_ <= cells && blocks_ <= cells - first_;
  std::size_t next = 0;  // the least cell that may come
  for (std::size_t block = 0; block < blocks_; ++block) {
    const std::size_t first = word(firsts_, block), length = length_of(block);
    if (first < next || first >= cells || length < 1 || length > cells - first) return false;
    next = first + length;
  }
  return true;
}

bool Packet::all_finite() const {
  for (std::size_t i = 0; i < blocks_ * shape_.layers; ++i) {
    if (!std::isfinite(std::bit_cast<float>(word(values_, i)))) return false;
  }
  return true;
}

std::size_t Packet::next_range(Cursor& at, std::span<float> values, int& first) const {
  first = first_of(at.block) + static_cast<int>(at.within);
  const std::size_t room = values.size() / shape_.layers;
  std::size_t given = 0;
  while (at.block < blocks_ && given < room) {
    const auto next = static_cast<std::size_t>(first) + given;
    if (static_cast<std::size_t>(first_of(at.block)) + at.within != next) break;
    const std::size_t length = length_of(at.block);
    const std::size_t take = std::min(length - at.within, room - given);
    float* const out = values.data() + given * shape_.layers;
    for (std::size_t i = 0; i < take; ++i) values_of(at.block, out + i * shape_.layers);
    given += take;
    at.within += take;
    if (at.within == length) at = {at.block + 1, 0};
  }
  return given * shape_.layers;
}

void Packet::apply(std::span<float> evidence) const {
  require(evidence.size() == static_cast<std::size_t>(shape_.cells) * shape_.layers,
          "grid codec: a copy does not have the length of the grid");
  for_each_range([&](int first, std::span<const float> values) {
    std::copy(values.begin(), values.end(),
              evidence.begin() +
                  static_cast<std::ptrdiff_t>(static_cast<std::size_t>(first) * shape_.layers));
  });
}

}  // namespace hearsay::grid
