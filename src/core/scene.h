// A scene as plain data: read by config/, built by physics/, counted by core/. Lengths in metres, masses in kilograms,
// angles in radians, times in seconds.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/body_state.h"
#include "core/ids.h"
#include "core/joint.h"
#include "core/static_list.h"

namespace aurasim::core {

struct Sphere {
  double radius = 0.5;
};
struct Box {
  Vec3 half_extents = Vec3::Constant(0.5);
};
/// Axis along z; `height` is between the centres of the caps.
struct Capsule {
  double radius = 0.3;
  double height = 1.0;
};
/// Axis along z; `height` is the whole height.
struct Cylinder {
  double radius = 0.3;
  double height = 1.0;
};
struct ConvexHull {
  std::vector<Vec3> points;
};
/// Triangles are triples of indices into `points`, counter-clockwise from outside. Statics only.
struct TriangleMesh {
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
/// Half-space below the plane `normal . x = offset`. Statics only.
struct Plane {
  Vec3 normal = Vec3::UnitZ();
  double offset = 0;
};

using ConvexShape = std::variant<Sphere, Box, Capsule, Cylinder, ConvexHull>;

struct CompoundPart {
  ConvexShape shape;
  Pose pose;  ///< pose in the compound's frame, whose origin is the centre of mass
  /// material of the part's surface, index in Scene::materials; nothing: the body's
  std::optional<std::uint32_t> material{};
};
struct Compound {
  std::vector<CompoundPart> parts;
};

using Shape = std::variant<Sphere, Box, Capsule, Cylinder, ConvexHull, Compound, TriangleMesh, Plane>;

struct Material {
  std::string name;
  double friction = 0.5;
  double rolling_friction = 0;
  double spinning_friction = 0;
  double restitution = 0;
  double linear_damping = 0;   ///< share of velocity lost per second
  double angular_damping = 0;  ///< share of spin lost per second
};

struct NamedShape {
  std::string name;
  Shape shape;
};

/// Properties that bodies of one kind share. A body's PrototypeId is the index in Scene::prototypes.
struct Prototype {
  std::string name;
  std::uint32_t shape = 0;     ///< index in Scene::shapes
  std::uint32_t material = 0;  ///< index in Scene::materials
  double mass_kg = 1;
  bool can_sleep = true;
  /// Moments of inertia about the centre of mass along the axes of the body, kg m^2. Nothing: computed for mass spread
  /// evenly.
  std::optional<Vec3> inertia = {};
  bool collides = true;  ///< false: it touches nothing, and rays pass through it; joints move it
};

/// A body that exists in state 0.
struct InitialBody {
  BodyId id{};
  PrototypeId prototype{};
  Pose pose;
  Vec3 v_WB = Vec3::Zero();
  Vec3 w_WB = Vec3::Zero();
};

/// Creates bodies from a seeded sequence: body i is the same whichever node creates it.
struct Injector {
  std::string name;
  std::uint64_t seed = 1;
  BodyId first_id{};             ///< body i has id first_id + i
  std::uint64_t max_bodies = 0;  ///< number of bodies that it creates in all, at most
  double rate_per_s = 1;
  double start_s = 0;
  Vec3 volume_min = Vec3::Zero();
  Vec3 volume_max = Vec3::Zero();
  Vec3 velocity_min = Vec3::Zero();
  Vec3 velocity_max = Vec3::Zero();
  bool random_orientation = false;
  std::vector<PrototypeId> prototypes;  ///< one of them is drawn for each body
};

struct Scene {
  std::string name;
  Vec3 gravity = {0, 0, -9.81};
  std::vector<NamedShape> shapes;
  std::vector<Material> materials;
  std::vector<Prototype> prototypes;
  StaticList statics;
  std::vector<InitialBody> bodies;  ///< ascending id
  std::vector<JointSpec> joints;
  std::vector<Injector> injectors;
};

/// Radius of the smallest sphere around the origin of the shape's frame that holds the shape. Infinite for a plane.
double bounding_radius(const Shape& shape);

/// The body with this id, or null if the scene has no such body in state 0.
const InitialBody* find_body(const Scene& scene, BodyId id);

/// The static of this name; nothing if the scene has none.
std::optional<StaticId> find_static(const Scene& scene, std::string_view name);

/// Pairs of `bodies` (ascending by id) that joints of the scene hold together, as indices into it. Joints with a body
/// outside `bodies` are left out.
std::vector<Contact> joint_pairs(const Scene& scene, const std::vector<BodyState>& bodies);

/// The record of a body of state 0, epoch 0.
BodyRecord initial_record(const InitialBody& body, Step birth = 0);

/// Body `index` of `injector` (its state at birth), or nothing when the sequence has ended.
/// The same arguments give the same body on every node (std::mt19937_64 seeded with (seed, index)).
std::optional<BodyRecord> injected_body(const Injector& injector, std::uint64_t index, double step_s);

/// State in which body `index` is born; the largest Step if the injector makes no such body. It never falls as the
/// index grows, because rounding is monotonic. A time that is a whole number of steps up to rounding counts as that
/// number.
Step birth_step(const Injector& injector, std::uint64_t index, double step_s);

/// How many bodies of `injector` exist in state `step` (those with birth <= step).
std::uint64_t injected_count(const Injector& injector, Step step, double step_s);

}  // namespace aurasim::core
