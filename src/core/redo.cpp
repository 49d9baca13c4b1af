#include "core/redo.h"

#include <algorithm>
#include <utility>

namespace aurasim::core {
namespace {

/// One redo brings at most so many pairs together. Other pairs are found again if they still touch.
constexpr std::size_t kMostStanding = 4096;

bool same_pair(const Alarm& x, const Alarm& y) { return x.a == y.a && x.b == y.b; }

}  // namespace

void AlarmLog::raise(Step step, BodyId a, BodyId b) {
  const auto [first, second] = std::minmax(a, b);
  add({redo(), step, first, second});
}

void AlarmLog::receive(std::span<const Alarm> alarms) {
  for (const Alarm& alarm : alarms) {
    if (stands(alarm)) add(alarm);
  }
}

/// Keeps and publishes the earliest alarm of each pair; later ones are ignored.
void AlarmLog::add(const Alarm& alarm) {
  const auto known =
      std::find_if(standing_.begin(), standing_.end(), [&](const Alarm& other) { return same_pair(alarm, other); });
  if (known == standing_.end()) {
    if (standing_.size() >= kMostStanding) return;
    standing_.push_back(alarm);
  } else if (alarm.step < known->step) {
    *known = alarm;
  } else {
    return;
  }
  to_publish_.push_back(alarm);
}

std::vector<Alarm> AlarmLog::take_to_publish() { return std::exchange(to_publish_, {}); }

/// Does the alarm still stand, because no redo since it was raised went back to before its state?
bool AlarmLog::stands(const Alarm& alarm) const {
  return alarm.redo <= redo() &&
         std::all_of(bases_.begin() + alarm.redo, bases_.end(), [&](Step base) { return base >= alarm.step; });
}

void AlarmLog::put_back(Step base) {
  bases_.push_back(base);
  std::erase_if(standing_, [this](const Alarm& alarm) { return !stands(alarm); });
  to_publish_ = standing_;  // nodes no longer accept messages from before the redo
}

}  // namespace aurasim::core
