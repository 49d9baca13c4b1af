// Writes what WireCursor reads: octets, and little-endian numbers, at a datagram's end. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace aurasim::rtps {

/// Appends one octet at a time, because GCC 12 warns about insert().
inline void append(std::vector<std::uint8_t>& to, std::span<const std::uint8_t> octets) {
  for (const std::uint8_t octet : octets) to.push_back(octet);
}

inline void append_number(std::vector<std::uint8_t>& to, std::uint32_t number) {
  for (int i = 0; i < 4; ++i) to.push_back(static_cast<std::uint8_t>(number >> 8 * i));
}

/// Appends a 64-bit number as two halves, the high one first.
inline void append_number_pair(std::vector<std::uint8_t>& to, std::uint64_t number) {
  append_number(to, static_cast<std::uint32_t>(number >> 32));
  append_number(to, static_cast<std::uint32_t>(number));
}

}  // namespace aurasim::rtps
