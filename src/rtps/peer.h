// Where a datagram is sent to, and by which socket.
#pragma once

#include <array>
#include <compare>
#include <cstdint>

namespace aurasim::rtps {

struct Peer {
  std::uintptr_t socket = 0;
  std::array<std::uint8_t, 16> address{};
  std::uint32_t port = 0;
  auto operator<=>(const Peer&) const = default;
};

}  // namespace aurasim::rtps
