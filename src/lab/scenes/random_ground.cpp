#include "lab/scenes/random_ground.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

namespace aurasim::lab {
namespace {

using core::Vec3;

constexpr double kDeepest_m = 0.3;  ///< of bumps below z = 0
constexpr double kNet_m = -1;       ///< a plane that catches what rolls off the edge
constexpr int kMostCells = 16;      ///< along each axis

Json static_box(const Vec3& size, const Vec3& p) {
  return {{"material", "ground"}, {"shape", {{"box", {{"size", json_vec3(size)}}}}}, {"position", json_vec3(p)}};
}

Json plane_at(double z) { return {{"material", "ground"}, {"shape", {{"plane", {{"offset", z}}}}}}; }

/// Heights in a grid over the whole layout and beyond.
struct Bumps {
  std::vector<std::vector<double>> heights_m;  ///< rows along y, each along x
  double cell_x_m = 1, cell_y_m = 1;
};

Bumps random_bumps(const RandomLayout& layout, Chance& chance) {
  const int columns = kMostCells / 2 + static_cast<int>(chance.below(kMostCells / 2));
  const int rows = kMostCells / 2 + static_cast<int>(chance.below(kMostCells / 2));
  Bumps bumps;
  bumps.cell_x_m = rounded(2.4 * layout.half_x_m / columns);
  bumps.cell_y_m = rounded(2.4 * layout.half_y_m / rows);
  for (int row = 0; row <= rows; ++row) {
    std::vector<double>& heights = bumps.heights_m.emplace_back();
    for (int column = 0; column <= columns; ++column) heights.push_back(rounded(chance.between(-kDeepest_m, 0)));
  }
  return bumps;
}

std::string obj_of(const Bumps& bumps) {
  const std::size_t rows = bumps.heights_m.size(), columns = bumps.heights_m[0].size();
  std::string text;
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      text += fmt::format("v {:.4f} {:.4f} {:.4f}\n",
                          (static_cast<double>(c) - 0.5 * static_cast<double>(columns - 1)) * bumps.cell_x_m,
                          (static_cast<double>(r) - 0.5 * static_cast<double>(rows - 1)) * bumps.cell_y_m,
                          bumps.heights_m[r][c]);
    }
  }
  for (std::size_t r = 0; r + 1 < rows; ++r) {
    for (std::size_t c = 0; c + 1 < columns; ++c) {
      const std::size_t a = r * columns + c + 1, above = a + columns;
      text += fmt::format("f {} {} {}\nf {} {} {}\n", a, a + 1, above + 1, a, above + 1, above);
    }
  }
  return text;
}

/// Slabs of different heights, side by side.
void add_slabs(const RandomLayout& layout, Json& statics, Chance& chance) {
  const int columns = 2 + static_cast<int>(chance.below(4)), rows = 2 + static_cast<int>(chance.below(3));
  const Vec3 size(2.4 * layout.half_x_m / columns, 2.4 * layout.half_y_m / rows, 0.6);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double x = (column + 0.5) * size.x() - 1.2 * layout.half_x_m;
      const double y = (row + 0.5) * size.y() - 1.2 * layout.half_y_m;
      statics.push_back(static_box(size, {x, y, -0.5 * size.z() - chance.between(0, kDeepest_m)}));
    }
  }
}

void add_walls(const RandomLayout& layout, Json& statics) {
  const double x = 1.25 * layout.half_x_m, y = 1.25 * layout.half_y_m;
  for (const double sign : {-1.0, 1.0}) {
    statics.push_back(static_box({0.5, 2 * y, 4}, {sign * x, 0, 1}));
    statics.push_back(static_box({2 * x, 0.5, 4}, {0, sign * y, 1}));
  }
}

/// Slopes across borders, to roll down and to jump from.
void add_ramps(const RandomLayout& layout, Json& statics, Chance& chance) {
  for (std::uint32_t left = 1 + chance.below(3); left > 0; --left) {
    const Vec3 spot = layout.spots[chance.below(static_cast<std::uint32_t>(layout.spots.size()))];
    const double aside = chance.between(-0.3, 0.3) * layout.half_y_m;
    Json ramp = static_box({chance.between(0.8, 2), chance.between(0.6, 1.5), 0.1}, spot + Vec3(0, aside, 0.1));
    ramp["orientation"] = {{"rpy_deg", {0, rounded(chance.between(-25, 25)), 90 * static_cast<int>(chance.below(4))}}};
    statics.push_back(ramp);
  }
}

Json stop(double at_s, const Vec3& p, double yaw_deg = 0) {
  return {{"at", rounded(at_s)}, {"position", json_vec3(p)}, {"orientation", {{"rpy_deg", {0, 0, yaw_deg}}}}};
}

/// There, a rest, and back again.
Json to_and_fro(const Vec3& way, Chance& chance) {
  const double there_s = chance.between(0.8, 3), rest_s = chance.between(0.1, 1);
  return {{"repeats", true},
          {"smooth", chance.below(2) == 0},
          {"stops", {stop(there_s, way), stop(there_s + rest_s, way), stop(2 * there_s + rest_s, Vec3::Zero())}}};
}

/// In thirds, of which the way back is the shorter turn.
Json round_and_round(Chance& chance) {
  const double third_s = chance.between(0.6, 2), sign = chance.below(2) == 0 ? 1 : -1;
  return {{"repeats", true},
          {"smooth", false},
          {"stops",
           {stop(third_s, Vec3::Zero(), 120 * sign), stop(2 * third_s, Vec3::Zero(), -120 * sign),
            stop(3 * third_s, Vec3::Zero())}}};
}

}  // namespace

void add_moving_statics(const RandomLayout& layout, Json& scene, Chance& chance) {
  Json& statics = scene["statics"];
  for (std::uint32_t left = 1 + chance.below(3); left > 0; --left) {
    const Vec3 spot = layout.spots[chance.below(static_cast<std::uint32_t>(layout.spots.size()))];
    const Vec3 p = spot + Vec3(0, chance.between(-0.3, 0.3) * layout.half_y_m, 0);
    switch (chance.below(4)) {
      case 0: {  // a lift, out of the ground
        statics.push_back(static_box({chance.between(1, 3), chance.between(1, 3), 0.4}, p - Vec3(0, 0, 0.2)));
        statics.back()["path"] = to_and_fro({0, 0, chance.between(0.3, 2)}, chance);
        break;
      }
      case 1: {  // a gate, across the border
        const double wide = chance.between(1, 3);
        statics.push_back(static_box({0.3, wide, 1.5}, p + Vec3(chance.between(-1, 1), 0, 0.8)));
        statics.back()["path"] = to_and_fro({chance.between(-2, 2), chance.between(-1, 1), 0}, chance);
        break;
      }
      case 2: {  // a turnstile
        statics.push_back(static_box({chance.between(2, 4), 0.2, 0.6}, p + Vec3(0, 0, 0.35)));
        statics.back()["path"] = round_and_round(chance);
        break;
      }
      default: {  // a belt, along or across the border
        statics.push_back(static_box({chance.between(2, 5), chance.between(1, 2), 0.3}, p));
        statics.back()["belt"] = json_vec3({chance.between(-3, 3), chance.below(3) == 0 ? 1.0 : 0.0, 0});
        break;
      }
    }
    statics.back()["name"] = fmt::format("mover_{}", left);
  }
}

void add_ground(const RandomLayout& layout, Json& scene, MeshTexts& meshes, Chance& chance) {
  Json& statics = scene["statics"] = Json::array();
  const std::uint32_t kind = chance.below(4);
  statics.push_back(plane_at(kind == 0 ? 0 : kNet_m));
  if (kind == 1) add_slabs(layout, statics, chance);
  if (kind >= 2) {
    const Bumps bumps = random_bumps(layout, chance);
    Json shape;
    if (kind == 2) {
      shape["heightfield"] = {{"cell", {bumps.cell_x_m, bumps.cell_y_m}}, {"heights", bumps.heights_m}};
    } else {
      meshes["ground.obj"] = obj_of(bumps);
      shape["mesh"] = {{"file", "ground.obj"}};
    }
    statics.push_back({{"material", "ground"}, {"shape", shape}});
  }
  if (chance.below(2) == 0) add_walls(layout, statics);
  if (chance.below(3) == 0) add_ramps(layout, statics, chance);
}

}  // namespace aurasim::lab
