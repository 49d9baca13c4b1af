#include "config/region_layout.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace aurasim::config {
namespace {

using core::Rectangle;
using core::RegionMap;

enum class Kind { kColumns, kGrid, kBrick, kBoxes };

bool is_used_by(std::string_view layout, std::string_view key) {
  if (key == "layout" || key == "count" || key == "neighbour_distance") return true;
  if (layout == "columns") return key == "width";
  if (layout == "grid" || layout == "brick") return key == "rows" || key == "columns" || key == "cell";
  if (layout == "boxes") return key == "boxes";
  return true;
}

/// Edge `i` of `count` cells in a row that is centred on the origin.
double edge(std::size_t i, std::size_t count, double cell) {
  return (static_cast<double>(i) - 0.5 * static_cast<double>(count)) * cell;
}

std::vector<Rectangle> column_tiles(std::size_t count, double width) {
  std::vector<Rectangle> tiles;
  for (std::size_t i = 0; i < count; ++i) {
    tiles.push_back({edge(i, count, width), -0.5 * width, edge(i + 1, count, width), 0.5 * width});
  }
  return tiles;
}

struct Grid {
  std::size_t rows = 1;
  std::size_t columns = 1;
  double cell_x = 1;
  double cell_y = 1;
};

std::vector<Rectangle> grid_tiles(const Grid& grid, bool brick) {
  std::vector<Rectangle> tiles;
  for (std::size_t row = 0; row < grid.rows; ++row) {
    const double shift = brick && row % 2 == 1 ? 0.5 * grid.cell_x : 0;
    for (std::size_t column = 0; column < grid.columns; ++column) {
      tiles.push_back({edge(column, grid.columns, grid.cell_x) + shift, edge(row, grid.rows, grid.cell_y),
                       edge(column + 1, grid.columns, grid.cell_x) + shift, edge(row + 1, grid.rows, grid.cell_y)});
    }
  }
  return tiles;
}

RegionLayout central_run(double width) { return {RegionMap::columns(1, width), column_tiles(1, width)}; }

std::optional<RegionLayout> read_columns(Fields& fields) {
  const auto count = fields.required("count").integer(1, kMostRegions);
  const bool central = count == 1;
  const Field width_field = central ? fields.optional("width") : fields.required("width");
  const auto width = width_field.number(kSize);
  if (!count || (!central && !width) || (width_field.given() && !width)) return std::nullopt;
  if (central) return central_run(width.value_or(1));
  const auto columns = static_cast<std::size_t>(*count);
  return RegionLayout{RegionMap::columns(columns, *width), column_tiles(columns, *width)};
}

/// Rows and columns from `count`: the most square grid, no more rows than columns.
void make_square(std::int64_t count, Grid& grid) {
  auto rows = static_cast<std::int64_t>(std::sqrt(static_cast<double>(count)));
  while (count % rows != 0) --rows;
  grid.rows = static_cast<std::size_t>(rows);
  grid.columns = static_cast<std::size_t>(count / rows);
}

bool read_rows_and_columns(Fields& fields, Grid& grid) {
  const auto rows = fields.required("rows").integer(1, kMostRegions);
  const Field columns_field = fields.required("columns");
  const auto columns = columns_field.integer(1, kMostRegions);
  if (!rows || !columns) return false;
  if (*rows * *columns > kMostRegions) {
    columns_field.refuse(fmt::format("at most {} regions, rows times columns", kMostRegions));
    return false;
  }
  grid.rows = static_cast<std::size_t>(*rows);
  grid.columns = static_cast<std::size_t>(*columns);
  return true;
}

std::optional<RegionLayout> read_grid(Fields& fields, bool brick) {
  Grid grid;
  bool good = true;
  bool central = false;
  if (fields.has("count")) {
    const auto count = fields.required("count").integer(1, kMostRegions);
    good = count.has_value();
    central = count == 1;
    if (good) make_square(*count, grid);
  } else {
    good = read_rows_and_columns(fields, grid);
  }
  const Field cell_field = central ? fields.optional("cell") : fields.required("cell");
  const auto cell = cell_field.given() || !central ? cell_field.numbers(2, kSize) : std::vector<double>{1, 1};
  if (!good || !cell) return std::nullopt;
  grid.cell_x = (*cell)[0];
  grid.cell_y = (*cell)[1];
  if (central) return central_run(grid.cell_x);
  return RegionLayout{brick ? RegionMap::brick(grid.rows, grid.columns, grid.cell_x, grid.cell_y)
                            : RegionMap::grid(grid.rows, grid.columns, grid.cell_x, grid.cell_y),
                      grid_tiles(grid, brick)};
}

std::optional<RegionLayout> read_boxes(Fields& fields) {
  if (fields.has("count")) {
    fields.optional("boxes");
    if (!fields.required("count").integer(1, 1)) return std::nullopt;
    return central_run(1);
  }
  const Field list = fields.required("boxes");
  std::vector<Rectangle> boxes;
  const std::vector<Field> items = list.items(1, kMostBoxes);
  for (const Field& item : items) {
    const auto edges = item.numbers(4, kAnyNumber);
    if (!edges) continue;
    const std::vector<double>& e = *edges;
    if (e[0] < e[2] && e[1] < e[3]) {
      boxes.push_back({e[0], e[1], e[2], e[3]});
    } else {
      item.refuse("[x0, y0, x1, y1] with x0 < x1 and y0 < y1");
    }
  }
  if (items.empty() || boxes.size() != items.size()) return std::nullopt;
  try {
    return RegionLayout{RegionMap::boxes(boxes), boxes};
  } catch (const core::BadRegionMap& wrong) {
    list.complain(fmt::format("{}, allowed: boxes that tile a rectangle without overlap or gap", wrong.what()));
    return std::nullopt;
  }
}

}  // namespace

std::optional<RegionLayout> read_layout(Fields& fields) {
  std::optional<Kind> kind = Kind::kColumns;
  if (const Field layout = fields.optional("layout"); layout.given()) {
    kind = layout.choice<Kind>(
        {{"columns", Kind::kColumns}, {"grid", Kind::kGrid}, {"brick", Kind::kBrick}, {"boxes", Kind::kBoxes}});
  }
  if (!kind || !fields.given()) {  // which keys are wrong cannot be said
    for (const char* key : {"count", "width", "rows", "columns", "cell", "boxes"}) fields.optional(key);
    return std::nullopt;
  }
  switch (*kind) {
    case Kind::kColumns:
      return read_columns(fields);
    case Kind::kGrid:
      return read_grid(fields, false);
    case Kind::kBrick:
      return read_grid(fields, true);
    case Kind::kBoxes:
      return read_boxes(fields);
  }
  return std::nullopt;
}

void settle_overridden_layout(YamlNode& regions) {
  if (regions.kind != YamlNode::Kind::kMap) return;
  const std::uint32_t source = regions.place.source;
  const auto overridden = [&](std::string_view key) {
    const YamlNode* entry = regions.find(key);
    return entry != nullptr && entry->key_place.source != source;
  };
  const YamlNode* layout_entry = regions.find("layout");
  const std::string layout = layout_entry ? layout_entry->text : "columns";
  const bool new_layout = overridden("layout");
  const bool new_count = overridden("count");
  const bool new_shape = overridden("rows") || overridden("columns");
  std::erase_if(regions.children, [&](const YamlNode& entry) {
    if (entry.key_place.source != source) return false;
    const bool is_shape = entry.key == "rows" || entry.key == "columns";
    return (new_layout && !is_used_by(layout, entry.key)) || (new_count && is_shape && layout != "columns") ||
           (new_shape && entry.key == "count" && layout != "columns");
  });
}

}  // namespace aurasim::config
