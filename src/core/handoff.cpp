#include "core/handoff.h"

#include <algorithm>

namespace aurasim::core {

const HandOff& DepartureLedger::record(HandOff hand_off) {
  hand_off.sequence = ++last_sequence_[hand_off.destination];
  open_.push_back(std::move(hand_off));
  return open_.back();
}

void DepartureLedger::acknowledge(RegionId destination, std::uint64_t last_sequence) {
  std::erase_if(open_, [&](const HandOff& h) { return h.destination == destination && h.sequence <= last_sequence; });
}

void DepartureLedger::due_again(Step now, Step patience, std::vector<HandOff>& out) const {
  for (const HandOff& h : open_) {
    if (now > h.stamp && (now - h.stamp) % patience == 0) out.push_back(h);
  }
}

std::uint64_t DepartureLedger::last_sequence(RegionId destination) const {
  const auto found = last_sequence_.find(destination);
  return found == last_sequence_.end() ? 0 : found->second;
}

bool ArrivalLedger::first_copy(RegionId source, std::uint64_t sequence) {
  Stream& stream = streams_[source];
  if (sequence <= stream.contiguous || !stream.ahead.insert(sequence).second) return false;
  while (!stream.ahead.empty() && *stream.ahead.begin() == stream.contiguous + 1) {
    stream.ahead.erase(stream.ahead.begin());
    ++stream.contiguous;
  }
  return true;
}

bool ArrivalLedger::has_all_up_to(RegionId source, std::uint64_t sequence) const {
  const auto found = streams_.find(source);
  return sequence <= (found == streams_.end() ? 0 : found->second.contiguous);
}

std::vector<HandOffMark> ArrivalLedger::all_arrived() const {
  std::vector<HandOffMark> marks;
  for (const auto& [source, stream] : streams_) {
    if (stream.contiguous > 0) marks.push_back({source, stream.contiguous});
  }
  return marks;
}

}  // namespace aurasim::core
