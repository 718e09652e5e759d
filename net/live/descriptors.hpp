// Cyclone's descriptions of our types. Not for users.
#pragma once

#include <dds/dds.h>

#include "net/live/topics.hpp"

namespace hearsay::live {

const dds_topic_descriptor_t& descriptor_of(Type type);

}  // namespace hearsay::live
