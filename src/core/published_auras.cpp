#include "core/published_auras.h"

#include <algorithm>

namespace aurasim::core {

void PublishedAuras::sort(AuraBatch& batch) {
  const auto by_id = [](const AuraRecord& a, const AuraRecord& b) { return a.id < b.id; };
  if (!std::ranges::is_sorted(batch.updates, by_id)) std::ranges::stable_sort(batch.updates, by_id);
  std::ranges::sort(batch.deletes);
}

void PublishedAuras::merge(const AuraBatch& batch) {
  if (batch.full) auras_.clear();
  if (batch.updates.empty() && batch.deletes.empty()) return;
  merged_.clear();
  auto old = auras_.begin();
  auto gone = batch.deletes.begin();
  const auto keep = [&](const AuraRecord& aura) {
    while (gone != batch.deletes.end() && *gone < aura.id) ++gone;
    if (gone == batch.deletes.end() || *gone != aura.id) merged_.push_back(aura);
  };
  for (const AuraRecord& update : batch.updates) {
    for (; old != auras_.end() && old->id < update.id; ++old) keep(*old);
    if (old != auras_.end() && old->id == update.id) ++old;
    if (update.audience & self_) merged_.push_back(update);
  }
  for (; old != auras_.end(); ++old) keep(*old);
  std::swap(auras_, merged_);
}

}  // namespace aurasim::core
