// Scenes put together in code. Bodies never sleep, so that nothing hides an error.
#pragma once

#include <optional>

#include "core/scene.h"
#include "lab/case.h"

namespace aurasim::lab {

inline constexpr double kGravity = 9.81;  ///< m/s^2, downwards unless a case says otherwise

class SceneBuilder {
 public:
  explicit SceneBuilder(const std::string& name, const core::Vec3& gravity = {0, 0, -kGravity});

  /// Material of all bodies and statics added after this. Bullet multiplies the values of two bodies, so the arguments
  /// are products for two bodies of this material.
  SceneBuilder& material(double friction_of_pair, double restitution_of_pair = 0);
  core::PrototypeId kind(const core::Shape& shape, double mass_kg);
  core::BodyId body(core::PrototypeId kind, const core::Pose& pose, const core::Vec3& v_W = core::Vec3::Zero(),
                    const core::Vec3& w_W = core::Vec3::Zero());
  /// Adds a body of a kind of its own.
  core::BodyId body(const core::Shape& shape, double mass_kg, const core::Vec3& p_W,
                    const core::Vec3& v_W = core::Vec3::Zero(), const core::Vec3& w_W = core::Vec3::Zero(),
                    const core::Quat& q_WB = core::Quat::Identity());
  SceneBuilder& fixed(const core::Shape& shape, const core::Pose& pose = {});
  /// Adds the plane z = 0.
  SceneBuilder& ground() { return fixed(core::Plane{}); }
  SceneBuilder& joint(const core::JointKind& kind, core::BodyId a, std::optional<core::BodyId> b,
                      const core::Pose& X_WJ);

  const core::Scene& scene() const { return scene_; }

 private:
  std::uint32_t shape_index(const core::Shape& shape);

  core::Scene scene_;
};

/// Farthest that any body is from where it was in state 0, m.
Metric drift(const core::Scene& scene);
/// Share of bodies that have dropped by more than `drop_m`, in the last state.
Metric fallen(const core::Scene& scene, double drop_m);

/// Deepest that a body is below its place in the last state, m.
Metric sunk(const core::Scene& scene);

/// Sum over bodies of kinetic energy and height energy, J. Inertia is that of the scene's shapes.
double energy(const core::Scene& scene, std::span<const core::BodyRecord> bodies);

}  // namespace aurasim::lab
