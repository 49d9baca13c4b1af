// Scenes for the tests of physics/, and bodies to put into them.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "core/scene.h"
#include "physics/region_world.h"

namespace aurasim::physics::testing {

/// Every shape that can move, in this order in the scenes below.
enum Kind { kSphere, kBox, kCapsule, kCylinder, kHull, kCompound, kKinds };
inline const char* const kKindNames[] = {"Sphere", "Box", "Capsule", "Cylinder", "Hull", "Compound"};

/// What pulls down in the scenes below, in m/s^2.
inline constexpr double kGravity = 9.81;

enum class Ground { kPlane, kMesh };

/// One prototype of 1 kg for each kind, and the ground at z = 0.
core::Scene scene_of_all_shapes(Ground ground = Ground::kPlane);

/// As above with nothing but one shape as prototype 0.
core::Scene scene_of(const core::Shape& shape, Ground ground = Ground::kPlane);

core::BodyRecord body(std::uint64_t id, int kind, const core::Vec3& p_WB, const core::Vec3& v_WB = core::Vec3::Zero());

/// `count` bodies of random kinds and orientations in a column above (x, y), from low to high.
std::vector<core::BodyRecord> pile(std::mt19937_64& random, std::uint64_t first_id, int count, double x, double y);

/// 0.9 m boxes on top of each other, touching, at rest.
std::vector<core::BodyRecord> stack(std::uint64_t first_id, int count, double x, double y);

/// In [low, high).
double uniform(std::mt19937_64& random, double low, double high);

std::vector<core::BodyId> ids_of(std::span<const core::BodyRecord> bodies);

void run(RegionWorld& world, int steps);

/// Ids of the bodies of `some` whose state is not, to the last bit, that of the same body in `all`.
std::vector<std::uint64_t> different(std::span<const core::BodyRecord> some, std::span<const core::BodyRecord> all);

/// Sum over bodies, as reported in state_hash.csv.
std::uint64_t hash_sum(std::span<const core::BodyRecord> bodies);

}  // namespace aurasim::physics::testing
