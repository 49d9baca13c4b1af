#include "core/handoff.h"

#include <algorithm>

namespace aurasim::core {

const HandOff& DepartureLedger::record(HandOff hand_off) {
  hand_off.sequence = ++last_sequence_[hand_off.destination];
  open_.push_back(std::move(hand_off));
  return open_.back();
}

bool DepartureLedger::acknowledge(RegionId destination, std::uint64_t sequence) {
  const auto found = std::find_if(open_.begin(), open_.end(), [&](const HandOff& h) {
    return h.destination == destination && h.sequence == sequence;
  });
  if (found == open_.end()) return false;
  open_.erase(found);
  return true;
}

void DepartureLedger::due_again(Step now, Step patience, std::vector<HandOff>& out) const {
  for (const HandOff& h : open_) {
    if (now > h.stamp && (now - h.stamp) % patience == 0) out.push_back(h);
  }
}

std::vector<HandOff> DepartureLedger::take_open(RegionId destination) {
  std::vector<HandOff> taken;
  for (HandOff& h : open_) {
    if (h.destination == destination) taken.push_back(std::move(h));
  }
  std::erase_if(open_, [&](const HandOff& h) { return h.destination == destination; });
  return taken;
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

void ArrivalLedger::adopted(RegionId source, Step now, const ClusterState& cluster) {
  for (const BodyRecord& body : cluster.bodies) adoptions_.push_back({now, source, {body.id, body.epoch}});
}

void ArrivalLedger::forget_adoptions_before(Step step) {
  while (!adoptions_.empty() && adoptions_.front().step < step) adoptions_.pop_front();
}

std::vector<BodyEpoch> ArrivalLedger::adopted_from(RegionId source) const {
  std::vector<BodyEpoch> bodies;
  for (const Adoption& a : adoptions_) {
    if (a.source == source) bodies.push_back(a.body);
  }
  return bodies;
}

}  // namespace aurasim::core
