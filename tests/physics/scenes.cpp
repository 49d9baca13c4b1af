#include "physics/scenes.h"

#include <algorithm>

#include "physics/state_hash.h"

namespace aurasim::physics::testing {
namespace {

using core::Vec3;

core::ConvexHull octahedron(double radius) {
  core::ConvexHull hull;
  for (int axis = 0; axis < 3; ++axis) {
    hull.points.push_back(radius * Vec3::Unit(axis));
    hull.points.push_back(-radius * Vec3::Unit(axis));
  }
  return hull;
}

/// A hammer: two boxes and a ball.
core::Compound hammer() {
  core::Compound compound;
  const core::Quat upright = core::Quat::Identity();
  compound.parts.push_back({core::Box{{0.1, 0.1, 0.4}}, {{0, 0, 0}, upright}});
  compound.parts.push_back({core::Box{{0.3, 0.1, 0.1}}, {{0, 0, 0.4}, upright}});
  compound.parts.push_back({core::Sphere{0.2}, {{0, 0, -0.4}, upright}});
  return compound;
}

core::Shape ground_shape(Ground ground) {
  if (ground == Ground::kPlane) return core::Plane{};
  core::TriangleMesh mesh;
  constexpr int kCells = 16;
  constexpr double kCell = 20;
  for (int row = 0; row <= kCells; ++row) {
    for (int column = 0; column <= kCells; ++column) {
      mesh.points.push_back({(column - kCells / 2) * kCell, (row - kCells / 2) * kCell, 0});
    }
  }
  for (std::uint32_t row = 0; row < kCells; ++row) {
    for (std::uint32_t column = 0; column < kCells; ++column) {
      const std::uint32_t corner = row * (kCells + 1) + column;
      mesh.triangles.push_back({corner, corner + 1, corner + kCells + 2});
      mesh.triangles.push_back({corner, corner + kCells + 2, corner + kCells + 1});
    }
  }
  return mesh;
}

core::Scene scene_with(const std::vector<core::Shape>& shapes, Ground ground) {
  core::Scene scene;
  core::Material rough;
  rough.rolling_friction = 0.02;
  rough.spinning_friction = 0.01;
  rough.linear_damping = 0.05;
  rough.angular_damping = 0.3;
  scene.materials.push_back(rough);
  for (const core::Shape& shape : shapes) {
    const auto index = static_cast<std::uint32_t>(scene.shapes.size());
    scene.shapes.push_back({"shape " + std::to_string(index), shape});
    core::Prototype prototype;
    prototype.shape = index;
    scene.prototypes.push_back(prototype);
  }
  core::StaticBody floor;
  floor.shape = static_cast<std::uint32_t>(scene.shapes.size());
  scene.shapes.push_back({"ground", ground_shape(ground)});
  scene.statics.push_back(floor);
  return scene;
}

bool same_bits(const core::BodyRecord& a, const core::BodyRecord& b) {
  return a.id == b.id && a.activation_state == b.activation_state && a.deactivation_time == b.deactivation_time &&
         a.p_WB == b.p_WB && a.R_WB == b.R_WB && a.v_WB == b.v_WB && a.w_WB == b.w_WB && a.block == b.block;
}

}  // namespace

core::Scene scene_of_all_shapes(Ground ground) {
  return scene_with({core::Sphere{0.4}, core::Box{{0.3, 0.3, 0.45}}, core::Capsule{0.3, 0.6}, core::Cylinder{0.35, 0.7},
                     octahedron(0.5), hammer()},
                    ground);
}

core::Scene scene_of(const core::Shape& shape, Ground ground) { return scene_with({shape}, ground); }

core::BodyRecord body(std::uint64_t id, int kind, const Vec3& p_WB, const Vec3& v_WB) {
  core::InitialBody initial;
  initial.id = core::BodyId{id};
  initial.prototype = core::PrototypeId{static_cast<std::uint32_t>(kind)};
  initial.pose.p_WB = p_WB;
  initial.v_WB = v_WB;
  return core::initial_record(initial);
}

std::vector<core::BodyRecord> pile(std::mt19937_64& random, std::uint64_t first_id, int count, double x, double y) {
  std::vector<core::BodyRecord> bodies;
  for (int i = 0; i < count; ++i) {
    core::InitialBody initial;
    initial.id = core::BodyId{first_id + static_cast<std::uint64_t>(i)};
    initial.prototype = core::PrototypeId{static_cast<std::uint32_t>(random() % kKinds)};
    initial.pose.p_WB = {x + uniform(random, -0.8, 0.8), y + uniform(random, -0.8, 0.8), 0.8 + 0.8 * i};
    initial.pose.q_WB = core::Quat(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1), 0.1);
    initial.v_WB = {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -3, 1)};
    bodies.push_back(core::initial_record(initial));
  }
  return bodies;
}

std::vector<core::BodyRecord> stack(std::uint64_t first_id, int count, double x, double y) {
  std::vector<core::BodyRecord> bodies;
  for (int i = 0; i < count; ++i) {
    bodies.push_back(body(first_id + static_cast<std::uint64_t>(i), kBox, {x, y, 0.45 + 0.9 * i}));
  }
  return bodies;
}

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

std::vector<core::BodyId> ids_of(std::span<const core::BodyRecord> bodies) {
  std::vector<core::BodyId> ids;
  for (const core::BodyRecord& body : bodies) ids.push_back(body.id);
  return ids;
}

void run(RegionWorld& world, int steps) {
  for (int i = 0; i < steps; ++i) world.step();
}

std::vector<std::uint64_t> different(std::span<const core::BodyRecord> some, std::span<const core::BodyRecord> all) {
  std::vector<std::uint64_t> ids;
  for (const core::BodyRecord& body : some) {
    const auto other = std::lower_bound(all.begin(), all.end(), body.id,
                                        [](const core::BodyRecord& b, core::BodyId id) { return b.id < id; });
    if (other == all.end() || !same_bits(body, *other)) ids.push_back(core::value_of(body.id));
  }
  return ids;
}

std::uint64_t hash_sum(std::span<const core::BodyRecord> bodies) {
  std::uint64_t sum = 0;
  for (const core::BodyRecord& body : bodies) sum += state_hash(body);
  return sum;
}

}  // namespace aurasim::physics::testing
