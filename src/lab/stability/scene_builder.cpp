#include "lab/stability/scene_builder.h"

#include <algorithm>
#include <cmath>

#include "physics/inertia.h"

namespace aurasim::lab {

using core::Vec3;

SceneBuilder::SceneBuilder(const std::string& name, const Vec3& gravity) {
  scene_.name = name;
  scene_.gravity = gravity;
  material(0);
}

SceneBuilder& SceneBuilder::material(double friction_of_pair, double restitution_of_pair) {
  core::Material material;
  material.friction = std::sqrt(friction_of_pair);
  material.restitution = std::sqrt(restitution_of_pair);
  if (scene_.prototypes.empty() && scene_.statics.empty()) scene_.materials.clear();
  scene_.materials.push_back(material);
  return *this;
}

std::uint32_t SceneBuilder::shape_index(const core::Shape& shape) {
  scene_.shapes.push_back({"shape " + std::to_string(scene_.shapes.size()), shape});
  return static_cast<std::uint32_t>(scene_.shapes.size() - 1);
}

core::PrototypeId SceneBuilder::kind(const core::Shape& shape, double mass_kg) {
  core::Prototype prototype;
  prototype.shape = shape_index(shape);
  prototype.material = static_cast<std::uint32_t>(scene_.materials.size() - 1);
  prototype.mass_kg = mass_kg;
  prototype.can_sleep = false;
  scene_.prototypes.push_back(prototype);
  return core::PrototypeId{static_cast<std::uint32_t>(scene_.prototypes.size() - 1)};
}

core::BodyId SceneBuilder::body(core::PrototypeId kind, const core::Pose& pose, const Vec3& v_W, const Vec3& w_W) {
  const core::BodyId id{scene_.bodies.size()};
  scene_.bodies.push_back({id, kind, pose, v_W, w_W});
  return id;
}

core::BodyId SceneBuilder::body(const core::Shape& shape, double mass_kg, const Vec3& p_W, const Vec3& v_W,
                                const Vec3& w_W, const core::Quat& q_WB) {
  return body(kind(shape, mass_kg), {p_W, q_WB}, v_W, w_W);
}

SceneBuilder& SceneBuilder::fixed(const core::Shape& shape, const core::Pose& pose) {
  core::StaticBody body;
  body.shape = shape_index(shape);
  body.material = static_cast<std::uint32_t>(scene_.materials.size() - 1);
  body.pose = pose;
  scene_.statics.push_back(body);
  return *this;
}

SceneBuilder& SceneBuilder::joint(const core::JointKind& kind, core::BodyId a, std::optional<core::BodyId> b,
                                  const core::Pose& X_WJ) {
  core::JointSpec joint;
  joint.name = "joint " + std::to_string(scene_.joints.size());
  joint.kind = kind;
  joint.a = a;
  joint.b = b;
  joint.X_WJ = X_WJ;
  scene_.joints.push_back(joint);
  return *this;
}

Metric drift(const core::Scene& scene) {
  return {"farthest that a body is from its place", "m", Over::kLargest, [bodies = scene.bodies](const Moment& now) {
            double farthest = 0;
            for (std::size_t i = 0; i < bodies.size(); ++i) {
              farthest = std::max(farthest, (now.bodies[i].p_WB - bodies[i].pose.p_WB).norm());
            }
            return farthest;
          }};
}

Metric fallen(const core::Scene& scene, double drop_m) {
  return {"share of bodies that have fallen", "1", Over::kLast, [bodies = scene.bodies, drop_m](const Moment& now) {
            double count = 0;
            for (std::size_t i = 0; i < bodies.size(); ++i) {
              if (bodies[i].pose.p_WB.z() - now.bodies[i].p_WB.z() > drop_m) ++count;
            }
            return count / static_cast<double>(bodies.size());
          }};
}

Metric sunk(const core::Scene& scene) {
  return {"deepest that a body has sunk", "m", Over::kLast, [bodies = scene.bodies](const Moment& now) {
            double deepest = 0;
            for (std::size_t i = 0; i < bodies.size(); ++i) {
              deepest = std::max(deepest, bodies[i].pose.p_WB.z() - now.bodies[i].p_WB.z());
            }
            return deepest;
          }};
}

double energy(const core::Scene& scene, std::span<const core::BodyRecord> bodies) {
  double sum = 0;
  for (const core::BodyRecord& body : bodies) {
    const core::Prototype& prototype = scene.prototypes[core::value_of(body.prototype)];
    const Vec3 inertia = physics::inertia_of(prototype, scene);
    const Vec3 w_B = body.R_WB.transpose() * body.w_WB;
    sum += 0.5 * prototype.mass_kg * body.v_WB.squaredNorm() + 0.5 * w_B.dot(inertia.cwiseProduct(w_B));
    sum -= prototype.mass_kg * scene.gravity.dot(body.p_WB);
  }
  return sum;
}

}  // namespace aurasim::lab
