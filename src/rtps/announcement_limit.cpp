#include "rtps/announcement_limit.h"

#include <cstddef>

#include "rtps/datagram_findings.h"

namespace aurasim::rtps {
namespace {

constexpr std::size_t kHeader_B = 20, kSubmessageHeader_B = 4;
constexpr std::uint8_t kInfoTimestamp = 0x09, kInfoDestination = 0x0e, kData = 0x15;
constexpr std::uint8_t kLittleEndian = 0x01, kHasData = 0x04;

/// Number in four octets in the given order.
std::uint32_t number_at(std::span<const std::uint8_t> bytes, std::size_t at, bool little) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) number = number << 8 | bytes[at + (little ? 3 - i : i)];
  return number;
}

}  // namespace

std::optional<std::uint64_t> announcement_in(std::span<const std::uint8_t> datagram) {
  std::size_t at = kHeader_B;
  while (at + kSubmessageHeader_B <= datagram.size()) {
    const std::uint8_t kind = datagram[at], flags = datagram[at + 1];
    const bool little = (flags & kLittleEndian) != 0;
    const std::size_t size =
        little ? datagram[at + 2] | datagram[at + 3] << 8 : datagram[at + 2] << 8 | datagram[at + 3];
    const std::size_t body = at + kSubmessageHeader_B;
    if (kind == kData) {
      const bool is_last = size == 0 || body + size == datagram.size();
      // extra flags, octets to inline QoS, reader, writer, sequence number
      if (!is_last || (flags & kHasData) == 0 || body + 20 > datagram.size()) return std::nullopt;
      if (number_at(datagram, body + 8, false) != kParticipantWriter) return std::nullopt;
      return std::uint64_t{number_at(datagram, body + 12, little)} << 32 | number_at(datagram, body + 16, little);
    }
    if (kind != kInfoTimestamp && kind != kInfoDestination) return std::nullopt;
    at = body + size;
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
