#include "physics/static_places.h"

#include <cmath>

#include "physics/bullet_convert.h"

namespace aurasim::physics {
namespace {

/// Cells are numbered up to here in each direction. The world ends before.
constexpr std::int32_t kLast = std::numeric_limits<std::int32_t>::max();

/// Number of the cell of a coordinate; `if_none` if that is no number.
std::int32_t cell_at(btScalar at_m, std::int32_t if_none) {
  const double cell = std::floor(static_cast<double>(at_m) / StaticPlaces::kCell_m);
  if (std::isnan(cell)) return if_none;
  return static_cast<std::int32_t>(std::clamp<double>(cell, -kLast, kLast));
}

}  // namespace

Bounds bounds_of_static(const core::Scene& scene, std::uint32_t index, const ShapeSet& shapes) {
  return bounds_of(*shapes.shape(scene.statics.shape(index)), to_bullet(scene.statics.pose(index)));
}

std::int64_t StaticPlaces::Range::count() const {
  const std::int64_t columns = std::int64_t{x1} - x0 + 1, rows = std::int64_t{y1} - y0 + 1;
  constexpr std::int64_t kMany = 1'000'000'000;
  return std::min(columns, kMany) * std::min(rows, kMany);
}

/// A coordinate that is no number makes an empty range.
StaticPlaces::Range StaticPlaces::range_of(const Bounds& where) {
  return {cell_at(where.low.x(), kLast), cell_at(where.low.y(), kLast), cell_at(where.high.x(), -kLast),
          cell_at(where.high.y(), -kLast)};
}

StaticPlaces::StaticPlaces(const core::Scene& scene, const ShapeSet& shapes) : size_(scene.statics.size()) {
  struct Entry {
    std::int32_t x, y;
    std::uint32_t index;
  };
  std::vector<Entry> entries;
  for (std::uint32_t i = 0; i < size_; ++i) {
    const Range range = range_of(bounds_of_static(scene, i, shapes));
    if (scene.statics.moves(i) || range.count() > kMostCells) {
      everywhere_.push_back(i);
      continue;
    }
    for (std::int64_t x = range.x0; x <= range.x1; ++x) {
      for (std::int64_t y = range.y0; y <= range.y1; ++y) {
        entries.push_back({static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), i});
      }
    }
  }
  std::ranges::sort(entries, {}, [](const Entry& entry) { return std::tuple(entry.x, entry.y, entry.index); });
  statics_.reserve(entries.size());
  for (const Entry& entry : entries) {
    const bool is_new = cells_.empty() || cells_.back().x != entry.x || cells_.back().y != entry.y;
    if (is_new) cells_.push_back({entry.x, entry.y, static_cast<std::uint32_t>(statics_.size())});
    statics_.push_back(entry.index);
  }
  cells_.shrink_to_fit();
  everywhere_.shrink_to_fit();
}

std::span<const std::uint32_t> StaticPlaces::in(std::uint32_t cell) const {
  const std::size_t first = cells_[cell].first;
  const std::size_t last = cell + 1 < cells_.size() ? cells_[cell + 1].first : statics_.size();
  return std::span(statics_).subspan(first, last - first);
}

Bounds StaticPlaces::bounds_of_cell(std::uint32_t cell) const {
  const auto at = [](std::int32_t number) { return btScalar(number * kCell_m); };
  const Cell& of = cells_[cell];
  return {btVector3(at(of.x), at(of.y), -BT_LARGE_FLOAT),
          btVector3(at(of.x) + btScalar(kCell_m), at(of.y) + btScalar(kCell_m), BT_LARGE_FLOAT)};
}

}  // namespace aurasim::physics
