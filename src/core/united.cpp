#include "core/united.h"

#include <algorithm>
#include <utility>

namespace aurasim::core {

void append(ClusterState& to, const ClusterState& from) {
  const auto first_point = static_cast<std::uint32_t>(to.points.size() / kContactPointDoubles);
  const auto first_value = static_cast<std::uint32_t>(to.joint_values.size());
  to.bodies.insert(to.bodies.end(), from.bodies.begin(), from.bodies.end());
  for (ManifoldRecord manifold : from.manifolds) {
    manifold.first_point += first_point;
    to.manifolds.push_back(manifold);
  }
  to.points.insert(to.points.end(), from.points.begin(), from.points.end());
  for (JointRecord joint : from.joints) {
    joint.first_value += first_value;
    to.joints.push_back(joint);
  }
  to.joint_values.insert(to.joint_values.end(), from.joint_values.begin(), from.joint_values.end());
}

void put_in_order(ClusterState& cluster) {
  std::ranges::sort(cluster.bodies, {}, &BodyRecord::id);
  // Stable, because two compounds have several manifolds, whose order counts.
  std::ranges::stable_sort(cluster.manifolds, {},
                           [](const ManifoldRecord& m) { return std::pair(m.object0, m.object1); });
}

}  // namespace aurasim::core
