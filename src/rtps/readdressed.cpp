#include "rtps/readdressed.h"

#include <algorithm>
#include <cstddef>

#include "rtps/submessages.h"

namespace aurasim::rtps {

std::optional<std::vector<std::uint8_t>> for_everybody(std::span<const std::uint8_t> datagram) {
  if (datagram.size() < kHeaderBytes) return std::nullopt;
  std::vector<std::uint8_t> copy(datagram.begin(), datagram.end());
  WireCursor rest = submessages_of(datagram);
  while (rest.left() >= kSubmessageHeader_B) {
    const Submessage next = take_submessage(rest);
    if (rest.failed()) return std::nullopt;
    if (next.kind != kInfoDestination) continue;
    if (next.size_B != GuidPrefix{}.size()) return std::nullopt;
    std::fill_n(copy.begin() + static_cast<std::ptrdiff_t>(next.body.at()), next.size_B, std::uint8_t{0});
  }
  return rest.left() == 0 ? std::optional(std::move(copy)) : std::nullopt;
}

GuidPrefix sender_of(std::span<const std::uint8_t> datagram) {
  constexpr std::size_t kPrefixAt = 8;
  GuidPrefix prefix{};
  if (datagram.size() >= kHeaderBytes) std::copy_n(datagram.begin() + kPrefixAt, prefix.size(), prefix.begin());
  return prefix;
}

}  // namespace aurasim::rtps
