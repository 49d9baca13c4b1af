#include "cut/save_ledger.h"

#include <algorithm>

namespace aurasim::cut {
namespace {

using namespace std::chrono_literals;

/// Number of saves that a status names. It is large enough that others receive each save at least once.
constexpr std::size_t kTold = 16;
/// How long a failed save waits for the statuses of all regions, so that its message can name all that have failed.
constexpr auto kUntilAllHaveSpoken = 2s;

void tell(std::deque<std::uint64_t>& saves, std::uint64_t save) {
  saves.push_back(save);
  if (saves.size() > kTold) saves.pop_front();
}

}  // namespace

SaveLedger::Open* SaveLedger::find(std::uint64_t save) {
  const auto found = std::ranges::find(open_, save, &Open::save);
  return found == open_.end() ? nullptr : &*found;
}

void SaveLedger::note_own(std::uint64_t save, bool is_written) {
  tell(is_written ? saved_ : not_saved_, save);
  if (Open* const open = find(save)) (is_written ? open->has : open->without).insert(self_);
}

void SaveLedger::receive(core::RegionId region, const std::vector<std::uint64_t>& saved,
                         const std::vector<std::uint64_t>& not_saved) {
  if (region == self_) return;
  for (Open& open : open_) {
    if (std::ranges::find(saved, open.save) != saved.end()) open.has.insert(region);
    if (std::ranges::find(not_saved, open.save) != not_saved.end()) open.without.insert(region);
  }
}

void SaveLedger::forget(std::uint64_t save) {
  std::erase_if(open_, [save](const Open& open) { return open.save == save; });
}

std::vector<SaveLedger::Outcome> SaveLedger::take_outcomes(Clock::time_point now) {
  std::vector<Outcome> outcomes;
  std::erase_if(open_, [&](Open& open) {
    if (open.has.size() == regions_) {
      outcomes.push_back({open.save, SaveFate::kWhole, {}});
      return true;
    }
    if (open.without.empty()) return false;
    if (!open.failed_since) open.failed_since = now;
    const bool own_is_known = open.has.contains(self_) || open.without.contains(self_);
    const bool all_have_spoken = open.has.size() + open.without.size() == regions_;
    if (!own_is_known || (!all_have_spoken && now < *open.failed_since + kUntilAllHaveSpoken)) return false;
    outcomes.push_back({open.save, SaveFate::kFailed, {open.without.begin(), open.without.end()}});
    return true;
  });
  return outcomes;
}

}  // namespace aurasim::cut
