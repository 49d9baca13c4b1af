#include "rtps/heartbeat_limit.h"

#include <algorithm>

#include "rtps/submessages.h"

namespace aurasim::rtps {

std::optional<Heartbeat> heartbeat_in(std::span<const std::uint8_t> datagram) {
  constexpr std::uint8_t kHeartbeat = 0x07, kFinal = 0x02, kLiveliness = 0x04;
  auto only = only_submessage(datagram);
  if (!only || only->kind != kHeartbeat || (only->flags & (kFinal | kLiveliness)) != 0) return std::nullopt;
  const std::uint32_t reader = only->body.entity();
  const Heartbeat found{only->body.entity(), reader};
  return only->body.failed() ? std::nullopt : std::optional(found);
}

void HeartbeatLimit::remove_writer(std::uint32_t writer) { writers_.erase(writer); }

void HeartbeatLimit::note_sent(std::uint32_t writer, std::uint64_t number, Time now) {
  const auto found = writers_.find(writer);
  if (found == writers_.end() || number <= found->second.last) return;
  Steady& steady = found->second;
  steady.apart = now - std::exchange(steady.at, now);
  steady.last = number;
}

void HeartbeatLimit::note_loss(std::uint32_t writer, Time now) {
  const auto found = writers_.find(writer);
  if (found != writers_.end()) found->second.lossy_until = now + kAfterLoss;
}

bool HeartbeatLimit::allows(const Heartbeat& heartbeat, const Peer& peer, Time now) {
  const auto found = writers_.find(heartbeat.writer);
  if (found == writers_.end()) return true;
  Steady& steady = found->second;
  if (steady.asked.size() >= kMostReaders) steady.asked.clear();
  const auto [asked, is_first] = steady.asked.try_emplace({peer, heartbeat.reader}, steady.last);
  const Time silence = std::clamp(2 * steady.apart, kSilence, kLongestSilence);
  const bool is_lossy = steady.lossy_until && now < *steady.lossy_until;
  const bool is_needed =
      is_first || is_lossy || now - steady.at > silence || steady.last - asked->second >= kMostUnasked;
  if (is_needed) asked->second = steady.last;
  return is_needed;
}

}  // namespace aurasim::rtps
