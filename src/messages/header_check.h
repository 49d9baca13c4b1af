// Checks the header that every message begins with, before anything else.
#pragma once

#include <optional>

#include "messages/wire_error.h"

namespace aurasim::messages {

/// Checks version, generation and map version. `Message` is any wire type.
template <class Message>
std::optional<WireError> check_header(const Message& in, const Expected& expected) {
  if (in.version() == 0) {  // set by GuardedType
    return WireError::kMalformed;
  }
  if (in.version() != kProtocolVersion) {
    return WireError::kVersion;
  }
  if (expected.map_version && in.map_version() != *expected.map_version) {
    return WireError::kMapVersion;
  }
  if (expected.generation && in.generation() != *expected.generation) {
    return WireError::kGeneration;
  }
  return std::nullopt;
}

template <class Message>
std::optional<WireError> check_source(const Message& in, const Expected& expected) {
  if (in.source() >= expected.region_count) {
    return WireError::kRange;
  }
  if (expected.source && in.source() != core::value_of(*expected.source)) {
    return WireError::kSource;
  }
  return std::nullopt;
}

template <class Message>
std::optional<WireError> check_destination(const Message& in, const Expected& expected) {
  if (in.destination() >= expected.region_count) {
    return WireError::kRange;
  }
  if (expected.destination && in.destination() != core::value_of(*expected.destination)) {
    return WireError::kSource;
  }
  return std::nullopt;
}

}  // namespace aurasim::messages
