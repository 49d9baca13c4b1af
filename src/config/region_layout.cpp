#include "config/region_layout.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace aurasim::config {
namespace {

using core::Rectangle;
using core::RegionMap;

/// Range of a region's side, m.
constexpr Range kSide = Range::from_to(1e-3, 1e6);

enum class Kind { kColumns, kGrid, kBrick, kBoxes };

const Value& any_layout() {
  static const Value value = choice<Kind>(
      {{"columns", Kind::kColumns}, {"grid", Kind::kGrid}, {"brick", Kind::kBrick}, {"boxes", Kind::kBoxes}});
  return value;
}

const KeyTable& columns_keys() {
  static const KeyTable keys{.title = "layout: columns",
                             .about = "Side by side along x, centred on the origin.",
                             .keys = {optional("layout", words({"columns"}), "this layout").usual("columns"),
                                      required("count", integer(1, kMostRegions), "how many regions"),
                                      required_unless_central("width", number(kSide, "m"), "of each of them")}};
  return keys;
}

const KeyTable& grid_keys() {
  static const KeyTable keys{
      .title = "layout: grid or brick",
      .about = "Rows along y of cells along x, centred on the origin; brick shifts every other row by half a cell.",
      .keys = {required("layout", words({"grid", "brick"}), "this layout"),
               required("rows", integer(1, kMostRegions), "along y; rows times columns is at most 1024"),
               required("columns", integer(1, kMostRegions), "along x"),
               required("cell", numbers(2, kSide, "m"), "size of each region, along x and y")}};
  return keys;
}

const KeyTable& counted_grid_keys() {
  static const KeyTable keys{
      .title = "layout: grid or brick, by count",
      .about = "The most square grid of so many cells, with no more rows than columns.",
      .keys = {required("layout", words({"grid", "brick"}), "this layout"),
               required("count", integer(1, kMostRegions), "how many regions"),
               required_unless_central("cell", numbers(2, kSide, "m"), "size of each region, along x and y")}};
  return keys;
}

const KeyTable& boxes_keys() {
  static const KeyTable keys{.title = "layout: boxes",
                             .about = "Rectangles that tile a rectangle, without overlap or gap.",
                             .keys = {required("layout", words({"boxes"}), "this layout"),
                                      required_unless_central("boxes", list(1, kMostBoxes, numbers(4, kAnyNumber, "m")),
                                                              "[x0, y0, x1, y1] of each region, x0 < x1 and y0 < y1"),
                                      optional("count", integer(1, 1), "1: the central run, whatever the boxes are")
                                          .otherwise("as many as there are boxes")}};
  return keys;
}

bool is_used_by(std::string_view layout, std::string_view key) {
  if (key == "neighbour_distance" || !any_layout().has_word(layout)) return true;
  return std::ranges::any_of(layout_value().tables, [&](const Table& table) {
    return table().find("layout")->value.has_word(layout) && table().find(key) != nullptr;
  });
}

/// Coordinate of edge `i` of `count` cells in a row that is centred on the origin.
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

std::optional<RegionLayout> read_columns(const Fields& fields) {
  const auto count = fields["count"].integer();
  const Field width_field = fields["width"];
  const auto width = width_field.number();
  const bool central = count == 1;
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

bool read_rows_and_columns(const Fields& fields, Grid& grid) {
  const auto rows = fields["rows"].integer();
  const Field columns_field = fields["columns"];
  const auto columns = columns_field.integer();
  if (!rows || !columns) return false;
  if (*rows * *columns > kMostRegions) {
    columns_field.refuse(fmt::format("at most {} regions, rows times columns", kMostRegions));
    return false;
  }
  grid.rows = static_cast<std::size_t>(*rows);
  grid.columns = static_cast<std::size_t>(*columns);
  return true;
}

std::optional<RegionLayout> read_grid(const Fields& fields, bool brick) {
  Grid grid;
  bool good = true;
  bool central = false;
  if (fields.has("count")) {
    const auto count = fields["count"].integer();
    good = count.has_value();
    central = count == 1;
    if (good) make_square(*count, grid);
  } else {
    good = read_rows_and_columns(fields, grid);
  }
  const Field cell_field = fields["cell"];
  const auto cell = cell_field.given() || !central ? cell_field.numbers() : std::vector<double>{1, 1};
  if (!good || !cell) return std::nullopt;
  grid.cell_x = (*cell)[0];
  grid.cell_y = (*cell)[1];
  if (central) return central_run(grid.cell_x);
  return RegionLayout{brick ? RegionMap::brick(grid.rows, grid.columns, grid.cell_x, grid.cell_y)
                            : RegionMap::grid(grid.rows, grid.columns, grid.cell_x, grid.cell_y),
                      grid_tiles(grid, brick)};
}

std::optional<RegionLayout> read_boxes(const Fields& fields) {
  if (fields.has("count")) {
    if (!fields["count"].integer()) return std::nullopt;
    return central_run(1);
  }
  const Field list = fields["boxes"];
  std::vector<Rectangle> boxes;
  const std::vector<Field> items = list.items();
  for (const Field& item : items) {
    const auto edges = item.numbers();
    if (!edges) continue;
    const std::vector<double>& e = *edges;
    if (e[2] - e[0] >= kSide.low && e[3] - e[1] >= kSide.low) {
      boxes.push_back({e[0], e[1], e[2], e[3]});
    } else {
      item.refuse(fmt::format("[x0, y0, x1, y1] with x0 < x1 and y0 < y1, each side at least {:g} m", kSide.low));
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

/// Reads the kind of layout; nothing if there is no such layout.
std::optional<Kind> read_kind(const Field& map) {
  if (!map.is_map()) return std::nullopt;
  const YamlNode* layout = map.node()->find("layout");
  if (layout == nullptr) return Kind::kColumns;
  return Field(layout, map.place(), path_to(map.path(), "layout"), any_layout(), true, map.errors()).choice<Kind>();
}

/// Returns the fields of this kind of layout, or of all kinds if it is not known.
Fields fields_of(const Field& map, std::optional<Kind> kind) {
  if (!kind) return Fields::of_any_table(map);
  if (*kind == Kind::kColumns) return Fields(map, columns_keys());
  if (*kind == Kind::kBoxes) return Fields(map, boxes_keys());
  return Fields(map, map.node()->find("count") != nullptr ? counted_grid_keys() : grid_keys());
}

}  // namespace

Value layout_value() { return map_of_one({columns_keys, grid_keys, counted_grid_keys, boxes_keys}); }

std::optional<RegionLayout> read_layout(const Field& map) {
  const std::optional<Kind> kind = read_kind(map);
  const Fields fields = fields_of(map, kind);
  std::optional<RegionLayout> layout;
  if (kind == Kind::kColumns) layout = read_columns(fields);
  if (kind == Kind::kGrid || kind == Kind::kBrick) layout = read_grid(fields, kind == Kind::kBrick);
  if (kind == Kind::kBoxes) layout = read_boxes(fields);
  fields.close();
  return layout;
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
