#include "lab/scenes/random_layout.h"

#include <algorithm>
#include <array>

namespace aurasim::lab {
namespace {

/// Edge `i` of `count` cells in a row that is centred on the origin.
double edge_of_cells(std::uint32_t i, std::uint32_t count, double cell_m) {
  return (static_cast<double>(i) - 0.5 * static_cast<double>(count)) * cell_m;
}

RandomLayout columns_layout(double narrowest_m, Chance& chance) {
  const std::uint32_t count = 2 + chance.below(4);
  RandomLayout layout;
  layout.regions = {{"layout", "columns"}, {"count", count}, {"width", narrowest_m}};
  layout.half_x_m = 0.5 * count * narrowest_m;
  layout.half_y_m = narrowest_m;
  for (std::uint32_t i = 1; i < count; ++i) {
    const double x = edge_of_cells(i, count, narrowest_m);
    for (const double y : {-0.6, 0.0, 0.6}) layout.spots.push_back({x, y * narrowest_m, 0});
  }
  return layout;
}

/// A brick's odd rows are shifted by half a cell.
RandomLayout cells_layout(bool brick, double narrowest_m, Chance& chance) {
  const std::uint32_t rows = 2 + chance.below(2), columns = (brick ? 1 : 2) + chance.below(2);
  const double x_m = narrowest_m, y_m = rounded(narrowest_m * chance.between(1, 1.6));
  RandomLayout layout;
  layout.regions = {{"layout", brick ? "brick" : "grid"}, {"rows", rows}, {"columns", columns}};
  layout.regions["cell"] = {x_m, y_m};
  layout.half_x_m = 0.5 * columns * x_m;
  layout.half_y_m = 0.5 * rows * y_m;
  for (std::uint32_t row = 1; row < rows; ++row) {
    const double y = edge_of_cells(row, rows, y_m);
    for (std::uint32_t column = brick ? 0 : 1; column < columns; ++column) {
      layout.spots.push_back({edge_of_cells(column, columns, x_m) + (brick ? 0.5 * x_m : 0), y, 0});
    }
  }
  for (std::uint32_t column = 1; column < columns; ++column) {
    layout.spots.push_back({edge_of_cells(column, columns, x_m), edge_of_cells(0, rows, y_m) + 0.5 * y_m, 0});
  }
  return layout;
}

/// From 0 on, each at least `least` from the one before it, the last at `whole`.
std::vector<double> random_edges(std::uint32_t parts, double whole, double least, Chance& chance) {
  std::vector<double> edges = {0};
  for (std::uint32_t left = parts; left > 1; --left) {
    const double room = whole - edges.back() - left * least;
    edges.push_back(rounded(edges.back() + least + chance.between(0, 1.5 * room / left)));
  }
  edges.push_back(whole);
  return edges;
}

/// Rows of uneven heights, each cut into uneven boxes; or columns instead of rows.
RandomLayout boxes_layout(double narrowest_m, Chance& chance) {
  const std::uint32_t rows = 2 + chance.below(2);
  const bool turned = chance.below(2) == 0;
  const double along = rounded(3 * narrowest_m * chance.between(1.05, 1.3));
  const double across = rounded(rows * narrowest_m * chance.between(1.05, 1.4));
  const std::vector<double> row_edges = random_edges(rows, across, narrowest_m, chance);
  RandomLayout layout;
  layout.regions = {{"layout", "boxes"}, {"boxes", Json::array()}};
  const auto moved = [&](double value, double whole) { return rounded(value - rounded(0.5 * whole)); };
  for (std::uint32_t row = 0; row < rows; ++row) {
    const std::uint32_t parts = 1 + chance.below(3);
    const std::vector<double> edges = random_edges(parts, along, narrowest_m, chance);
    for (std::uint32_t i = 0; i < parts; ++i) {
      const double x0 = moved(edges[i], along), x1 = moved(edges[i + 1], along);
      const double y0 = moved(row_edges[row], across), y1 = moved(row_edges[row + 1], across);
      layout.regions["boxes"].push_back(turned ? Json::array({y0, x0, y1, x1}) : Json::array({x0, y0, x1, y1}));
      const double middle = 0.5 * (i > 0 ? 2 * x0 : x0 + x1);
      if (row > 0) layout.spots.push_back(turned ? core::Vec3(y0, middle, 0) : core::Vec3(middle, y0, 0));
    }
  }
  layout.half_x_m = 0.5 * (turned ? across : along);
  layout.half_y_m = 0.5 * (turned ? along : across);
  return layout;
}

}  // namespace

RandomLayout random_layout(double narrowest_m, Chance& chance) {
  switch (chance.below(4)) {
    case 0:
      return columns_layout(narrowest_m, chance);
    case 1:
      return cells_layout(false, narrowest_m, chance);
    case 2:
      return cells_layout(true, narrowest_m, chance);
    default:
      return boxes_layout(narrowest_m, chance);
  }
}

}  // namespace aurasim::lab
