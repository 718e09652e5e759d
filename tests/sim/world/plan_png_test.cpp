#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/world/plan.hpp"
#include "tests/sim/world/floors.hpp"

namespace hearsay::plan {
namespace {

// A writer of PNG by its specification: stored blocks, no filters.

std::string big_endian(std::uint32_t v) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(v >> shift & 0xff);
  return out;
}

std::string chunk(const std::string& type, const std::string& data) {
  std::uint32_t crc = 0xffffffffU;
  for (const char c : type + data) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320U : 0U);
  }
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + big_endian(~crc);
}

std::string zlib(const std::string& data) {
  std::uint32_t a = 1, b = 0;
  std::string out = "\x78\x01";
  std::size_t at = 0;
  do {
    const std::size_t n = std::min<std::size_t>(65535, data.size() - at);
    out += static_cast<char>(at + n == data.size());
    for (const std::size_t v : {n, ~n}) {
      out += static_cast<char>(v & 0xff);
      out += static_cast<char>(v >> 8 & 0xff);
    }
    out += data.substr(at, n);
    at += n;
  } while (at < data.size());
  for (const char c : data) {
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  return out + big_endian(b << 16 | a);
}

const std::string magic = "\x89PNG\r\n\x1a\n";

std::string header(std::uint32_t columns, std::uint32_t rows, int depth, int colour,
                   int interlace = 0) {
  return magic + chunk("IHDR", big_endian(columns) + big_endian(rows) + static_cast<char>(depth) +
                                   static_cast<char>(colour) + std::string(2, '\0') +
                                   static_cast<char>(interlace));
}

/// A PNG whose pixels, from the top, are given as their bytes.
std::string png(const std::vector<std::vector<std::string>>& lines, int depth, int colour,
                const std::string& extra = "", bool interlaced = false) {
  struct Pass {
    std::size_t x, y, dx, dy;
  };
  const std::vector<Pass> adam7 = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                                   {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
  std::string data;
  for (const auto& [x0, y0, dx, dy] : interlaced ? adam7 : std::vector<Pass>{{0, 0, 1, 1}}) {
    if (x0 >= lines[0].size()) continue;
    for (std::size_t y = y0; y < lines.size(); y += dy) {
      data += '\0';
      for (std::size_t x = x0; x < lines[y].size(); x += dx) data += lines[y][x];
    }
  }
  return header(static_cast<std::uint32_t>(lines[0].size()),
                static_cast<std::uint32_t>(lines.size()), depth, colour, interlaced) +
         extra + chunk("IDAT", zlib(data)) + chunk("IEND", "");
}

std::string png(const Drawing& d, const std::string& wall, const std::string& free, int depth,
                int colour, const std::string& extra = "", bool interlaced = false) {
  std::vector<std::vector<std::string>> lines;
  for (int row = d.rows - 1; row >= 0; --row) {
    lines.emplace_back();
    for (int column = 0; column < d.columns; ++column) {
      lines.back().push_back(d.wall(column, row) ? wall : free);
    }
  }
  return png(lines, depth, colour, extra, interlaced);
}

std::string complaint_of(const std::string& bytes, double cell_m = 1.0, int threshold = 128) {
  try {
    parse_png(bytes, "plan.png", cell_m, threshold);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

Drawing sample(std::uint64_t i) {
  Stream stream(3, Purpose("plans"), Entity{i});
  return random_drawing(stream, 20, 0.25);
}

TEST(PlanPng, TextAndBitmapOfOnePlanGiveTheSameWalls) {
  for (std::uint64_t i = 0; i < 50; ++i) {
    const Drawing d = sample(i);
    std::string text;
    for (int row = d.rows - 1; row >= 0; --row, text += '\n') {
      for (int column = 0; column < d.columns; ++column) text += d.wall(column, row) ? '#' : '.';
    }
    const Plan a(parse_text(text, "plan.txt", 0.25));
    const Plan b(parse_png(png(d, std::string(1, '\0'), "\xff", 8, 0), "plan.png", 0.25));
    ASSERT_EQ(a.walls().size(), b.walls().size());
    EXPECT_EQ(a.width_m(), b.width_m());
    EXPECT_EQ(a.height_m(), b.height_m());
    for (std::size_t k = 0; k < a.walls().size(); ++k) {
      EXPECT_EQ(a.walls()[k].from, b.walls()[k].from);
      EXPECT_EQ(a.walls()[k].to, b.walls()[k].to);
    }
  }
}

TEST(PlanPng, EveryKindOfPngIsRead) {
  using namespace std::string_literals;
  const Drawing d = sample(4);
  const auto expect_same = [&](const std::string& bytes) {
    EXPECT_EQ(parse_png(bytes, "plan.png", 0.25).walls, d.walls);
  };
  expect_same(png(d, "\0"s, "\xff"s, 8, 0, "", true));                  // interlaced
  expect_same(png(d, "\x10\x00"s, "\xf0\x00"s, 16, 0));                 // 16 bit
  expect_same(png(d, "\x00\x00\x80"s, "\xff\xff\x00"s, 8, 2));          // colour: blue, yellow
  expect_same(png(d, "\x00\x00\x00\xff"s, "\x00\x00\x00\x00"s, 8, 6));  // transparent is white
  expect_same(png(d, "\x00\xff"s, "\x00\x00"s, 8, 4));
  expect_same(png(d, "\1"s, "\0"s, 8, 3, chunk("PLTE", "\xff\xff\xff\x00\x00\x00"s)));
  expect_same(png(d, "\1"s, "\0"s, 8, 3,
                  chunk("PLTE", "\x00\x00\x00\x00\x00\x00"s) + chunk("tRNS", "\0"s)));
}

TEST(PlanPng, AGreyThatStandsForTransparentIsFree) {
  using namespace std::string_literals;
  const Drawing d = sample(4);
  const std::string bytes = png(d, "\x01"s, "\x00"s, 8, 0, chunk("tRNS", "\0\0"s));
  EXPECT_EQ(parse_png(bytes, "plan.png", 0.25).walls, d.walls);
}

TEST(PlanPng, BitsAreRead) {
  using namespace std::string_literals;
  const Drawing d =
      parse_png(header(3, 2, 1, 0) + chunk("IDAT", zlib("\0\xa0\0\x40"s)) + chunk("IEND", ""),
                "plan.png", 1.0);
  EXPECT_EQ(d.walls, (std::vector<std::uint8_t>{1, 0, 1, 0, 1, 0}));
}

TEST(PlanPng, DarkIsWhatIsBelowTheThreshold) {
  const std::string bytes = png({{"\x63", "\x64", "\xff"}}, 8, 0);
  EXPECT_EQ(parse_png(bytes, "p", 1.0, 100).walls, (std::vector<std::uint8_t>{1, 0, 0}));
  EXPECT_EQ(parse_png(bytes, "p", 1.0, 99).walls, (std::vector<std::uint8_t>{0, 0, 0}));
  EXPECT_EQ(parse_png(bytes, "p", 1.0, 101).walls, (std::vector<std::uint8_t>{1, 1, 0}));
  EXPECT_EQ(complaint_of(bytes, 1.0, 0), "plan.png: a threshold of 0; 1 … 255 are allowed");
  EXPECT_EQ(complaint_of(bytes, 1.0, 256), "plan.png: a threshold of 256; 1 … 255 are allowed");
  EXPECT_THAT(complaint_of(bytes, 0.0), testing::EndsWith("0.001 … 20 m are allowed"));
  EXPECT_EQ(complaint_of(png({{"\x01"}}, 8, 0)),
            "plan.png: all is wall; at least one cell must be free");
}

TEST(PlanPng, AFileCutOffAnywhereIsRefused) {
  const std::string good = png(sample(5), std::string(1, '\0'), "\xff", 8, 0);
  EXPECT_EQ(complaint_of(good), "no error");
  for (std::size_t size = 0; size < good.size(); ++size) {
    ASSERT_THAT(complaint_of(good.substr(0, size)), testing::HasSubstr("PNG")) << size;
  }
}

TEST(PlanPng, WhatIsNoPngIsRefused) {
  EXPECT_THAT(complaint_of("GIF89a, and so on and on"), testing::HasSubstr("no PNG"));
  EXPECT_THAT(complaint_of("\x89PNH\r\n\x1a\n1234567890"), testing::HasSubstr("no PNG"));
  EXPECT_THAT(complaint_of(header(2, 2, 8, 0) + chunk("IEND", "")), testing::HasSubstr("PNG"));
  EXPECT_THAT(complaint_of(header(2, 2, 3, 0)), testing::HasSubstr("no PNG"));  // 3 bits
}

TEST(PlanPng, SizesBeyondBoundsAreRefusedByTheHeaderAlone) {
  for (const auto& [columns, rows] : {std::pair{4097U, 1U}, std::pair{1U, 4097U},
                                      std::pair{0x7fffffffU, 0x7fffffffU}, std::pair{0U, 1U}}) {
    EXPECT_THAT(complaint_of(header(columns, rows, 8, 0) + chunk("IDAT", zlib(""))),
                testing::StartsWith("plan.png: no PNG of at most 4096 pixels a side"));
  }
  const std::vector<std::vector<std::string>> wide(1, std::vector<std::string>(4096, "\xff"));
  EXPECT_EQ(complaint_of(png(wide, 8, 0)), "no error");
}

TEST(PlanPng, ACompressedStreamTooShortForTheSizeIsRefused) {
  EXPECT_THAT(
      complaint_of(header(4096, 4096, 16, 6) + chunk("IDAT", zlib("abc")) + chunk("IEND", "")),
      testing::HasSubstr("no whole PNG"));
}

/// Whatever the bytes are, a drawing of bounded size comes out or an InputError.
TEST(PlanPng, FilesWithBytesChangedAreReadOrRefused) {
  const std::string good = png(sample(6), std::string(1, '\0'), "\xff", 8, 0,
                               chunk("tEXt", std::string("a\0b", 3)), true);
  Stream stream(4, Purpose("bytes"), Entity{0});
  int read = 0, refused = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string bytes = good;
    for (std::uint64_t n = 1 + stream.below(3); n > 0; --n) {
      bytes[stream.below(bytes.size())] = static_cast<char>(stream.below(256));
    }
    try {
      const Drawing d = parse_png(bytes, "p", 1.0);
      EXPECT_EQ(d.walls.size(), static_cast<std::size_t>(d.columns * d.rows));
      ++read;
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 300);
  EXPECT_GT(read, 10);  // changes of what does not matter
}

TEST(PlanPng, AMissingFileIsNamed) {
  try {
    read_png("/nowhere/plan.png", 1.0);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "/nowhere/plan.png: no such file");
  }
}

}  // namespace
}  // namespace hearsay::plan
