// Requests memory before it is needed.
#pragma once

#include <cstddef>

namespace aurasim::core {

inline void prefetch(const void* begin, std::size_t bytes) {
  constexpr std::size_t kCacheLine = 64;
  const char* const first = static_cast<const char*>(begin);
  for (std::size_t at = 0; at < bytes; at += kCacheLine) __builtin_prefetch(first + at);
  __builtin_prefetch(first + bytes - 1);
}

}  // namespace aurasim::core
