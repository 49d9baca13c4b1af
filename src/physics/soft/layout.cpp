#include "physics/soft/layout.h"

#include <algorithm>
#include <bit>

#include "physics/soft/lanes.h"

namespace aurasim::physics {
namespace {

using soft::kLanes;

constexpr std::size_t kColoursOfBodies = 40, kColours = 64;
constexpr std::uint64_t kOfBodies = (std::uint64_t{1} << kColoursOfBodies) - 1;

}  // namespace

void SoftLayout::clear(std::size_t movers, std::size_t kinds) {
  kinds_ = kinds;
  entries_.clear();
  used_.assign(movers, 0);
}

/// Gives the entry the first free colour. If none is free, it is solved by itself, after the others.
void SoftLayout::add(std::int32_t a, std::int32_t b, std::size_t kind) {
  const auto body_a = static_cast<std::size_t>(std::max(0, a)), body_b = static_cast<std::size_t>(std::max(0, b));
  const std::uint64_t free = ~(used_[body_a] | used_[body_b]) & (a > 0 && b > 0 ? kOfBodies : ~kOfBodies);
  used_[body_a] |= free & -free;
  used_[body_b] |= free & -free;
  used_[0] = 0;
  const auto colour = static_cast<std::size_t>(std::countr_zero(free));
  entries_.push_back({a, b, static_cast<std::uint32_t>(colour * kinds_ + kind), 0});
}

/// Sorts by colour, then by kind; otherwise in the order of add().
std::size_t SoftLayout::place() {
  next_.assign((kColours + 1) * kinds_, 0);
  for (const Entry& entry : entries_) ++next_[entry.kind];
  runs_.clear();
  std::size_t blocks = 0, colour = 0;
  for (std::size_t k = 0; k < next_.size(); ++k) {
    if (next_[k] == 0) continue;
    const bool alone = k / kinds_ == kColours;
    const std::size_t count = alone ? next_[k] : (next_[k] + kLanes - 1) / kLanes;
    next_[k] = static_cast<std::uint32_t>(blocks * kLanes);
    if (!runs_.empty() && colour == k / kinds_) runs_.back().ends = false;
    colour = k / kinds_;
    runs_.push_back({blocks, count, k % kinds_, alone, true});
    blocks += count;
  }
  for (Entry& entry : entries_) {
    entry.place = next_[entry.kind];
    next_[entry.kind] += entry.kind / kinds_ == kColours ? kLanes : 1;
  }
  return blocks;
}

std::size_t SoftLayout::block(std::size_t i) const { return entries_[i].place / kLanes; }
int SoftLayout::lane(std::size_t i) const { return static_cast<int>(entries_[i].place % kLanes); }

}  // namespace aurasim::physics
