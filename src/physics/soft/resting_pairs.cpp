#include "physics/soft/resting_pairs.h"

#include <algorithm>

#include "core/progress.h"
#include "physics/contact_pairs.h"
#include "physics/dispatcher.h"
#include "physics/first_contacts.h"
#include "physics/made_manifolds.h"
#include "physics/soft/islands.h"
#include "physics/soft/pair_note.h"
#include "physics/spare_memory.h"

namespace aurasim::physics {

/// Pairs with guests stay, since a guest may be moved at any time.
void RestingPairs::put_away(const SoftIslands& islands) {
  constexpr int kLooks = 512, kLooksForAll = 16, kMost = 256, kMostForAll = 256, kMany = 4096;
  const auto rests = [&islands](std::uint32_t slot) {
    return islands.sleeps(slot) && islands.slept(slot) && !islands.is_guest(slot);
  };
  btBroadphasePairArray& all = pairs_.getOverlappingPairArray();
  const int most = std::max(kMost, all.size() / kMostForAll);
  int left = most;
  for (int looks = std::min(all.size(), std::max(kLooks, all.size() / kLooksForAll)); looks > 0 && left > 0; --looks) {
    if (next_ >= all.size()) next_ = 0;
    const PairNote note = note_of(all[next_]);
    if (!rests(note.a) || !rests(note.b())) {
      ++next_;
      continue;
    }
    core::Progress::mark_now_and_then(static_cast<std::size_t>(--left));
    pairs_.sleeping().put(all[next_]);
    pairs_.removeOverlappingPair(all[next_].m_pProxy0, all[next_].m_pProxy1, &dispatcher_);  // the last one moves here
  }
  put_ += most - left;
  if (left < most) return pairs_.free_spare_memory();
  if (put_ < kMany) return;
  give_memory_back();
  put_ = 0;
}

void RestingPairs::bring_back(std::uint32_t slot, const btDispatcherInfo& info) {
  while (pairs_.sleeping().has(slot)) {
    const SleepingPairs::Pair back = pairs_.sleeping().take_one(slot);
    btBroadphasePair* const pair = pairs_.addOverlappingPair(back.proxy0, back.proxy1);
    if (pair == nullptr || back.contacts == nullptr) continue;
    make_manifolds(*pair, dispatcher_, info, made_);
    SleepingPairs::for_each_contact_of(back, [this](const ContactView& contact) {
      rows_.resize(contact.count() * core::kContactPointDoubles);
      contact.write(rows_.data());
      btPersistentManifold* const made = restore_points(made_, contact.body0(), contact.parts(), rows_);
      if (made != nullptr) first_contacts_.know(*made);
    });
  }
}

}  // namespace aurasim::physics
