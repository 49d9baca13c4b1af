#include "physics/soft/sorted_touches.h"

#include <algorithm>
#include <cstddef>
#include <tuple>

namespace aurasim::physics {
namespace {

std::size_t last_of(const SoftTouch& touch) { return static_cast<std::size_t>(std::max(touch.a, touch.b)); }

/// The order of contacts. Parts matter for compounds only.
bool comes_before(const SoftTouch& x, const SoftTouch& y) {
  const std::size_t last_x = last_of(x), last_y = last_of(y);
  if (last_x != last_y) return last_x < last_y;
  return std::tuple(std::min(x.a, x.b), x.a, x.parts) < std::tuple(std::min(y.a, y.b), y.a, y.parts);
}

}  // namespace

void SortedTouches::sort(soft::Team& team) {
  constexpr std::size_t kMany = 16;  // bodies for each touch
  std::size_t last = 0;
  for (const SoftTouch& touch : sorted_) last = std::max(last, last_of(touch));
  if (sorted_.size() * kMany < last) {
    std::ranges::sort(sorted_, comes_before);
  } else {
    sort_many(last, team);
  }
}

/// A counting sort, because touches come in no order and each body has several.
void SortedTouches::sort_many(std::size_t last, soft::Team& team) {
  unsorted_.swap(sorted_);
  ends_.assign(last + 2, 0);
  for (const SoftTouch& touch : unsorted_) ++ends_[last_of(touch) + 1];
  for (std::size_t i = 1; i < ends_.size(); ++i) ends_[i] += ends_[i - 1];
  sorted_.resize(ends_.back());
  for (const SoftTouch& touch : unsorted_) sorted_[ends_[last_of(touch)]++] = touch;
  // each entry of ends_ is now the end of its body's touches
  team.for_each(ends_.size() - 1, [&](std::size_t body) {
    std::sort(sorted_.begin() + static_cast<std::ptrdiff_t>(body > 0 ? ends_[body - 1] : 0),
              sorted_.begin() + static_cast<std::ptrdiff_t>(ends_[body]), comes_before);
  });
}

}  // namespace aurasim::physics
