#include "core/joint_ways.h"

#include <algorithm>
#include <deque>

namespace aurasim::core {

std::vector<JointEnds> ends_of(std::span<const JointSpec> joints) {
  std::vector<JointEnds> ends;
  for (const JointSpec& joint : joints) {
    ends.push_back({value_of(joint.a), joint.b ? std::optional<std::uint64_t>(value_of(*joint.b)) : std::nullopt});
  }
  return ends;
}

JointWays::JointWays(std::vector<JointEnds> joints) : joints_(std::move(joints)) {
  for (std::uint32_t i = 0; i < joints_.size(); ++i) {
    joints_of_[joints_[i].a].push_back(JointId{i});
    if (joints_[i].b) joints_of_[*joints_[i].b].push_back(JointId{i});
  }
}

/// Breadth-first search, in order of ids, so the result is unique.
std::vector<JointId> JointWays::way(JointId from, JointId to) const {
  if (from == to) return {};
  std::unordered_map<JointId, JointId> before = {{from, from}};
  for (std::deque<JointId> next = {from}; !next.empty() && !before.contains(to); next.pop_front()) {
    const JointEnds& ends = joints_.at(value_of(next.front()));
    for (const std::optional<std::uint64_t>& body : {std::optional(ends.a), ends.b}) {
      if (!body) continue;
      for (const JointId id : joints_of_.at(*body)) {
        if (before.emplace(id, next.front()).second) next.push_back(id);
      }
    }
  }
  std::vector<JointId> way;
  if (!before.contains(to)) return way;
  for (JointId at = to; at != from; at = before.at(at)) way.push_back(at);
  std::ranges::reverse(way);
  return way;
}

}  // namespace aurasim::core
