// Samples of a topic as the bytes they are on the wire, instead of as C structs: a type of
// Cyclone's (sertype) and its samples (serdata). Not for users.
#pragma once

#include <dds/dds.h>

#include <cstddef>
#include <optional>
#include <span>

struct ddsi_sertype;
struct ddsi_serdata;

namespace hearsay::live {

/// A type for dds_create_topic_sertype() that shows itself to others as the type described does.
/// `descriptor` must outlive it. One use of it is the caller's.
ddsi_sertype* make_raw_type(const dds_topic_descriptor_t& descriptor);
void release(ddsi_sertype* type);

/// A sample for dds_writecdr(), which takes it over. The bytes are copied, `rest` behind `first`:
/// header of four bytes and body. Null if there is no header.
ddsi_serdata* make_sample(const ddsi_sertype* type, std::span<const std::byte> first,
                          std::span<const std::byte> rest);

/// The body of a sample, as long as the sample lives: little-endian, without padding at its end.
/// Nothing if the bytes are no sample of the type.
std::optional<std::span<const std::byte>> body_of(const ddsi_serdata* sample);
/// Whether it is a sample at all, and not the news that a writer has gone.
bool is_data(const ddsi_serdata* sample);
void release(ddsi_serdata* sample);

}  // namespace hearsay::live
