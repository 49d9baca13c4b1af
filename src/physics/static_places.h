// Which statics of a scene lie where, so that a world holds only those near its bodies (held_statics.h). Shared by the
// worlds of a node.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

#include "core/scene.h"
#include "physics/bounds.h"
#include "physics/shapes.h"

namespace aurasim::physics {

/// The bounds of a static at its first place.
Bounds bounds_of_static(const core::Scene& scene, std::uint32_t index, const ShapeSet& shapes);

class StaticPlaces {
 public:
  /// Side of a cell, m. A cell is a square column of the world. Only cells with statics are kept.
  static constexpr double kCell_m = 16;

  StaticPlaces(const core::Scene& scene, const ShapeSet& shapes);

  /// Statics that move, are in more cells than kMostCells, or have no bounds (planes). Ascending.
  std::span<const std::uint32_t> everywhere() const { return everywhere_; }
  /// Number of statics that have a place here. Those that are appended to the scene later have none.
  std::size_t size() const { return size_; }

  std::size_t cell_count() const { return cells_.size(); }
  /// The statics that come into a cell. Ascending.
  std::span<const std::uint32_t> in(std::uint32_t cell) const;
  Bounds bounds_of_cell(std::uint32_t cell) const;
  /// Calls `visit(cell)` for the cells that a box comes into. None if it has a coordinate that is no number.
  template <class Visit>
  void for_each_cell(const Bounds& where, Visit&& visit) const;

  static constexpr std::int64_t kMostCells = 16;

 private:
  struct Cell {
    std::int32_t x = 0, y = 0;  ///< it begins at x * kCell_m, y * kCell_m
    std::uint32_t first = 0;    ///< of its statics in statics_
  };
  struct Range {
    std::int32_t x0, y0, x1, y1;  ///< inclusive
    std::int64_t count() const;
  };
  static Range range_of(const Bounds& where);

  std::size_t size_;
  std::vector<Cell> cells_;             ///< ascending (x, y)
  std::vector<std::uint32_t> statics_;  ///< by cell
  std::vector<std::uint32_t> everywhere_;
};

template <class Visit>
void StaticPlaces::for_each_cell(const Bounds& where, Visit&& visit) const {
  const Range range = range_of(where);
  const auto from = [this](auto place, std::int64_t x, std::int32_t y) {
    return std::lower_bound(place, cells_.end(), std::tuple(x, y), [](const Cell& cell, const auto& wanted) {
      return std::tuple<std::int64_t, std::int32_t>(cell.x, cell.y) < wanted;
    });
  };
  auto place = from(cells_.begin(), range.x0, range.y0);
  while (place != cells_.end() && place->x <= range.x1) {
    if (place->y < range.y0) {
      place = from(place, place->x, range.y0);
    } else if (place->y > range.y1) {
      place = from(place, std::int64_t{place->x} + 1, range.y0);
    } else {
      visit(static_cast<std::uint32_t>(place - cells_.begin()));
      ++place;
    }
  }
}

}  // namespace aurasim::physics
