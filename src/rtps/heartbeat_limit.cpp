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
  const Time before = std::exchange(steady.at, now);
  const Time longest = std::min(2 * std::max(steady.apart, kSilence / 2), kLongestSilence / 2);
  const Time apart = steady.last == 0 ? Time{0} : std::min(now - before, longest);
  steady.apart = std::max(apart, steady.apart - steady.apart / 8);
  steady.last = number;
}

void HeartbeatLimit::note_request(const Request& request, Time now) {
  const auto found = writers_.find(request.writer);
  if (found == writers_.end() || request.base == 0) return;
  Steady& steady = found->second;
  if (steady.met.size() >= kMostReaders) steady.met.clear();
  const std::uint64_t met = steady.met.try_emplace(request.reader, steady.last).first->second;
  if (request.wanted > 0 && request.base > met) steady.lossy_until = now + kAfterLoss;
}

bool HeartbeatLimit::allows(const Heartbeat& heartbeat, const Peer& peer, Time now) {
  const auto found = writers_.find(heartbeat.writer);
  if (found == writers_.end()) return true;
  Steady& steady = found->second;
  if (steady.asked.size() >= kMostReaders) steady.asked.clear();
  const auto [place, is_first] = steady.asked.try_emplace({peer, heartbeat.reader});
  Asked& asked = place->second;
  const Time silence = std::clamp(2 * steady.apart, kSilence, kLongestSilence);
  const bool is_repeat = asked.last == steady.last;
  const Time pause = is_repeat ? std::min(silence * (1 << asked.repeats), kLongestPause) : silence;
  const bool is_silent = now - (is_repeat ? asked.at : steady.at) > pause;
  const bool is_lossy = steady.lossy_until && now < *steady.lossy_until;
  const bool is_needed = is_first || is_lossy || is_silent || steady.last - asked.last >= kMostUnasked;
  if (is_needed) asked = {steady.last, now, is_repeat ? std::min(asked.repeats + 1, 8) : 0};
  return is_needed;
}

}  // namespace aurasim::rtps
