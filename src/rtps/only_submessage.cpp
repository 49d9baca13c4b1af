#include "rtps/only_submessage.h"

#include <cstddef>

#include "rtps/datagram_findings.h"

namespace aurasim::rtps {

std::optional<Submessage> only_submessage(std::span<const std::uint8_t> datagram) {
  constexpr std::size_t kSubmessageHeader_B = 4;
  constexpr std::uint8_t kInfoTimestamp = 0x09, kInfoDestination = 0x0e, kStatistics = 0x80, kLittleEndian = 0x01;
  if (datagram.size() < kHeaderBytes) return std::nullopt;
  WireCursor rest(datagram, kHeaderBytes, datagram.size(), false);
  std::optional<Submessage> found;
  while (rest.left() >= kSubmessageHeader_B) {
    const std::uint8_t kind = rest.u8(), flags = rest.u8();
    rest.set_little((flags & kLittleEndian) != 0);
    const std::size_t size = rest.u16();
    const bool goes_to_end = size == 0 && kind != kInfoTimestamp;  // a time may be empty
    const WireCursor body = rest.part(goes_to_end ? rest.left() : size);
    if (found) return kind == kStatistics ? found : std::nullopt;
    if (rest.failed()) return std::nullopt;
    if (kind != kInfoTimestamp && kind != kInfoDestination) found = Submessage{kind, flags, body};
  }
  return rest.left() == 0 ? found : std::nullopt;
}

}  // namespace aurasim::rtps
