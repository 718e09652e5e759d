#include "net/gossip_frame.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "sim/kernel/random.hpp"

namespace hearsay::gossip {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes(std::initializer_list<int> values) {
  Bytes all;
  for (const int value : values) all.push_back(static_cast<std::byte>(value));
  return all;
}

const Bundle bundle{.written = Time::nanoseconds(0x0102030405060708),
                    .origin = 5,
                    .incarnation = 2,
                    .sequence = 0x01020304,
                    .addressee = no_agent,
                    .kind = 0x0a0b,
                    .hops_left = 9};

TEST(GossipFrame, ABundleIsTheseBytes) {
  Bytes frame;
  encode(bundle, bytes({0x77, 0x88}), frame);
  EXPECT_EQ(frame, bytes({1, 9,    0x0b, 0x0a, 5,    0, 0, 0, 2, 0, 0, 0, 4, 3,    2,
                          1, 0xfe, 0xff, 0xff, 0xff, 8, 7, 6, 5, 4, 3, 2, 1, 0x77, 0x88}));
  EXPECT_EQ(frame.size(), bundle_bytes + 2);
}

TEST(GossipFrame, ASlotIsTheseBytes) {
  Bytes frame;
  encode(Slot{.key = Slot::key_of(0x0a0b, 0x010203040506),
              .version = {.written = Time::nanoseconds(256), .writer = 3}},
         bytes({0x77}), frame);
  EXPECT_EQ(frame,
            bytes({3, 6, 5, 4, 3, 2, 1, 0x0b, 0x0a, 3, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0x77}));
  EXPECT_EQ(frame.size(), slot_bytes + 1);
}

TEST(GossipFrame, ASummaryIsTheseBytes) {
  Seen seen{.source = Bundle{.origin = 1, .incarnation = 2}.source(), .window = {}};
  seen.window.mark(0);
  seen.window.mark(3);
  Bytes frame;
  encode(Range{.first = 1}, std::span(&seen, 1), frame);
  EXPECT_EQ(frame, bytes({2,    1,    0,    0,    0, 0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff,
                          0xff, 0xff, 0xff, 0xff, 2, 0, 0, 0, 1, 0,    0,    0,    1,
                          0,    0,    0,    1,    4, 0, 0, 0, 0, 0,    0,    0}));
  EXPECT_EQ(frame.size(), range_bytes + encoded_size(seen));
  encode(Range{}, std::span<const Slot>(), frame);
  EXPECT_EQ(frame.size(), range_bytes);
}

TEST(GossipFrame, AnEarlierVersionIsLessAndOfTwoAtOnceTheLowerWriters) {
  const auto version = [](int ns, AgentId writer) {
    return Version{.written = Time::nanoseconds(ns), .writer = writer};
  };
  EXPECT_LT(version(1, 7), version(2, 0));
  EXPECT_LT(version(2, 0), version(2, 1));
  EXPECT_EQ(version(2, 1), version(2, 1));
}

// A frame of each type, with contents drawn.
class Frames {
 public:
  explicit Frames(std::uint64_t seed) : draws_(seed, Purpose("frames test"), Entity::agent(0)) {}

  Bytes next() {
    Bytes frame;
    switch (draws_.below(4)) {
      case 0:
        encode(Bundle{.written = time(),
                      .origin = agent(),
                      .incarnation = u32(),
                      .sequence = u32() - (u32() == UINT32_MAX ? 1 : 0),
                      .addressee = draws_.below(2) == 0 ? no_agent : agent(),
                      .kind = static_cast<NameId>(draws_.below(65536)),
                      .hops_left = static_cast<std::uint8_t>(draws_.below(256))},
               payload(), frame);
        break;
      case 1:
        encode(Slot{.key = draws_.bits(), .version = {time(), agent()}}, payload(), frame);
        break;
      case 2: {
        std::vector<Seen> entries(draws_.below(5));
        std::uint64_t source = 0;
        for (Seen& entry : entries) {
          entry.source = source += 1 + draws_.below(1'000'000);
          for (std::uint64_t n = draws_.below(6); n > 0; --n) {
            const auto number = static_cast<std::uint32_t>(draws_.below(600));
            if (entry.window.place(number) == SeenWindow::Place::fresh) entry.window.mark(number);
          }
        }
        encode(Range{.first = 0, .last = source}, entries, frame);
        break;
      }
      default: {
        std::vector<Slot> entries(draws_.below(5));
        std::uint64_t key = UINT64_MAX - 10;
        for (Slot& entry : entries) entry = {.key = key++, .version = {time(), agent()}};
        encode(Range{.first = 1, .last = UINT64_MAX}, entries, frame);
      }
    }
    return frame;
  }
  Stream& draws() { return draws_; }

 private:
  std::uint32_t u32() { return static_cast<std::uint32_t>(draws_.below(UINT32_MAX)); }
  AgentId agent() { return static_cast<AgentId>(draws_.below(INT32_MAX)); }
  Time time() { return Time::nanoseconds(static_cast<std::int64_t>(draws_.bits() >> 2)); }
  Bytes payload() {
    Bytes bytes(draws_.below(30));
    for (std::byte& b : bytes) b = static_cast<std::byte>(draws_.below(256));
    return bytes;
  }
  Stream draws_;
};

// Reads it as each type. @return how many could, after a look that each says the same once more.
int readings(const Bytes& frame) {
  int count = 0;
  Bytes again;
  const auto expect_again = [&] {
    ++count;
    EXPECT_EQ(again, frame);
  };
  Bundle read_bundle;
  Slot slot;
  std::span<const std::byte> payload;
  if (decode(frame, read_bundle, payload)) {
    encode(read_bundle, payload, again);
    expect_again();
  }
  if (decode(frame, slot, payload)) {
    encode(slot, payload, again);
    expect_again();
  }
  Summary<Seen> seen;
  if (decode(frame, seen)) {
    encode(seen.range, seen.entries, again);
    // Words of zeros at the end of a window may be left out.
    if (again.size() == frame.size()) {
      expect_again();
    } else {
      ++count;
      EXPECT_LT(again.size(), frame.size());
    }
  }
  Summary<Slot> slots;
  if (decode(frame, slots)) {
    encode(slots.range, slots.entries, again);
    expect_again();
  }
  return count;
}

TEST(GossipFrame, WhatIsWrittenIsRead) {
  Frames frames(1);
  for (int i = 0; i < 2000; ++i) ASSERT_EQ(readings(frames.next()), 1);
}

TEST(GossipFrame, ACutFrameIsRefusedUnlessAPayloadOrEntriesAreCut) {
  Frames frames(2);
  for (int i = 0; i < 300; ++i) {
    const Bytes whole = frames.next();
    const auto type = std::to_integer<int>(whole[0]);
    const std::size_t head = type == 1 ? bundle_bytes : type == 3 ? slot_bytes : range_bytes;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const int read = readings(Bytes(whole.begin(), whole.begin() + static_cast<long>(size)));
      if (size < head) {
        ASSERT_EQ(read, 0) << "type " << type << ", " << size << " bytes";
      } else if (type == 1 || type == 3) {
        ASSERT_EQ(read, 1);
      }
    }
  }
}

TEST(GossipFrame, BytesAtRandomAreReadAsTheyAreOrRefused) {
  Frames frames(3);
  Stream& draws = frames.draws();
  int read = 0;
  for (int i = 0; i < 20'000; ++i) {
    Bytes frame = frames.next();
    for (std::uint64_t n = 1 + draws.below(3); n > 0; --n) {
      frame[draws.below(frame.size())] = static_cast<std::byte>(draws.below(256));
    }
    if (draws.below(4) == 0) frame.resize(draws.below(200));
    read += readings(frame);
  }
  EXPECT_GT(read, 1000);
}

// The named faults, one by one.
TEST(GossipFrame, WhatMakesNoSenseIsRefused) {
  const auto refused = [](Bundle changed) {
    Bytes frame;
    encode(changed, {}, frame);
    return readings(frame) == 0;
  };
  const auto with = [](const std::function<void(Bundle&)>& change) {
    Bundle changed = bundle;
    change(changed);
    return changed;
  };
  EXPECT_FALSE(refused(bundle));
  EXPECT_TRUE(refused(with([](Bundle& b) { b.origin = -1; })));
  EXPECT_TRUE(refused(with([](Bundle& b) { b.addressee = central_agent; })));
  EXPECT_TRUE(refused(with([](Bundle& b) { b.sequence = UINT32_MAX; })));
  EXPECT_TRUE(refused(with([](Bundle& b) { b.written = Time::nanoseconds(-1); })));
  EXPECT_TRUE(refused(with([](Bundle& b) { b.written = Time::never(); })));

  const auto summary = [](Range range, std::initializer_list<std::uint64_t> keys) {
    std::vector<Slot> entries;
    for (const std::uint64_t key : keys) entries.push_back({.key = key, .version = {}});
    Bytes frame;
    encode(range, std::span<const Slot>(entries), frame);
    return readings(frame);
  };
  EXPECT_EQ(summary({.first = 3, .last = 9}, {3, 4, 9}), 1);
  EXPECT_EQ(summary({.first = 3, .last = 9}, {2}), 0) << "before the range";
  EXPECT_EQ(summary({.first = 3, .last = 9}, {10}), 0) << "behind the range";
  EXPECT_EQ(summary({.first = 3, .last = 9}, {4, 4}), 0) << "twice";
  EXPECT_EQ(summary({.first = 3, .last = 9}, {5, 4}), 0) << "out of order";
  EXPECT_EQ(summary({.first = 9, .last = 3}, {}), 0) << "ends before it begins";
  EXPECT_EQ(summary({}, {UINT64_MAX}), 1);
  EXPECT_EQ(summary({}, {UINT64_MAX, 0}), 0);

  Seen seen{.source = 7, .window = {}};
  seen.window.mark(2);
  Bytes frame;
  encode(Range{}, std::span(&seen, 1), frame);
  frame[range_bytes + 12] = std::byte{SeenWindow::words + 1};
  frame.resize(1000);
  EXPECT_EQ(readings(frame), 0) << "too many words";
}

}  // namespace
}  // namespace hearsay::gossip
