#include "net/live/raw_type.hpp"

#include <dds/ddsi/ddsi_cdrstream.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/ddsi_typelib.h>
#include <dds/ddsi/q_radmin.h>
#include <dds/ddsrt/heap.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace hearsay::live {
namespace {

constexpr std::size_t header_bytes = 4;

/// Where the bytes of samples are. What one thread gives back another takes: the C library would
/// return large pieces to the system each time, and have them filled with zeros anew.
class Storage {
 public:
  struct Piece {
    std::unique_ptr<std::byte[]> bytes;
    std::size_t size = 0;
  };
  Piece take(std::size_t size) {
    {
      const std::lock_guard lock(guard_);
      for (auto at = free_.rbegin(); at != free_.rend(); ++at) {
        if (at->size < size || at->size > 2 * size) continue;
        Piece piece = std::move(*at);
        free_.erase(std::next(at).base());
        free_bytes_ -= piece.size;
        return piece;
      }
    }
    return {std::make_unique_for_overwrite<std::byte[]>(size), size};
  }
  void give(Piece piece) {
    if (piece.size < size_min) return;
    const std::lock_guard lock(guard_);
    if (free_.size() == pieces_max || free_bytes_ + piece.size > bytes_max) return;
    free_bytes_ += piece.size;
    free_.push_back(std::move(piece));
  }

 private:
  static constexpr std::size_t size_min = 4096;  ///< below, the C library is good at it
  static constexpr std::size_t pieces_max = 64;
  static constexpr std::size_t bytes_max = std::size_t{16} << 20;
  std::mutex guard_;
  std::vector<Piece> free_;
  std::size_t free_bytes_ = 0;
};

struct RawType {
  ddsi_sertype base;  // first, for Cyclone
  const dds_topic_descriptor_t* descriptor;
  std::shared_ptr<Storage> storage;
};

/// Header and body, from four bytes behind a multiple of 8 on, so that the body is aligned; and up
/// to three bytes more, since what goes over the wire is a multiple of 4.
struct RawSample {
  ddsi_serdata base;                 // first, for Cyclone
  std::shared_ptr<Storage> storage;  // outlives the type, if need be
  Storage::Piece piece;
  std::size_t wire_bytes;  // multiple of 4
  std::size_t body_bytes;
  bool sound;

  std::byte* wire() const { return piece.bytes.get() + header_bytes; }
  std::byte* body() const { return wire() + header_bytes; }
};

const RawType& raw(const ddsi_sertype* type) { return *reinterpret_cast<const RawType*>(type); }
RawSample& raw(ddsi_serdata* sample) { return *reinterpret_cast<RawSample*>(sample); }
const RawSample& raw(const ddsi_serdata* sample) {
  return *reinterpret_cast<const RawSample*>(sample);
}

RawSample* make(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t bytes) {
  auto* const sample = new RawSample();
  ddsi_serdata_init(&sample->base, type, kind);
  sample->wire_bytes = (bytes + 3) / 4 * 4;
  sample->storage = raw(type).storage;
  sample->piece = sample->storage->take(header_bytes + sample->wire_bytes);
  std::fill_n(sample->wire() + bytes, sample->wire_bytes - bytes, std::byte{0});
  return sample;
}

/// Looks at the bytes and brings them into our order. Senders say in the last two bits of the
/// header by how much they padded; some do not.
void settle(RawSample& sample, std::size_t bytes) {
  const std::byte* const header = sample.wire();
  const bool plain = header[0] == std::byte{0} && header[1] <= std::byte{1};
  const std::size_t padding = std::to_integer<std::size_t>(header[3]) & 3;
  if (!plain || bytes < header_bytes + padding) return;
  const bool swap = header[1] == std::byte{0};
  const auto size = static_cast<std::uint32_t>(bytes - header_bytes - padding);
  std::uint32_t end = 0;
  auto* const body = reinterpret_cast<char*>(sample.body());
  const std::uint32_t* const ops = raw(sample.base.type).descriptor->m_ops;
  if (!dds_stream_normalize_data(body, &end, size, swap, 1, ops)) return;
  if (size - end > 3) return;
  sample.body_bytes = end;
  sample.sound = true;
  const auto pad = static_cast<std::byte>(sample.wire_bytes - header_bytes - end);
  const std::byte ours[header_bytes] = {std::byte{0}, std::byte{1}, std::byte{0}, pad};
  std::copy_n(ours, header_bytes, sample.wire());
}

// ---- samples ----

bool eqkey(const ddsi_serdata*, const ddsi_serdata*) { return true; }  // there are no keys
std::uint32_t get_size(const ddsi_serdata* sample) {
  return static_cast<std::uint32_t>(raw(sample).wire_bytes);
}

ddsi_serdata* from_ser(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragments,
                       std::size_t size) {
  if (size < header_bytes) return nullptr;
  RawSample* const sample = make(type, kind, size);
  std::uint32_t end = 0;  // fragments may overlap
  for (const nn_rdata* f = fragments; f && end < size; f = f->nextfrag) {
    if (f->maxp1 <= end || f->min > end) continue;
    const auto upto = static_cast<std::uint32_t>(std::min<std::size_t>(f->maxp1, size));
    const unsigned char* const payload = NN_RMSG_PAYLOADOFF(f->rmsg, NN_RDATA_PAYLOAD_OFF(f));
    std::memcpy(sample->wire() + end, payload + (end - f->min), upto - end);
    end = upto;
  }
  if (end == size && kind == SDK_DATA) settle(*sample, size);
  return &sample->base;
}

ddsi_serdata* from_ser_iov(const ddsi_sertype* type, ddsi_serdata_kind kind,
                           ddsrt_msg_iovlen_t count, const ddsrt_iovec_t* parts, std::size_t size) {
  if (size < header_bytes) return nullptr;
  RawSample* const sample = make(type, kind, size);
  std::size_t end = 0;
  for (std::size_t i = 0; i < count && end < size; ++i) {
    const std::size_t length = std::min<std::size_t>(parts[i].iov_len, size - end);
    if (length > 0) std::memcpy(sample->wire() + end, parts[i].iov_base, length);
    end += length;
  }
  if (end == size && kind == SDK_DATA) settle(*sample, size);
  return &sample->base;
}

ddsi_serdata* empty_key(const ddsi_sertype* type) {
  RawSample* const sample = make(type, SDK_KEY, header_bytes);
  const std::byte header[header_bytes] = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  std::copy_n(header, header_bytes, sample->wire());
  return &sample->base;
}
ddsi_serdata* from_keyhash(const ddsi_sertype* type, const ddsi_keyhash*) {
  return empty_key(type);
}
/// For unregistering alone, which knows no sample.
ddsi_serdata* from_sample(const ddsi_sertype* type, ddsi_serdata_kind kind, const void*) {
  return kind == SDK_KEY ? empty_key(type) : nullptr;
}
ddsi_serdata* to_untyped(const ddsi_serdata* sample) {
  ddsi_serdata* const key = empty_key(sample->type);
  key->type = nullptr;
  return key;
}

void to_ser(const ddsi_serdata* sample, std::size_t offset, std::size_t size, void* out) {
  std::memcpy(out, raw(sample).wire() + offset, size);
}
ddsi_serdata* to_ser_ref(const ddsi_serdata* sample, std::size_t offset, std::size_t size,
                         ddsrt_iovec_t* out) {
  out->iov_base = raw(sample).wire() + offset;
  out->iov_len = size;
  return ddsi_serdata_ref(sample);
}
void to_ser_unref(ddsi_serdata* sample, const ddsrt_iovec_t*) { ddsi_serdata_unref(sample); }

// Nobody gets structs here.
bool to_sample(const ddsi_serdata*, void*, void**, void*) { return false; }
bool untyped_to_sample(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
  return true;  // of a key there is nothing to fill in
}
std::size_t print(const ddsi_sertype*, const ddsi_serdata*, char* out, std::size_t size) {
  if (size > 0) out[0] = '\0';
  return 0;
}
void get_keyhash(const ddsi_serdata*, ddsi_keyhash* out, bool) {
  std::memset(out->value, 0, sizeof out->value);
}
void free_sample(ddsi_serdata* sample) {
  RawSample& bytes = raw(sample);
  bytes.storage->give(std::move(bytes.piece));
  delete &bytes;
}

constexpr ddsi_serdata_ops make_sample_ops() {
  ddsi_serdata_ops ops{};
  ops.eqkey = eqkey;
  ops.get_size = get_size;
  ops.from_ser = from_ser;
  ops.from_ser_iov = from_ser_iov;
  ops.from_keyhash = from_keyhash;
  ops.from_sample = from_sample;
  ops.to_ser = to_ser;
  ops.to_ser_ref = to_ser_ref;
  ops.to_ser_unref = to_ser_unref;
  ops.to_sample = to_sample;
  ops.to_untyped = to_untyped;
  ops.untyped_to_sample = untyped_to_sample;
  ops.free = free_sample;
  ops.print = print;
  ops.get_keyhash = get_keyhash;
  return ops;
}
constexpr ddsi_serdata_ops sample_ops = make_sample_ops();

// ---- types ----

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete reinterpret_cast<RawType*>(type);
}
void zero_samples(const ddsi_sertype*, void*, std::size_t) {}
void realloc_samples(void** pointers, const ddsi_sertype*, void*, std::size_t, std::size_t count) {
  std::fill_n(pointers, count, nullptr);
}
void free_samples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}
bool equal(const ddsi_sertype* a, const ddsi_sertype* b) {
  return raw(a).descriptor == raw(b).descriptor;
}
std::uint32_t hash(const ddsi_sertype*) { return 0; }  // the type's name is hashed by Cyclone

// What others need to see that two types agree.
ddsi_sertype_cdr_data meta(const dds_type_meta_ser& data) {
  ddsi_sertype_cdr_data out{};
  out.data = const_cast<unsigned char*>(data.data);
  out.sz = data.sz;
  return out;
}
ddsi_typeinfo_t* type_info(const ddsi_sertype* type) {
  const ddsi_sertype_cdr_data data = meta(raw(type).descriptor->type_information);
  return ddsi_typeinfo_deser(&data);
}
ddsi_typemap_t* type_map(const ddsi_sertype* type) {
  const ddsi_sertype_cdr_data data = meta(raw(type).descriptor->type_mapping);
  return ddsi_typemap_deser(&data);
}
ddsi_typeid_t* type_id(const ddsi_sertype* type, ddsi_typeid_kind_t kind) {
  ddsi_typeinfo_t* const info = type_info(type);
  if (!info) return nullptr;
  ddsi_typeid_t* const id = ddsi_typeinfo_typeid(info, kind);
  ddsi_typeinfo_fini(info);
  ddsrt_free(info);
  return id;
}

std::size_t serialized_size(const ddsi_sertype*, const void*) { return SIZE_MAX; }
bool serialize_into(const ddsi_sertype*, const void*, void*, std::size_t) { return false; }

constexpr ddsi_sertype_ops make_type_ops() {
  ddsi_sertype_ops ops{};
  ops.version = ddsi_sertype_v0;
  ops.free = free_type;
  ops.zero_samples = zero_samples;
  ops.realloc_samples = realloc_samples;
  ops.free_samples = free_samples;
  ops.equal = equal;
  ops.hash = hash;
  ops.type_id = type_id;
  ops.type_map = type_map;
  ops.type_info = type_info;
  ops.get_serialized_size = serialized_size;
  ops.serialize_into = serialize_into;
  return ops;
}
constexpr ddsi_sertype_ops type_ops = make_type_ops();

}  // namespace

ddsi_sertype* make_raw_type(const dds_topic_descriptor_t& descriptor) {
  auto* const type = new RawType();
  ddsi_sertype_init_flags(&type->base, descriptor.m_typename, &type_ops, &sample_ops,
                          DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
  type->base.allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  type->descriptor = &descriptor;
  type->storage = std::make_shared<Storage>();
  return &type->base;
}
void release(ddsi_sertype* type) { ddsi_sertype_unref(type); }

ddsi_serdata* make_sample(const ddsi_sertype* type, std::span<const std::byte> first,
                          std::span<const std::byte> rest) {
  std::array<ddsrt_iovec_t, 2> parts{};
  parts[0].iov_base = const_cast<std::byte*>(first.data());
  parts[0].iov_len = first.size();
  parts[1].iov_base = const_cast<std::byte*>(rest.data());
  parts[1].iov_len = rest.size();
  return from_ser_iov(type, SDK_DATA, parts.size(), parts.data(), first.size() + rest.size());
}

std::optional<std::span<const std::byte>> body_of(const ddsi_serdata* sample) {
  const RawSample& bytes = raw(sample);
  if (!bytes.sound) return std::nullopt;
  return std::span<const std::byte>(bytes.body(), bytes.body_bytes);
}
bool is_data(const ddsi_serdata* sample) { return sample->kind == SDK_DATA; }
void release(ddsi_serdata* sample) { ddsi_serdata_unref(sample); }

}  // namespace hearsay::live
