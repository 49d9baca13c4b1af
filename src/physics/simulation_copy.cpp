// Copies of all bodies with all that physics remembers about them, to go back to or to save. Where most bodies sleep,
// a copy has what has changed since an earlier one.
#include <algorithm>
#include <iterator>

#include "core/progress.h"
#include "physics/moving_body.h"
#include "physics/prefetch.h"
#include "physics/simulation.h"

namespace aurasim::physics {
namespace {

/// A copy is shared by later ones until more than this share of the bodies, and a few, have changed.
constexpr std::size_t kOneIn = 8, kFew = 16;

}  // namespace

void Simulation::copy_all(core::ClusterState& all) const {
  all.bodies.clear();
  all.bodies.reserve(table_.size());
  constexpr auto kAhead = static_cast<std::size_t>(kPrefetchDistance);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    if (i + kAhead < table_.size()) {
      prefetch_motion(*table_[i + kAhead].rigid);
      prefetch_flags(*table_[i + kAhead].rigid);
    }
    if (!is_guest(*table_[i].rigid)) all.bodies.push_back(table_[i].record());
  }
  core::Progress::mark();
  copied_contacts_.clear();
  world_.for_each_contact([&](const ContactView& contact) {
    if (coupling_ != nullptr && !is_for_us_to_copy(contact)) return;
    copied_contacts_.push_back({ref_of(contact.body0()), ref_of(contact.body1()), contact});
  });
  write_contacts(copied_contacts_, all);
  joints_.copy_all(table_, all);
}

/// The host of the body with the lower id copies a contact of two hosts.
bool Simulation::is_for_us_to_copy(const ContactView& contact) const {
  const int a = contact.body0().getUserIndex(), b = contact.body1().getUserIndex();
  const int first = is_static(a) || is_static(b) ? std::max(a, b) : std::min(a, b);
  return !is_guest(*table_[static_cast<std::size_t>(first)].rigid);
}

void Simulation::copy_all(core::ChangedState& copy) {
  copy.before = nullptr;
  copy.replaced.clear();
  copy.parted.clear();
  const auto is_few = [this](std::size_t count) { return count <= table_.size() / kOneIn + kFew; };
  const bool shares =
      shared_copy_ && !notes_.for_copy.all() && is_few(notes_.for_copy.most() / 2 + notes_.pairs.size() / 4);
  if (shares) return copy_changes(copy);
  notes_.give_up_copy();
  shared_copy_ = nullptr;
  if (!world_.knows_moved() || !is_few(moved_count_)) return copy_all(copy.now);
  auto all = std::make_shared<core::ClusterState>();
  copy_all(*all);
  shared_copy_ = std::move(all);
  notes_.begin_copy();
  copy_changes(copy);
}

void Simulation::copy_changes(core::ChangedState& copy) {
  copy.before = shared_copy_;
  copy.now.bodies.clear();
  notes_.for_copy.for_each(table_, [&](const HostedBody& body, std::size_t) {
    if (!is_guest(*body.rigid)) copy.now.bodies.push_back(body.record());
  });
  std::ranges::copy(notes_.for_copy.ids(), std::back_inserter(copy.replaced));
  std::ranges::copy(notes_.parted.ids(), std::back_inserter(copy.parted));
  copied_contacts_.clear();
  notes_.sort_pairs();
  for (const auto& [one, other] : notes_.pairs) {
    const btRigidBody *const a = find_object(one), *const b = find_object(other);
    if (a == nullptr || b == nullptr) continue;
    found_contacts_.clear();
    world_.add_contacts(*a, *b, found_contacts_);
    for (const ContactView& contact : found_contacts_) {
      if (coupling_ != nullptr && !is_for_us_to_copy(contact)) continue;
      copied_contacts_.push_back({ref_of(contact.body0()), ref_of(contact.body1()), contact});
    }
  }
  write_contacts(copied_contacts_, copy.now);
  joints_.copy_all(table_, copy.now);
}

}  // namespace aurasim::physics
