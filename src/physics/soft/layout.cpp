#include "physics/soft/layout.h"

#include <algorithm>
#include <bit>

#include "physics/soft/lanes.h"

namespace aurasim::physics {
namespace {

using soft::kLanes;

/// The first phase and that of statics share the bits of a mover, because most entries are in these two.
constexpr std::size_t kFirstOfStatics = 40, kNoColour = 64;
constexpr std::uint64_t kInside = (std::uint64_t{1} << kFirstOfStatics) - 1;

}  // namespace

void SoftLayout::clear(std::size_t movers, std::size_t kinds) {
  kinds_ = kinds;
  movers_ = movers;
  entries_.clear();
  for (std::vector<std::uint64_t>& used : used_) used.clear();
  used_.front().assign(movers, 0);
  colours_ = {};
}

/// Gives the entry the first free colour of its phase. If none is free, it is solved by itself, after the others of the
/// phase.
void SoftLayout::add(std::int32_t a, std::int32_t b, std::size_t kind, SoftPhase phase) {
  const bool with_static = a <= 0 || b <= 0;
  const auto at = with_static ? std::size_t{0} : static_cast<std::size_t>(phase);
  std::vector<std::uint64_t>& used = used_[at];
  if (used.empty()) used.assign(movers_, 0);
  const std::uint64_t allowed = at > 0 ? ~std::uint64_t{0} : with_static ? ~kInside : kInside;
  const auto body_a = static_cast<std::size_t>(std::max(0, a)), body_b = static_cast<std::size_t>(std::max(0, b));
  const std::uint64_t free = ~(used[body_a] | used[body_b]) & allowed;
  used[body_a] |= free & -free;
  used[body_b] |= free & -free;
  used[0] = 0;
  const auto colour = static_cast<std::uint8_t>(std::countr_zero(free));
  const std::size_t in_phase = with_static ? kStatics : at;
  colours_[in_phase] = std::max(colours_[in_phase], std::size_t{colour} + 1);
  entries_.push_back({a, b, static_cast<std::uint16_t>(kind), static_cast<std::uint8_t>(in_phase), colour, 0});
}

/// Sorts by phase, then by colour, then by kind; otherwise in the order of add().
std::size_t SoftLayout::place() {
  std::size_t colours = 0;
  for (std::size_t phase = 0; phase < colours_.size(); ++phase) {
    first_colour_[phase] = colours;
    colours += colours_[phase];
  }
  next_.assign(colours * kinds_, 0);
  for (const Entry& entry : entries_) ++next_[row_of(entry)];
  runs_.clear();
  std::size_t blocks = 0;
  for (std::size_t phase = 0; phase < colours_.size(); ++phase) {
    for (std::size_t colour = 0; colour < colours_[phase]; ++colour) {
      const bool alone = colour == kNoColour;
      const std::size_t before = runs_.size();
      for (std::size_t kind = 0; kind < kinds_; ++kind) {
        std::uint32_t& next = next_[(first_colour_[phase] + colour) * kinds_ + kind];
        if (next == 0) continue;
        const std::size_t count = alone ? next : (next + kLanes - 1) / kLanes;
        next = static_cast<std::uint32_t>(blocks * kLanes);
        runs_.push_back({blocks, count, kind, alone, false});
        blocks += count;
      }
      if (runs_.size() > before) runs_.back().ends = true;
    }
  }
  for (Entry& entry : entries_) {
    std::uint32_t& next = next_[row_of(entry)];
    entry.place = next;
    next += entry.colour == kNoColour ? kLanes : 1;
  }
  return blocks;
}

std::size_t SoftLayout::block(std::size_t i) const { return entries_[i].place / kLanes; }
int SoftLayout::lane(std::size_t i) const { return static_cast<int>(entries_[i].place % kLanes); }

}  // namespace aurasim::physics
