#include "node/touches.h"

#include <algorithm>
#include <utility>

namespace aurasim::node {

/// Compares the bodies of this state with those of the state before. Both lists are in ascending order and share most
/// bodies.
void Touches::note(const core::Snapshot& snapshot) {
  const bool goes_on = snapshot.goes_on_from(seen_);
  seen_ = snapshot.number;
  if (goes_on) {
    for (const core::Contact& contact : snapshot.changed_contacts) {
      now_[contact.a].touched = now_[contact.b].touched = true;
    }
    return;
  }
  std::swap(now_, before_);
  now_.clear();
  auto before = before_.begin();
  for (const core::BodyState& body : snapshot.bodies) {
    while (before != before_.end() && before->id < body.id) ++before;
    now_.push_back({body.id, before != before_.end() && before->id == body.id && before->touched});
  }
  for (const core::Contact& contact : snapshot.contacts) now_[contact.a].touched = now_[contact.b].touched = true;
}

bool Touches::take(core::BodyId id) {
  const auto found = std::ranges::lower_bound(now_, id, {}, &Touch::id);
  return found != now_.end() && found->id == id && std::exchange(found->touched, false);
}

}  // namespace aurasim::node
