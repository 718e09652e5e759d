// A process's way to the others of its fleet: topics of Cyclone DDS as queues of bytes. What the
// bytes are is said in messages.hpp and envelope.hpp, which topics there are in topics.hpp.
//
// Everything here is called from one thread. Cyclone's own threads only make wake_fd() readable.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "net/live/envelope.hpp"
#include "net/live/topics.hpp"

namespace hearsay::live {

/// What DDS says of a sample beside its bytes.
struct SampleInfo {
  std::uint64_t writer = 0;     ///< differs from writer to writer
  std::int64_t written_ns = 0;  ///< by the writer's clock, since 1970
};

/// Sends samples of one topic. Reliable: each that is sent reaches, in order, all readers that are
/// there, as long as they and the writer live.
class Writer {
 public:
  struct Impl;
  explicit Writer(std::unique_ptr<Impl> impl);
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;
  ~Writer();  ///< sees to it, for up to a second, that what was written arrives

  /// `bytes`: a whole sample with its header of four bytes, at most sample_bytes_max; they are
  /// copied, and not looked at: readers drop what is malformed. Blocks for up to a second while
  /// readers that are there do not keep up; false if it could not be sent, then or at all.
  bool write(std::span<const std::byte> bytes);
  /// The same, but it may wait for others to go with it: until flush() or write(), or until they
  /// fill a datagram. Many small samples at once go several times as fast.
  bool write_later(std::span<const std::byte> bytes);
  void flush();
  /// What pack() would make of the two, with a copy less. @throws BrokenInvariant as pack().
  bool write_packet(const Envelope& envelope, std::span<const std::byte> message);
  bool write_packet_later(const Envelope& envelope, std::span<const std::byte> message);
  /// Readers of the topic that what is written now will reach. A reader may know of the writer a
  /// little before: what is written in between does not reach it.
  int readers() const;
  bool matched() const { return readers() > 0; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// Gets samples of one topic.
class Reader {
 public:
  struct Impl;
  explicit Reader(std::unique_ptr<Impl> impl);
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();

  /// The next sample, with its header (little-endian, without padding), in place of what `out`
  /// held; false if there is none. Whoever does not take for long makes writers wait.
  bool take(std::vector<std::byte>& out, SampleInfo* info = nullptr);
  /// The same, of a topic whose samples begin with an envelope (all of the air): `message` is what
  /// pack() took, or for OctetsPacket all behind the envelope.
  bool take_packet(Envelope& envelope, std::vector<std::byte>& message, SampleInfo* info = nullptr);
  /// Writers of the topic that are there. Of a process that was killed or is stopped they are not
  /// after two seconds without a sign of life (programs of others may have chosen otherwise).
  int writers_alive() const;
  /// Samples so far that take() passed over since they were not of the topic's type.
  std::uint64_t malformed() const;

 private:
  std::unique_ptr<Impl> impl_;
};

/// Takes part in a fleet. Several in one process are as good as in several. Writers and readers
/// keep what they need of it.
class Port {
 public:
  struct Options {
    std::string fleet;          ///< is_fleet_name()
    std::string interface;      ///< of the network, e.g. "eth0"; empty: this machine alone
    std::uint32_t domain = 77;  ///< DDS domain, 0 to 230: others are not heard at all
  };
  /// @throws InputError for options out of range and an interface that is not there.
  explicit Port(const Options& options);
  Port(Port&&) noexcept;
  Port& operator=(Port&&) noexcept;
  ~Port();

  const std::string& fleet() const;
  /// `partition`: one of topics.hpp. @throws std::runtime_error if DDS refuses.
  Writer writer(const TopicId& topic, const std::string& partition);
  Reader reader(const TopicId& topic, const std::string& partition);

  /// An eventfd: readable if since the last drain() anything arrived, or a writer or reader of a
  /// topic of ours appeared or vanished. Belongs to the port.
  int wake_fd() const;
  /// Call it before looking at readers, so that nothing is missed.
  void drain();

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace hearsay::live
