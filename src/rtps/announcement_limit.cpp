#include "rtps/announcement_limit.h"

#include "rtps/datagram_findings.h"
#include "rtps/submessages.h"

namespace aurasim::rtps {

std::optional<std::uint64_t> announcement_in(std::span<const std::uint8_t> datagram) {
  constexpr std::uint8_t kData = 0x15, kHasData = 0x04;
  auto only = only_submessage(datagram);
  if (!only || only->kind != kData || (only->flags & kHasData) == 0) return std::nullopt;
  WireCursor& body = only->body;
  body.skip(8);  // extra flags, octets to inline QoS, reader
  const std::uint32_t writer = body.entity();
  const std::uint64_t number = body.sequence_number();
  return body.failed() || writer != kParticipantWriter ? std::nullopt : std::optional(number);
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
