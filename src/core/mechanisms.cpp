#include "core/mechanisms.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace aurasim::core {

std::vector<BoundBody> mechanisms_of(std::span<const JointSpec> joints, std::span<const JointId> which) {
  std::vector<BodyId> bodies;
  for (const JointId id : which) {
    const JointSpec& joint = joints[value_of(id)];
    if (joint.b) bodies.push_back(joint.a), bodies.push_back(*joint.b);
  }
  std::ranges::sort(bodies);
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());

  std::vector<std::size_t> parents(bodies.size());
  std::iota(parents.begin(), parents.end(), std::size_t{0});
  const auto first_of = [&parents](std::size_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
  };
  const auto place_of = [&bodies](BodyId id) {
    return static_cast<std::size_t>(std::ranges::lower_bound(bodies, id) - bodies.begin());
  };
  for (const JointId id : which) {
    const JointSpec& joint = joints[value_of(id)];
    if (!joint.b) continue;
    const std::size_t one = first_of(place_of(joint.a)), other = first_of(place_of(*joint.b));
    parents[std::max(one, other)] = std::min(one, other);
  }
  std::vector<BoundBody> bound;
  for (std::size_t i = 0; i < bodies.size(); ++i) bound.push_back({bodies[i], bodies[first_of(i)]});
  return bound;
}

}  // namespace aurasim::core
