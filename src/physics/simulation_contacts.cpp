#include <algorithm>
#include <tuple>
#include <utility>

#include "physics/moving_body.h"
#include "physics/simulation.h"

namespace aurasim::physics {

/// Call before bodies come or go, because the sums name bodies by their places.
void Simulation::collect_contact_impulses() {
  contact_impulses_.clear();
  for (const auto& [objects, sum] : world_.contact_impulses().sums()) {
    const int first = is_static(objects.second) ? objects.first : objects.second;
    if (is_guest(*table_[static_cast<std::size_t>(first)].rigid)) continue;  // its host reports
    const auto ref = [this](int index) -> core::ObjectRef {
      return is_static(index) ? index : core::ref_of(table_[static_cast<std::size_t>(index)].id);
    };
    core::ContactImpulse contact{ref(objects.first), ref(objects.second), from_bullet(sum.p / scalar(sum.impulse)),
                                 from_bullet(sum.normal).stableNormalized(), sum.impulse};
    if (contact.b >= 0) {  // bodies have places in the order of their ids, and the higher place is first
      std::swap(contact.a, contact.b);
      contact.normal_W = -contact.normal_W;
    }
    const bool is_sound = contact.p_W.allFinite() && contact.normal_W.allFinite();
    if (is_sound) contact_impulses_.push_back(contact);
  }
  std::ranges::sort(contact_impulses_, {}, [](const core::ContactImpulse& c) { return std::tie(c.a, c.b); });
}

}  // namespace aurasim::physics
