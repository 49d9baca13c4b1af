#include "physics/body_table.h"

#include <algorithm>
#include <iterator>

#include "core/find_ascending.h"
#include "physics/bullet_convert.h"
#include "physics/moving_body.h"
#include "physics/prefetch.h"

namespace aurasim::physics {
namespace {

/// Room for so many bodies is never given back.
constexpr std::size_t kFew = 1024;

bool before(const HostedBody& a, const HostedBody& b) { return a.id < b.id; }

}  // namespace

core::BodyRecord HostedBody::record() const {
  core::BodyRecord record;
  record.id = id;
  record.epoch = epoch;
  record.prototype = prototype;
  record.birth = birth;
  record.activation_state = rigid->getActivationState();
  record.deactivation_time = rigid->getDeactivationTime();
  record.p_WB = from_bullet(rigid->getWorldTransform().getOrigin());
  record.R_WB = from_bullet(rigid->getWorldTransform().getBasis());
  record.v_WB = from_bullet(rigid->getLinearVelocity());
  record.w_WB = from_bullet(rigid->getAngularVelocity());
  record.block = place_of(*rigid).block;
  return record;
}

core::BodyState HostedBody::state() const {
  core::BodyState state;
  state.id = id;
  state.epoch = epoch;
  state.prototype = prototype;
  state.awake = rigid->isActive();
  state.birth = birth;
  state.pose.p_WB = from_bullet(rigid->getWorldTransform().getOrigin());
  state.pose.q_WB = core::Quat(from_bullet(rigid->getWorldTransform().getBasis()));
  state.v_WB = from_bullet(rigid->getLinearVelocity());
  state.w_WB = from_bullet(rigid->getAngularVelocity());
  return state;
}

const HostedBody* BodyTable::find(core::BodyId id) const {
  const auto place = std::lower_bound(bodies_.begin(), bodies_.end(), id,
                                      [](const HostedBody& body, core::BodyId wanted) { return body.id < wanted; });
  return place != bodies_.end() && place->id == id ? &*place : nullptr;
}

HostedBody* BodyTable::find(core::BodyId id) {
  return const_cast<HostedBody*>(static_cast<const BodyTable&>(*this).find(id));
}

HostedBody* BodyTable::find(core::BodyId id, std::size_t& near) {
  return const_cast<HostedBody*>(static_cast<const BodyTable&>(*this).find(id, near));
}

const HostedBody* BodyTable::find(core::BodyId id, std::size_t& near) const {
  near = core::find_ascending(bodies_, id, &HostedBody::id, near);
  return near < bodies_.size() && bodies_[near].id == id ? &bodies_[near] : nullptr;
}

void BodyTable::insert(std::vector<HostedBody> arrivals) {
  if (arrivals.empty()) return;
  std::sort(arrivals.begin(), arrivals.end(), before);
  const auto old_size = static_cast<std::ptrdiff_t>(bodies_.size());
  const auto first_moved = std::lower_bound(bodies_.begin(), bodies_.end(), arrivals.front(), before) - bodies_.begin();
  std::move(arrivals.begin(), arrivals.end(), std::back_inserter(bodies_));
  std::inplace_merge(bodies_.begin() + first_moved, bodies_.begin() + old_size, bodies_.end(), before);
  number_from(static_cast<std::size_t>(first_moved));
}

void BodyTable::erase(std::span<const std::uint32_t> leaving) {
  if (leaving.empty()) return;
  const std::size_t first_left = leaving.front();
  std::size_t kept = first_left;
  for (std::size_t i = first_left; i < bodies_.size(); ++i) {
    if (leaving.empty() || i != leaving.front()) {
      bodies_[kept++] = std::move(bodies_[i]);
    } else {
      leaving = leaving.subspan(1);
    }
  }
  bodies_.resize(kept);
  if (bodies_.capacity() > kFew + 2 * kept) bodies_.shrink_to_fit();  // as when the node of a region drops all others
  number_from(first_left);
}

void BodyTable::number_from(std::size_t first) {
  constexpr auto kAhead = static_cast<std::size_t>(kPrefetchDistance);
  for (std::size_t i = first; i < bodies_.size(); ++i) {
    if (i + kAhead < bodies_.size()) prefetch_flags(*bodies_[i + kAhead].rigid);
    bodies_[i].rigid->setUserIndex(static_cast<int>(i));
  }
}

}  // namespace aurasim::physics
