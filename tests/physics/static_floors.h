// Floors, and other scenery made of several statics, for the tests of inner edges.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "physics/scenes.h"

namespace aurasim::physics::testing {

inline core::Quat turned(const core::Vec3& axis, double angle_rad) {
  return core::Quat(Eigen::AngleAxisd(angle_rad, axis));
}

/// Adds a static of the scene's second material.
inline void add_static(core::Scene& scene, const core::Shape& shape, const core::Pose& pose) {
  scene.shapes.push_back({"static", shape});
  core::StaticBody fixed;
  fixed.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
  fixed.material = 1;
  fixed.pose = pose;
  scene.statics.push_back(fixed);
}

inline core::ConvexHull hull_of_box(const core::Vec3& half) {
  core::ConvexHull hull;
  for (int i = 0; i < 8; ++i) {
    hull.points.push_back({(i & 1 ? 1 : -1) * half.x(), (i & 2 ? 1 : -1) * half.y(), (i & 4 ? 1 : -1) * half.z()});
  }
  return hull;
}

/// An upright prism.
inline core::ConvexHull prism_hull(int corners, double radius, double height) {
  core::ConvexHull hull;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.5) / corners;
    for (const double z : {-height / 2, height / 2}) {
      hull.points.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
    }
  }
  return hull;
}

/// How a floor is laid. Its upper side is z = 0 in the frame of the floor.
struct Tiling {
  double size_m = 1;
  double gap_m = 0;   ///< between tiles; negative: they overlap
  double step_m = 0;  ///< every second tile is so much higher
  double yaw_rad = 0;
  double aside_m = 0.5;  ///< by which all tiles are moved along and across
  bool hulls = false;
  double length_m = 20, half_width_m = 3;
};

/// Tiles from x = -2 m on.
inline void add_tiles(core::Scene& scene, const Tiling& t, const core::Pose& floor = {}) {
  const core::Vec3 half((t.size_m - t.gap_m) / 2, (t.size_m - t.gap_m) / 2, 0.25);
  const core::Shape tile = t.hulls ? core::Shape(hull_of_box(half)) : core::Shape(core::Box{half});
  const core::Quat yaw = turned(core::Vec3::UnitZ(), t.yaw_rad);
  for (int i = 0; (i - 1) * t.size_m < t.length_m + 2; ++i) {
    for (int k = 0; (k - 1) * t.size_m < 2 * t.half_width_m; ++k) {
      core::Vec3 p = yaw * core::Vec3(i * t.size_m + t.aside_m - 2, k * t.size_m + t.aside_m - t.half_width_m, 0);
      p.z() = -half.z() + ((i + k) % 2 == 0 ? 0 : t.step_m);
      add_static(scene, tile, {floor.p_WB + floor.q_WB * p, floor.q_WB * yaw});
    }
  }
}

/// A level grid of triangles, from x = -2 m on.
inline core::TriangleMesh grid(double cell_m, double length_m = 20, double half_width_m = 3) {
  core::TriangleMesh mesh;
  const auto columns = static_cast<std::uint32_t>((length_m + 2) / cell_m);
  const auto rows = static_cast<std::uint32_t>(2 * half_width_m / cell_m);
  for (std::uint32_t row = 0; row <= rows; ++row) {
    for (std::uint32_t column = 0; column <= columns; ++column) {
      mesh.points.push_back({column * cell_m - 2, row * cell_m - half_width_m, 0});
    }
  }
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const std::uint32_t corner = row * (columns + 1) + column, above = corner + columns + 1;
      mesh.triangles.push_back({corner, corner + 1, above + 1});
      mesh.triangles.push_back({corner, above + 1, above});
    }
  }
  return mesh;
}

struct Floor {
  std::string name;
  std::function<void(core::Scene&)> add;
};

inline void add_one_floor(core::Scene& scene) {
  add_static(scene, core::Box{{50, 50, 0.25}}, {core::Vec3(0, 0, -0.25), core::Quat::Identity()});
}

inline const Floor kOneFloor{"One", add_one_floor};

/// Level floors of many pieces, from x = -2 m to at least x = 20 m.
inline std::vector<Floor> floors_of_pieces() {
  const auto tiles = [](const Tiling& tiling) { return [tiling](core::Scene& scene) { add_tiles(scene, tiling); }; };
  const auto mesh = [](double cell_m, double aside_m) {
    return [cell_m, aside_m](core::Scene& scene) {
      add_static(scene, grid(cell_m), {core::Vec3(0, aside_m, 0), core::Quat::Identity()});
    };
  };
  return {{"Tiles", tiles({})},
          {"JointBelowTheMiddle", tiles({.aside_m = 0.21})},
          {"TurnedTiles", tiles({.yaw_rad = 0.3, .half_width_m = 9})},
          {"SmallTiles", tiles({.size_m = 0.3, .aside_m = 0.07})},
          {"WithGaps", tiles({.gap_m = 0.001})},
          {"Overlapping", tiles({.gap_m = -0.001})},
          {"WithSteps", tiles({.step_m = 0.0001})},
          {"Hulls", tiles({.hulls = true})},
          {"LargeTriangles", mesh(1, 0.3)},
          {"SmallTriangles", mesh(0.25, 0.07)},
          {"TwoMeshes",
           [](core::Scene& scene) {
             add_static(scene, grid(0.5, 5), {core::Vec3::Zero(), core::Quat::Identity()});
             add_static(scene, grid(0.5, 16), {core::Vec3(7, 0.1, 0), core::Quat::Identity()});
           }},
          {"Compound",
           [](core::Scene& scene) {
             core::Compound floor;
             for (int i = 0; i < 23; ++i) {
               for (int k = 0; k < 6; ++k) {
                 floor.parts.push_back({core::Box{{0.5, 0.5, 0.25}}, {core::Vec3(i - 1.5, k - 2.5, 0), {1, 0, 0, 0}}});
               }
             }
             add_static(scene, floor, {core::Vec3(0, 0, -0.25), core::Quat::Identity()});
           }},
          {"DifferentSizes", [](core::Scene& scene) {
             double x = -2;
             for (int i = 0; x < 21; ++i) {
               const double length = 0.4 + 0.35 * (i % 4), half_height = 0.1 + 0.05 * (i % 3);
               for (int k = 0; k < 6; ++k) {
                 add_static(scene, core::Box{{length / 2, 0.55, half_height}},
                            {core::Vec3(x + length / 2, 1.1 * k - 3.3, -half_height), core::Quat::Identity()});
               }
               x += length;
             }
           }}};
}

/// A body of friction 0.1 that slides or rolls.
struct Slider {
  std::string name;
  core::Shape shape;
  double height_m;  ///< of its centre above the floor
  core::Quat q = core::Quat::Identity();
};

inline std::vector<Slider> sliders() {
  const core::Quat level = core::Quat::Identity();
  const core::Quat along = turned(core::Vec3::UnitY(), std::numbers::pi / 2);
  const core::Quat across = turned(core::Vec3::UnitX(), std::numbers::pi / 2);
  core::Compound sled, four_balls;
  for (const double y : {-0.2, 0.2}) sled.parts.push_back({core::Box{{0.3, 0.05, 0.1}}, {core::Vec3(0, y, 0), level}});
  for (int i = 0; i < 4; ++i) {
    const core::Vec3 p(i % 2 == 0 ? 0.25 : -0.25, i < 2 ? 0.2 : -0.2, 0);
    four_balls.parts.push_back({core::Sphere{0.1}, {p, level}});
  }
  return {{"Ball", core::Sphere{0.5}, 0.5},
          {"SmallBall", core::Sphere{0.1}, 0.1},
          {"Box", core::Box{{0.25, 0.25, 0.25}}, 0.25},
          {"TurnedBox", core::Box{{0.25, 0.25, 0.25}}, 0.25, turned(core::Vec3::UnitZ(), 0.4)},
          {"CapsuleAlong", core::Capsule{0.2, 0.4}, 0.2, along},
          {"CapsuleAcross", core::Capsule{0.2, 0.4}, 0.2, across},
          {"StandingCylinder", core::Cylinder{0.3, 0.4}, 0.2},
          {"RollingCylinder", core::Cylinder{0.3, 0.4}, 0.3, across},
          {"SlidingCylinder", core::Cylinder{0.3, 0.4}, 0.3, along},
          {"LongCylinderAlong", core::Cylinder{0.1, 0.8}, 0.1, along},
          {"LongCylinderAcross", core::Cylinder{0.1, 0.8}, 0.1, across},
          {"Disc", core::Cylinder{0.4, 0.05}, 0.025},
          {"Wheel", core::Cylinder{0.4, 0.1}, 0.4, across},
          {"Post", core::Cylinder{0.15, 0.6}, 0.3},
          {"Prism", prism_hull(7, 0.3, 0.3), 0.15},
          {"HullOfABox", hull_of_box({0.25, 0.25, 0.2}), 0.2},
          {"Sled", sled, 0.1},
          {"FourBalls", four_balls, 0.1}};
}

inline core::BodyRecord record_of(const Slider& slider, const core::Vec3& p, const core::Vec3& v) {
  core::BodyRecord record = body(1, 0, p, v);
  record.R_WB = slider.q.toRotationMatrix();
  return record;
}

/// A scene of one kind of body, friction 0.1 against statics, without statics.
inline core::Scene scene_of_slider(const core::Shape& shape) {
  core::Scene scene = scene_of(shape);
  scene.statics.clear();
  scene.materials.assign(2, core::Material{});
  scene.materials[0].friction = 0.1;
  scene.materials[1].friction = 1;
  return scene;
}

/// As the preset "balanced".
inline Settings balanced() {
  Settings settings;
  settings.solver = Solver::kSoftStep;
  settings.substeps = 8;
  settings.friction_directions = 2;
  settings.continuous = true;
  return settings;
}

/// As the preset "exact".
inline Settings exact() {
  Settings settings;
  settings.solver = Solver::kSequentialImpulse;
  settings.substeps = 8;
  settings.solver_iterations = 50;
  settings.friction_directions = 2;
  return settings;
}

}  // namespace aurasim::physics::testing
