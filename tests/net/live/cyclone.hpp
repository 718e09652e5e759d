// Cyclone's own serializer on idlc's structs, to compare with.
#pragma once

#include <dds/dds.h>
#include <dds/ddsi/ddsi_cdrstream.h>
#include <gtest/gtest.h>

#include <cstring>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "filters/gaussian/belief.hpp"
#include "filters/gaussian/cdr.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay::live {

using Bytes = std::vector<std::byte>;

/// The storage of sequences and strings of C structs, as long as it lives.
class Pool {
 public:
  /// Makes `sequence` one of `count` zeros, which are returned.
  template <class Sequence>
  auto resize(Sequence& sequence, std::size_t count) {
    using T = std::remove_pointer_t<decltype(sequence._buffer)>;
    auto& room = rooms_.emplace_back(count * sizeof(T) / sizeof(std::max_align_t) + 1);
    std::memset(room.data(), 0, room.size() * sizeof(std::max_align_t));
    sequence._buffer = reinterpret_cast<T*>(room.data());
    sequence._maximum = sequence._length = static_cast<std::uint32_t>(count);
    return std::span<T>(sequence._buffer, count);
  }
  template <class Sequence, class Values>
  void copy(Sequence& sequence, const Values& values) {
    const auto out = resize(sequence, values.size());
    std::copy(values.begin(), values.end(), out.begin());
  }
  template <class Sequence>
  void octets(Sequence& sequence, const Bytes& values) {
    const auto out = resize(sequence, values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      out[i] = std::to_integer<std::uint8_t>(values[i]);
  }
  /// Ω's upper triangle by rows.
  template <class Sequence>
  void triangle(Sequence& sequence, const gaussian::Matrix& m) {
    const auto n = static_cast<std::size_t>(m.rows());
    const auto out = resize(sequence, n * (n + 1) / 2);
    std::size_t at = 0;
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      for (Eigen::Index j = i; j < m.cols(); ++j) out[at++] = m(i, j);
    }
  }
  char* text(const std::string& value) { return texts_.emplace_back(value).data(); }

 private:
  std::deque<std::vector<std::max_align_t>> rooms_;
  std::deque<std::string> texts_;
};

/// A sample as Cyclone writes it, with our header before it.
inline Bytes cyclone_bytes(const dds_topic_descriptor_t& type, const void* sample) {
  dds_ostreamLE_t out;
  dds_ostreamLE_init(&out, 0, 1);
  dds_stream_writeLE(&out, static_cast<const char*>(sample), type.m_ops);
  Bytes bytes(4 + std::size_t{out.x.m_index});
  std::copy(gaussian::cdr::header.begin(), gaussian::cdr::header.end(), bytes.begin());
  if (out.x.m_index > 0) std::memcpy(bytes.data() + 4, out.x.m_buffer, out.x.m_index);
  dds_ostreamLE_fini(&out);
  return bytes;
}

/// Whether Cyclone takes the bytes for a whole sample of the type.
inline bool cyclone_takes(const dds_topic_descriptor_t& type, std::span<const std::byte> bytes) {
  std::vector<std::uint64_t> aligned(bytes.size() / 8 + 1);
  const std::size_t size = bytes.size() - 4;
  std::memcpy(aligned.data(), bytes.data() + 4, size);
  std::uint32_t end = 0;
  return dds_stream_normalize_data(reinterpret_cast<char*>(aligned.data()), &end,
                                   static_cast<std::uint32_t>(size), false, 1, type.m_ops) &&
         end == size;
}

/// What Cyclone writes of the sample that it read from the bytes.
inline Bytes through_cyclone(const dds_topic_descriptor_t& type, std::span<const std::byte> bytes) {
  if (!cyclone_takes(type, bytes)) return {};
  std::vector<std::uint64_t> aligned(bytes.size() / 8 + 1), sample(type.m_size / 8 + 1);
  std::memcpy(aligned.data(), bytes.data() + 4, bytes.size() - 4);
  dds_istream_t in;
  dds_istream_init(&in, static_cast<std::uint32_t>(bytes.size() - 4), aligned.data(), 1);
  dds_stream_read(&in, reinterpret_cast<char*>(sample.data()), type.m_ops);
  dds_istream_fini(&in);
  Bytes again = cyclone_bytes(type, sample.data());
  dds_stream_free_sample(sample.data(), type.m_ops);
  return again;
}

/// Ours are Cyclone's of the C struct with the same values, and Cyclone reads them so.
inline void expect_same(const dds_topic_descriptor_t& type, const void* sample, const Bytes& ours) {
  EXPECT_EQ(cyclone_bytes(type, sample), ours) << type.m_typename;
  EXPECT_EQ(through_cyclone(type, ours), ours) << type.m_typename;
}

inline std::uint32_t word(Stream& random) { return static_cast<std::uint32_t>(random.bits()); }
inline std::int64_t stamp(Stream& random) { return static_cast<std::int64_t>(random.bits()); }

inline gaussian::Belief some_belief(Stream& random, int n) {
  gaussian::Matrix root(n, n);
  gaussian::Vector mean(n);
  for (double& value : root.reshaped()) value = random.normal();
  for (double& value : mean) value = random.normal(0.0, 10.0);
  const gaussian::Matrix covariance =
      root * root.transpose() + gaussian::Matrix::Identity(n, n) * 0.1;
  return gaussian::Belief::from_moments(mean, covariance);
}

inline std::string some_text(Stream& random, std::size_t length) {
  std::string text(length, ' ');
  for (char& c : text) c = static_cast<char>(1 + random.below(255));
  return text;
}

}  // namespace hearsay::live
