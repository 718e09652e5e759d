#include "net/live/port.hpp"

#include <dds/dds.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <stdexcept>
#include <utility>

#include "net/live/config.hpp"
#include "net/live/descriptors.hpp"
#include "net/live/messages.hpp"
#include "net/live/raw_type.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::live {
namespace {

/// How long a writer waits for readers that do not keep up.
constexpr dds_duration_t blocking_max = DDS_SECS(1);
/// Makes each process that writes show life about as often, though it has nothing to say.
constexpr dds_duration_t lease = DDS_SECS(1);
/// What a reader holds for who does not take it; behind it writers wait.
constexpr std::int32_t samples_max = 4096;

constexpr std::array<std::byte, 4> header = {std::byte{0}, std::byte{1}, std::byte{0},
                                             std::byte{0}};

dds_entity_t check(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    throw std::runtime_error(std::string("DDS: no ") + what + ": " + dds_strretcode(-entity));
  }
  return entity;
}

/// An entity of Cyclone's with all that hangs on it.
class Entity {
 public:
  Entity() = default;
  Entity(dds_entity_t entity, const char* what) : entity_(check(entity, what)) {}
  Entity(Entity&& other) noexcept : entity_(std::exchange(other.entity_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(entity_, other.entity_);
    return *this;
  }
  ~Entity() {
    if (entity_ > 0) dds_delete(entity_);
  }
  dds_entity_t get() const { return entity_; }

 private:
  dds_entity_t entity_ = 0;
};

class EventFd {
 public:
  EventFd() : fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    if (fd_ < 0) throw std::runtime_error("eventfd: no more files may be open");
  }
  EventFd(const EventFd&) = delete;
  EventFd& operator=(const EventFd&) = delete;
  ~EventFd() { close(fd_); }
  int get() const { return fd_; }
  void drain() {
    std::uint64_t count = 0;
    while (read(fd_, &count, sizeof count) < 0 && errno == EINTR) {
    }
    raised_ = false;  // last: what is raised before is there to be found after
  }
  /// From any thread. Writes once between two drains, since samples may come by the million.
  void raise() {
    if (raised_.exchange(true)) return;
    const std::uint64_t one = 1;
    while (write(fd_, &one, sizeof one) < 0 && errno == EINTR) {
    }
  }

 private:
  int fd_;
  std::atomic<bool> raised_ = false;
};

struct QosDelete {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDelete>;
struct ListenerDelete {
  void operator()(dds_listener_t* listener) const { dds_delete_listener(listener); }
};
using Listener = std::unique_ptr<dds_listener_t, ListenerDelete>;

Qos topic_qos(Type type) {
  Qos qos(dds_create_qos());
  const bool last = type == Type::clock;
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, blocking_max);
  dds_qset_history(qos.get(), last ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL, last ? 1 : 0);
  dds_qset_durability(qos.get(), last ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (last) {
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, 1, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  constexpr dds_data_representation_id_t xcdr1 = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &xcdr1);
  return qos;
}

Qos partition_qos(const std::string& partition) {
  Qos qos(dds_create_qos());
  dds_qset_partition1(qos.get(), partition.c_str());
  return qos;
}

}  // namespace

// A domain of Cyclone's own to each port: what is shared within one would not go over the network.
struct Port::Impl {
  EventFd wake;  // outlives all that may raise it
  Options options;
  Entity domain;
  Entity participant;

  explicit Impl(const Options& o) : options(o) {
    const std::string config = cyclone_config(options.domain, options.interface);
    // Any number that is free in this process; the one that others see is in the configuration.
    dds_return_t made = DDS_RETCODE_PRECONDITION_NOT_MET;
    dds_domainid_t number = 0;
    for (; made == DDS_RETCODE_PRECONDITION_NOT_MET && number <= 230; ++number) {
      made = dds_create_domain(number, config.c_str());
    }
    if (made < 0 && !options.interface.empty()) {
      throw InputError("the network interface '" + options.interface +
                       "' cannot be used: " + dds_strretcode(-made));
    }
    domain = Entity(made, "domain");
    participant = Entity(dds_create_participant(number - 1, nullptr, nullptr), "participant");
  }
};

namespace {

/// A topic of ours, and what its readers or writers hang on.
struct Place {
  Entity topic;
  ddsi_sertype* type = nullptr;
  Entity group;  ///< publisher or subscriber

  Place(dds_entity_t participant, const TopicId& id, const dds_qos_t* qos) {
    type = make_raw_type(descriptor_of(id.type));
    const dds_entity_t made =
        dds_create_topic_sertype(participant, id.name.c_str(), &type, qos, nullptr, nullptr);
    if (made < 0) release(type);
    topic = Entity(made, "topic");
  }
};

void put_behind_header(std::span<const std::byte> body, std::vector<std::byte>& out) {
  out.resize(header.size() + body.size());
  std::copy(header.begin(), header.end(), out.begin());
  std::copy(body.begin(), body.end(), out.begin() + header.size());
}

Listener listener(EventFd& wake) { return Listener(dds_create_listener(&wake)); }

}  // namespace

struct Writer::Impl {
  std::shared_ptr<void> port;
  Place place;
  Entity entity;
  std::vector<std::byte> head = {};  ///< of a packet

  bool send(std::span<const std::byte> first, std::span<const std::byte> rest) {
    if (first.size() + rest.size() > sample_bytes_max) return false;
    ddsi_serdata* const sample = make_sample(place.type, first, rest);
    return sample && dds_writecdr(entity.get(), sample) == DDS_RETCODE_OK;
  }
};

struct Reader::Impl {
  static constexpr std::uint32_t batch = 32;
  std::shared_ptr<void> port;
  Place place;
  Entity entity;
  std::array<ddsi_serdata*, batch> samples{};
  std::array<dds_sample_info_t, batch> infos{};
  std::uint32_t next = 0, end = 0;  ///< those of `samples` that are not yet taken
  std::uint64_t malformed = 0;

  Impl(std::shared_ptr<void> p, Place at, Entity made)
      : port(std::move(p)), place(std::move(at)), entity(std::move(made)) {}
  ~Impl() {
    for (; next < end; ++next) release(samples[next]);
  }
  bool fetch() {
    const dds_return_t count =
        dds_takecdr(entity.get(), samples.data(), batch, infos.data(), DDS_ANY_STATE);
    next = 0;
    end = count > 0 ? static_cast<std::uint32_t>(count) : 0;
    return end > 0;
  }
  /// The next of which `use` makes something of the body.
  template <class F>
  bool take(SampleInfo* info, F&& use) {
    while (next < end || fetch()) {
      const std::uint32_t at = next++;
      ddsi_serdata* const sample = samples[at];
      const bool data = infos[at].valid_data && is_data(sample);
      const auto body = data ? body_of(sample) : std::nullopt;
      const bool used = body && use(*body);
      if (used && info) *info = {infos[at].publication_handle, infos[at].source_timestamp};
      release(sample);
      if (used) return true;
      if (data) ++malformed;
    }
    return false;
  }
};

Port::Port(const Options& options) {
  if (!is_fleet_name(options.fleet)) {
    throw InputError("fleet: '" + options.fleet +
                     "' is no name of a fleet; allowed are 1 to 64 letters, digits, '-' and '_'");
  }
  impl_ = std::make_shared<Impl>(options);
}
Port::Port(Port&&) noexcept = default;
Port& Port::operator=(Port&&) noexcept = default;
Port::~Port() = default;

const std::string& Port::fleet() const { return impl_->options.fleet; }
int Port::wake_fd() const { return impl_->wake.get(); }
void Port::drain() { impl_->wake.drain(); }

Writer Port::writer(const TopicId& topic, const std::string& partition) {
  const Qos qos = topic_qos(topic.type);
  const dds_entity_t participant = impl_->participant.get();
  Place place(participant, topic, qos.get());
  dds_qset_liveliness(qos.get(), DDS_LIVELINESS_AUTOMATIC, lease);
  dds_qset_writer_data_lifecycle(qos.get(), false);
  place.group = Entity(dds_create_publisher(participant, partition_qos(partition).get(), nullptr),
                       "publisher");
  const Listener changes = listener(impl_->wake);
  dds_lset_publication_matched(
      changes.get(), [](dds_entity_t, const dds_publication_matched_status_t, void* wake) {
        static_cast<EventFd*>(wake)->raise();
      });
  Entity entity(dds_create_writer(place.group.get(), place.topic.get(), qos.get(), changes.get()),
                "writer");
  return Writer(
      std::unique_ptr<Writer::Impl>(new Writer::Impl{impl_, std::move(place), std::move(entity)}));
}

Reader Port::reader(const TopicId& topic, const std::string& partition) {
  const Qos qos = topic_qos(topic.type);
  const dds_entity_t participant = impl_->participant.get();
  Place place(participant, topic, qos.get());
  if (topic.type != Type::clock) {
    dds_qset_resource_limits(qos.get(), samples_max, 1, samples_max);
  }
  place.group = Entity(dds_create_subscriber(participant, partition_qos(partition).get(), nullptr),
                       "subscriber");
  const Listener changes = listener(impl_->wake);
  dds_lset_data_available(changes.get(),
                          [](dds_entity_t, void* wake) { static_cast<EventFd*>(wake)->raise(); });
  dds_lset_subscription_matched(
      changes.get(), [](dds_entity_t, const dds_subscription_matched_status_t, void* wake) {
        static_cast<EventFd*>(wake)->raise();
      });
  dds_lset_liveliness_changed(changes.get(),
                              [](dds_entity_t, const dds_liveliness_changed_status_t, void* wake) {
                                static_cast<EventFd*>(wake)->raise();
                              });
  Entity entity(dds_create_reader(place.group.get(), place.topic.get(), qos.get(), changes.get()),
                "reader");
  return Reader(std::make_unique<Reader::Impl>(impl_, std::move(place), std::move(entity)));
}

Writer::Writer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Writer::Writer(Writer&&) noexcept = default;
Writer& Writer::operator=(Writer&&) noexcept = default;
Writer::~Writer() = default;

bool Writer::write(std::span<const std::byte> bytes) {
  const bool written = write_later(bytes);
  flush();
  return written;
}

void Writer::flush() { dds_write_flush(impl_->entity.get()); }

bool Writer::write_later(std::span<const std::byte> bytes) { return impl_->send(bytes, {}); }

bool Writer::write_packet(const Envelope& envelope, std::span<const std::byte> message) {
  const bool written = write_packet_later(envelope, message);
  flush();
  return written;
}

bool Writer::write_packet_later(const Envelope& envelope, std::span<const std::byte> message) {
  require(message.size() >= header.size(), "write_packet: a message without its header");
  pack(envelope, message.first(header.size()), impl_->head);
  return impl_->send(impl_->head, message.subspan(header.size()));
}

int Writer::readers() const {
  dds_publication_matched_status_t status{};
  if (dds_get_publication_matched_status(impl_->entity.get(), &status) != DDS_RETCODE_OK) return 0;
  return static_cast<int>(status.current_count);
}

Reader::Reader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;
Reader::~Reader() = default;

bool Reader::take(std::vector<std::byte>& out, SampleInfo* info) {
  return impl_->take(info, [&](std::span<const std::byte> body) {
    put_behind_header(body, out);
    return true;
  });
}

bool Reader::take_packet(Envelope& envelope, std::vector<std::byte>& message, SampleInfo* info) {
  return impl_->take(info, [&](std::span<const std::byte> body) {
    if (!read_envelope(body, envelope)) return false;
    put_behind_header(body.subspan(envelope_bytes), message);
    return true;
  });
}

// Not what DDS calls liveliness: once it lapsed, Cyclone takes a writer for alive again only when
// it writes, however lively its process is. Processes that were taken for gone are found again.
int Reader::writers_alive() const {
  dds_subscription_matched_status_t status{};
  if (dds_get_subscription_matched_status(impl_->entity.get(), &status) != DDS_RETCODE_OK) return 0;
  return static_cast<int>(status.current_count);
}

std::uint64_t Reader::malformed() const { return impl_->malformed; }

}  // namespace hearsay::live
