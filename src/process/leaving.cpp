#include "process/leaving.h"

#include <algorithm>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatienceWithSuccessor = 20s;

bool contains(const std::vector<messages::KeptPart>& parts, const messages::KeptPart& part) {
  return std::ranges::find(parts, part) != parts.end();
}

}  // namespace

bool has_successor(const std::vector<messages::SeenStatus>& strangers, const messages::Status& own) {
  return std::ranges::any_of(strangers, [&own](const messages::SeenStatus& stranger) {
    const messages::Status& other = stranger.status;
    return other.region == own.region && other.state == messages::NodeState::kSpare &&
           other.agreement == own.agreement && other.run == own.run;
  });
}

void Leaving::begin(Clock::time_point now) { leaves_by_ = now + kPatienceWithSuccessor; }

bool Leaving::note_drain(const messages::RunCommand& drain, const SeenNodes& nodes) {
  const auto meant = nodes.find(drain.region);
  const bool is_self = drain.region == region_ && drain.process == process_;
  const bool is_there = is_self || (meant != nodes.end() && meant->second.status.process == drain.process);
  if (!is_there || !processes_.insert(drain.process).second) return false;
  drains_ = drains_ || is_self;
  return true;
}

bool Leaving::can_leave_to_others(const SeenNodes& nodes) const {
  return std::ranges::any_of(nodes, [this](const auto& entry) {
    return entry.first != region_ && entry.second.is_live() && !processes_.contains(entry.second.status.process);
  });
}

bool Leaving::may_leave(bool has_successor, const KeptView& kept, const SeenNodes& nodes) {
  if (!has_successor) return false;
  if (!successor_since_) successor_since_ = kept.step;
  return std::ranges::any_of(kept.parts, [&](const messages::KeptPart& part) {
    if (part.region != region_ || (part.step < *successor_since_ && !kept.is_paused)) return false;
    return std::ranges::all_of(nodes, [&](const auto& entry) {
      if (entry.first == region_) return true;
      const std::vector<messages::KeptPart>& theirs = entry.second.status.parts;
      const bool is_keeper = std::ranges::find(kept.keepers, entry.first) != kept.keepers.end();
      return contains(theirs, {entry.first, part.step}) && (!is_keeper || contains(theirs, part));
    });
  });
}

}  // namespace aurasim::process
