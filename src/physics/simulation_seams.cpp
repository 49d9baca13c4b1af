// Coupled regions: which of them may have contacts in common in a step. Two regions find that out each for itself, with
// the same result, from bodies that both of them know. Where no body of the one may touch a body of the other, there is
// nothing to tell about contacts.
#include <algorithm>
#include <map>

#include "physics/bounds.h"
#include "physics/moving_body.h"
#include "physics/simulation.h"

namespace aurasim::physics {
namespace {

Bounds hull_of(std::span<const Bounds> boxes) {
  Bounds hull;
  for (const Bounds& box : boxes) hull.add(box);
  return hull;
}

/// Does one of `ours` overlap one of `theirs`?
bool any_overlap(std::span<const Bounds> ours, std::vector<Bounds> theirs) {
  const Bounds around = hull_of(ours);
  std::erase_if(theirs, [&](const Bounds& box) { return !overlap(box, around); });
  if (theirs.empty()) return false;
  const Bounds hull = hull_of(theirs);
  const int axis = (hull.high - hull.low).maxAxis();  // along a border bodies are apart
  btScalar longest = 0;
  for (const Bounds& box : theirs) longest = std::max(longest, box.high[axis] - box.low[axis]);
  const auto low = [axis](const Bounds& box) { return box.low[axis]; };
  std::ranges::sort(theirs, {}, low);
  return std::ranges::any_of(ours, [&](const Bounds& box) {
    if (!overlap(box, hull)) return false;
    auto other = std::ranges::lower_bound(theirs, box.low[axis] - longest - Bounds::kNear_m, {}, low);
    for (; other != theirs.end() && other->low[axis] <= box.high[axis]; ++other) {
      if (overlap(box, *other)) return true;
    }
    return false;
  });
}

}  // namespace

/// If a body that this region hosts may touch a guest, its host knows both, and what they may touch. So the other
/// region finds the same. Chains of contacts over several regions need more.
void Simulation::find_seams() {
  std::vector<Bounds> ours;
  std::map<core::RegionId, std::vector<Bounds>> theirs;
  for (const AtBorder& body : at_border_) ours.push_back(body.reach);
  for (const Moved& arrived : arrived_) ours.push_back(reach_of(*table_.find(arrived.body.id)->rigid));
  std::size_t near = 0;
  for (const core::BodyId id : guests_) {
    const btRigidBody& guest = *table_.find(id, near)->rigid;
    theirs[place_of(guest).host].push_back(reach_of(guest));
  }
  std::vector<core::RegionId> expected;
  for_each_peer(*coupling_, [&](core::RegionId peer) {
    if (coupling_->may_share_chains(peer) || any_overlap(ours, theirs[peer])) expected.push_back(peer);
  });
  world_.expect_contacts_with(expected);
}

}  // namespace aurasim::physics
