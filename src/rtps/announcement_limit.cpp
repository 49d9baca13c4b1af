#include "rtps/announcement_limit.h"

#include <cstddef>

#include "rtps/datagram_findings.h"
#include "rtps/wire_cursor.h"

namespace aurasim::rtps {
namespace {

constexpr std::size_t kHeader_B = 20, kSubmessageHeader_B = 4;
/// eProsima's statistics end each datagram of a Fast DDS that is built with them, as Debian's is.
constexpr std::uint8_t kInfoTimestamp = 0x09, kInfoDestination = 0x0e, kData = 0x15, kStatistics = 0x80;
constexpr std::uint8_t kLittleEndian = 0x01, kHasData = 0x04;

/// True if nothing but statistics follows the submessage that has `size` bytes from here; 0: all that are left.
bool is_last(WireCursor rest, std::size_t size) {
  if (size == 0 || size == rest.left()) return true;
  rest.skip(size);
  return !rest.failed() && rest.left() >= kSubmessageHeader_B && rest.u8() == kStatistics;
}

}  // namespace

std::optional<std::uint64_t> announcement_in(std::span<const std::uint8_t> datagram) {
  if (datagram.size() < kHeader_B) return std::nullopt;
  WireCursor rest(datagram, kHeader_B, datagram.size(), false);
  while (rest.left() >= kSubmessageHeader_B) {
    const std::uint8_t kind = rest.u8(), flags = rest.u8();
    rest.set_little((flags & kLittleEndian) != 0);
    const std::size_t size = rest.u16();
    if (kind == kData) {
      if (!is_last(rest, size) || (flags & kHasData) == 0) return std::nullopt;
      rest.skip(8);  // extra flags, octets to inline QoS, reader
      const std::uint32_t writer = rest.entity();
      const std::uint64_t number = rest.sequence_number();
      return rest.failed() || writer != kParticipantWriter ? std::nullopt : std::optional(number);
    }
    if (kind != kInfoTimestamp && kind != kInfoDestination) return std::nullopt;
    rest.skip(size);
  }
  return std::nullopt;
}

bool AnnouncementLimit::allows(const Peer& peer, std::uint64_t number, Time now) {
  if (!is_limited()) return true;
  const std::lock_guard lock(mutex_);
  if (sent_.size() >= kMostPeers && !sent_.contains(peer)) sent_.clear();
  const auto [sent, is_first] = sent_.try_emplace(peer, Sent{number, now});
  if (!is_first && sent->second.number == number && now - sent->second.at < shortest_) return false;
  sent->second = {number, now};
  return true;
}

}  // namespace aurasim::rtps
