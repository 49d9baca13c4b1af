#include "config/heightfield.h"

namespace aurasim::config {
namespace {

constexpr std::size_t kMostRows = 1000;

core::TriangleMesh triangulated(const std::vector<std::vector<double>>& heights, double dx, double dy) {
  core::TriangleMesh mesh;
  const std::size_t rows = heights.size(), columns = heights[0].size();
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      const double x = (static_cast<double>(c) - 0.5 * static_cast<double>(columns - 1)) * dx;
      const double y = (static_cast<double>(r) - 0.5 * static_cast<double>(rows - 1)) * dy;
      mesh.points.push_back({x, y, heights[r][c]});
    }
  }
  for (std::size_t r = 0; r + 1 < rows; ++r) {
    for (std::size_t c = 0; c + 1 < columns; ++c) {
      const auto a = static_cast<std::uint32_t>(r * columns + c);
      const auto above = static_cast<std::uint32_t>(a + columns);
      mesh.triangles.push_back({a, a + 1, above + 1});
      mesh.triangles.push_back({a, above + 1, above});
    }
  }
  return mesh;
}

}  // namespace

const KeyTable& heightfield_keys() {
  static const KeyTable keys{
      .title = "shape: heightfield",
      .about = "Ground given as a grid of heights, centred on the origin. Statics only.",
      .keys = {required("cell", numbers(2, kSize, "m"), "distance of two heights along x and along y"),
               required("heights", list(2, kMostRows, list(2, kMostRows, number(kPlace, "m"))),
                        "rows from -y to +y, each from -x to +x, all of one length")}};
  return keys;
}

std::optional<core::Shape> read_heightfield(const Fields& fields) {
  const auto cell = fields["cell"].numbers();
  std::vector<std::vector<double>> heights;
  const std::vector<Field> rows = fields["heights"].items();
  for (const Field& row : rows) {
    std::vector<double> values;
    const std::vector<Field> items = row.items();
    for (const Field& item : items) {
      if (const auto height = item.number()) values.push_back(*height);
    }
    if (items.empty() || values.size() != items.size()) continue;
    if (!heights.empty() && values.size() != heights[0].size()) {
      row.refuse("rows of one length");
      continue;
    }
    heights.push_back(std::move(values));
  }
  if (!cell || heights.empty() || heights.size() != rows.size()) return std::nullopt;
  return triangulated(heights, (*cell)[0], (*cell)[1]);
}

}  // namespace aurasim::config
