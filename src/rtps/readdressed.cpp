#include "rtps/readdressed.h"

#include <algorithm>
#include <cstddef>

#include "rtps/wire_cursor.h"

namespace aurasim::rtps {

std::optional<std::vector<std::uint8_t>> for_everybody(std::span<const std::uint8_t> datagram) {
  constexpr std::size_t kSubmessageHeader_B = 4;
  constexpr std::uint8_t kInfoTimestamp = 0x09, kInfoDestination = 0x0e, kLittleEndian = 0x01;
  if (datagram.size() < kHeaderBytes) return std::nullopt;
  std::vector<std::uint8_t> copy(datagram.begin(), datagram.end());
  WireCursor rest(datagram, kHeaderBytes, datagram.size(), false);
  while (rest.left() >= kSubmessageHeader_B) {
    const std::uint8_t kind = rest.u8(), flags = rest.u8();
    rest.set_little((flags & kLittleEndian) != 0);
    const std::size_t size = rest.u16();
    const bool goes_to_end = size == 0 && kind != kInfoTimestamp;  // a time may be empty
    const std::size_t begin = rest.at();
    rest.skip(goes_to_end ? rest.left() : size);
    if (rest.failed()) return std::nullopt;
    if (kind != kInfoDestination) continue;
    if (size != GuidPrefix{}.size()) return std::nullopt;
    std::fill_n(copy.begin() + static_cast<std::ptrdiff_t>(begin), size, std::uint8_t{0});
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
