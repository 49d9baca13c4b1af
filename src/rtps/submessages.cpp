#include "rtps/submessages.h"

#include "rtps/datagram_findings.h"

namespace aurasim::rtps {

WireCursor submessages_of(std::span<const std::uint8_t> datagram) {
  return {datagram, kHeaderBytes, datagram.size(), false};
}

Submessage take_submessage(WireCursor& rest) {
  constexpr std::uint8_t kLittleEndian = 0x01;
  const std::uint8_t kind = rest.u8(), flags = rest.u8();
  rest.set_little((flags & kLittleEndian) != 0);
  const std::size_t size = rest.u16();
  const bool goes_to_end = size == 0 && kind != kInfoTimestamp;  // a time may be empty
  return {kind, flags, size, rest.part(goes_to_end ? rest.left() : size)};
}

std::optional<Submessage> only_submessage(std::span<const std::uint8_t> datagram) {
  constexpr std::uint8_t kStatistics = 0x80;
  if (datagram.size() < kHeaderBytes) return std::nullopt;
  WireCursor rest = submessages_of(datagram);
  std::optional<Submessage> found;
  while (rest.left() >= kSubmessageHeader_B) {
    const Submessage next = take_submessage(rest);
    if (found) return next.kind == kStatistics ? found : std::nullopt;
    if (rest.failed()) return std::nullopt;
    if (next.kind != kInfoTimestamp && next.kind != kInfoDestination) found = next;
  }
  return rest.left() == 0 ? found : std::nullopt;
}

}  // namespace aurasim::rtps
