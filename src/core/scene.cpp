#include "core/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace aurasim::core {
namespace {

double farthest(const std::vector<Vec3>& points, const Pose& pose = {}) {
  double radius = 0;
  for (const Vec3& p : points) radius = std::max(radius, (pose.p_WB + pose.q_WB * p).norm());
  return radius;
}

double farthest_corner(const Vec3& half_extents, const Pose& pose) {
  double radius = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 sign((corner & 1) ? 1 : -1, (corner & 2) ? 1 : -1, (corner & 4) ? 1 : -1);
    radius = std::max(radius, (pose.p_WB + pose.q_WB * half_extents.cwiseProduct(sign)).norm());
  }
  return radius;
}

/// Distance from the frame's origin to the farthest point of a cylinder's rims. That point is straight away from the
/// origin, so only the end's height along the axis and the axis's distance from the origin count.
double farthest_rim(double radius, double height, const Pose& pose) {
  const Vec3 axis = pose.q_WB * Vec3::UnitZ();
  double farthest = 0;
  for (const double end : {-0.5, 0.5}) {
    const Vec3 centre = pose.p_WB + end * height * axis;
    const double along = centre.dot(axis);
    farthest = std::max(farthest, std::hypot(along, (centre - along * axis).norm() + radius));
  }
  return farthest;
}

/// Distance from the origin of the frame that `pose` is given in to the farthest point of the shape.
struct FarthestPoint {
  Pose pose;

  double operator()(const Sphere& s) const { return pose.p_WB.norm() + s.radius; }
  double operator()(const Box& s) const { return farthest_corner(s.half_extents, pose); }
  double operator()(const Capsule& s) const {
    const Vec3 to_cap = pose.q_WB * Vec3(0, 0, s.height / 2);
    return std::max((pose.p_WB + to_cap).norm(), (pose.p_WB - to_cap).norm()) + s.radius;
  }
  double operator()(const Cylinder& s) const { return farthest_rim(s.radius, s.height, pose); }
  double operator()(const ConvexHull& s) const { return farthest(s.points, pose); }
  double operator()(const TriangleMesh& s) const { return farthest(s.points, pose); }
  double operator()(const Plane&) const { return std::numeric_limits<double>::infinity(); }
  double operator()(const Compound& s) const {
    double radius = 0;
    for (const CompoundPart& part : s.parts)
      radius = std::max(radius, std::visit(FarthestPoint{part.pose}, part.shape));
    return radius;
  }
};

std::mt19937_64 generator_of(std::uint64_t seed, std::uint64_t index) {
  const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
  const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); };
  std::seed_seq sequence{low(seed), high(seed), low(index), high(index)};
  return std::mt19937_64(sequence);
}

/// Uniform in [0, 1). Written by hand, because the C++ standard leaves the algorithm of its distributions open.
double uniform(std::mt19937_64& generator) { return static_cast<double>(generator() >> 11) * 0x1p-53; }

Vec3 uniform_in(std::mt19937_64& generator, const Vec3& low, const Vec3& high) {
  Vec3 drawn;
  for (int axis = 0; axis < 3; ++axis) drawn[axis] = low[axis] + uniform(generator) * (high[axis] - low[axis]);
  return drawn;
}

/// Uniformly distributed rotation (K. Shoemake, Uniform random rotations, Graphics Gems III, 1992).
Quat uniform_rotation(std::mt19937_64& generator) {
  const double u = uniform(generator);
  const double angle_1 = 2 * std::numbers::pi * uniform(generator);
  const double angle_2 = 2 * std::numbers::pi * uniform(generator);
  const double a = std::sqrt(1 - u);
  const double b = std::sqrt(u);
  return Quat(b * std::cos(angle_2), a * std::sin(angle_1), a * std::cos(angle_1), b * std::sin(angle_2)).normalized();
}

bool has_bodies(const Injector& injector) {
  return injector.max_bodies > 0 && injector.rate_per_s > 0 && !injector.prototypes.empty();
}

}  // namespace

double bounding_radius(const Shape& shape) { return std::visit(FarthestPoint{}, shape); }

const InitialBody* find_body(const Scene& scene, BodyId id) {
  const auto place = std::lower_bound(scene.bodies.begin(), scene.bodies.end(), id,
                                      [](const InitialBody& body, BodyId wanted) { return body.id < wanted; });
  return place != scene.bodies.end() && place->id == id ? &*place : nullptr;
}

std::optional<StaticId> find_static(const Scene& scene, std::string_view name) {
  const std::optional<std::size_t> found = scene.statics.find(name);
  return found ? std::optional(StaticId{static_cast<std::uint32_t>(*found)}) : std::nullopt;
}

std::vector<Contact> joint_pairs(const Scene& scene, const std::vector<BodyState>& bodies) {
  const auto place_of = [&](BodyId id) -> std::optional<std::uint32_t> {
    const auto place = std::ranges::lower_bound(bodies, id, {}, &BodyState::id);
    if (place == bodies.end() || place->id != id) return {};
    return static_cast<std::uint32_t>(place - bodies.begin());
  };
  std::vector<Contact> pairs;
  for (const JointSpec& joint : scene.joints) {
    if (!joint.b) continue;
    const auto a = place_of(joint.a), b = place_of(*joint.b);
    if (a && b) pairs.push_back({std::min(*a, *b), std::max(*a, *b)});
  }
  return pairs;
}

BodyRecord initial_record(const InitialBody& body, Step birth) {
  BodyRecord record;
  record.id = body.id;
  record.prototype = body.prototype;
  record.birth = birth;
  record.p_WB = body.pose.p_WB;
  record.R_WB = body.pose.q_WB.normalized().toRotationMatrix();
  record.v_WB = body.v_WB;
  record.w_WB = body.w_WB;
  return record;
}

Step birth_step(const Injector& injector, std::uint64_t index, double step_s) {
  if (!has_bodies(injector) || index >= injector.max_bodies) return std::numeric_limits<Step>::max();
  constexpr double kRounding = 1e-9;
  const double time_s = injector.start_s + (static_cast<double>(index) + 1) / injector.rate_per_s;
  return static_cast<Step>(std::clamp(std::ceil(time_s / step_s - kRounding), 1.0, 0x1p62));
}

std::optional<BodyRecord> injected_body(const Injector& injector, std::uint64_t index, double step_s) {
  if (!has_bodies(injector) || index >= injector.max_bodies) return std::nullopt;
  std::mt19937_64 generator = generator_of(injector.seed, index);
  const auto kinds = static_cast<double>(injector.prototypes.size());

  InitialBody body;
  body.id = BodyId{value_of(injector.first_id) + index};
  body.prototype = injector.prototypes[static_cast<std::size_t>(uniform(generator) * kinds)];
  body.pose.p_WB = uniform_in(generator, injector.volume_min, injector.volume_max);
  body.v_WB = uniform_in(generator, injector.velocity_min, injector.velocity_max);
  if (injector.random_orientation) body.pose.q_WB = uniform_rotation(generator);
  return initial_record(body, birth_step(injector, index, step_s));
}

std::uint64_t injected_count(const Injector& injector, Step step, double step_s) {
  if (!has_bodies(injector)) return 0;
  std::uint64_t born = 0;  // bisection: indices below `born` are born, those from `unborn` on are not
  std::uint64_t unborn = injector.max_bodies;
  while (born < unborn) {
    const std::uint64_t middle = born + (unborn - born) / 2;
    if (birth_step(injector, middle, step_s) <= step) {
      born = middle + 1;
    } else {
      unborn = middle;
    }
  }
  return born;
}

}  // namespace aurasim::core
