#include "core/changed_state.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace aurasim::core {
namespace {

void append(const ManifoldRecord& manifold, const ClusterState& from, ClusterState& to) {
  const auto first = from.points.begin() + static_cast<std::ptrdiff_t>(manifold.first_point * kContactPointDoubles);
  ManifoldRecord& copy = to.manifolds.emplace_back(manifold);
  copy.first_point = static_cast<std::uint32_t>(to.points.size() / kContactPointDoubles);
  to.points.insert(to.points.end(), first,
                   first + static_cast<std::ptrdiff_t>(manifold.point_count * kContactPointDoubles));
}

template <class T>
void free_spare(std::vector<T>& list) {
  constexpr std::size_t kFew = 1024;
  if (list.capacity() > kFew + 4 * list.size()) list.shrink_to_fit();
}

}  // namespace

void free_spare_memory(ChangedState& state) {
  free_spare(state.replaced);
  free_spare(state.parted);
  free_spare(state.now.bodies);
  free_spare(state.now.manifolds);
  free_spare(state.now.points);
  free_spare(state.now.joints);
  free_spare(state.now.joint_values);
}

ClusterState whole(ChangedState state) {
  if (state.before == nullptr) return std::move(state.now);
  const ClusterState &before = *state.before, &now = state.now;
  ClusterState all;
  all.bodies.reserve(before.bodies.size() + now.bodies.size());
  auto next_body = now.bodies.begin();
  for (const BodyRecord& body : before.bodies) {
    if (std::ranges::binary_search(state.replaced, body.id)) continue;
    for (; next_body != now.bodies.end() && next_body->id < body.id; ++next_body) all.bodies.push_back(*next_body);
    all.bodies.push_back(body);
  }
  all.bodies.insert(all.bodies.end(), next_body, now.bodies.end());

  const auto has_parted = [&](ObjectRef ref) {
    return ref >= 0 && std::ranges::binary_search(state.parted, BodyId{static_cast<std::uint64_t>(ref)});
  };
  const auto objects = [](const ManifoldRecord& m) { return std::pair(m.object0, m.object1); };
  all.points.reserve(before.points.size() + now.points.size());
  auto next = now.manifolds.begin();
  for (const ManifoldRecord& manifold : before.manifolds) {
    if (has_parted(manifold.object0) || has_parted(manifold.object1)) continue;
    for (; next != now.manifolds.end() && objects(*next) < objects(manifold); ++next) append(*next, now, all);
    append(manifold, before, all);
  }
  for (; next != now.manifolds.end(); ++next) append(*next, now, all);
  all.joints = std::move(state.now.joints);
  all.joint_values = std::move(state.now.joint_values);
  return all;
}

}  // namespace aurasim::core
