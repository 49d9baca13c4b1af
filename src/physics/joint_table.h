// The joints of one world. A joint is in Bullet while all its bodies are here and it is whole; what is known of it
// travels with each of its bodies.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/scene.h"
#include "physics/body_table.h"
#include "physics/constraints.h"
#include "physics/dynamics_world.h"
#include "physics/joint_axes.h"

namespace aurasim::physics {

class JointTable {
 public:
  /// The scene outlives the table; so do the body table and the world that its functions are given, always the same.
  JointTable(const core::Scene& scene, const Settings& settings);

  /// What a cluster that has just come says about its joints. Before connect().
  void restore(const core::ClusterState& cluster, const BodyTable& bodies);
  /// Puts the joints of a body in, as far as its other body is here.
  void connect(core::BodyId body, BodyTable& bodies, DynamicsWorld& world);
  /// Takes the joints of bodies out that are about to leave.
  void disconnect(const core::ClusterState& leaving, BodyTable& bodies, DynamicsWorld& world);
  /// After each substep: joints that broke in it are gone for good.
  void remove_broken(DynamicsWorld& world);
  /// While there are no bodies: those that come say which are broken.
  void forget_broken();

  /// Adds the joints of the cluster's bodies to it, in order of id. Returns how many of them, being whole, also hold a
  /// body that is here and not in the cluster.
  std::uint64_t append_to(core::ClusterState& cluster) const;

  /// Pairs of bodies that are held together here, by place in the table, in order.
  void list_pairs(const BodyTable& bodies, std::vector<core::Contact>& pairs) const;

 private:
  struct Entry {
    JointAxes axes;
    std::unique_ptr<btTypedConstraint> constraint;
    bool broken = false;
  };

  const std::vector<core::JointId>& joints_of(core::BodyId body) const;
  void disconnect(Entry& entry, DynamicsWorld& world);

  const core::Scene* scene_;
  double substep_s_;
  std::vector<Entry> entries_;                                              ///< as Scene::joints
  std::unordered_map<core::BodyId, std::vector<core::JointId>> joints_of_;  ///< asked by id only
  std::vector<core::JointId> connected_;                                    ///< ascending
  std::unique_ptr<btRigidBody> ground_;  ///< what joints to the world hold on to; in no world
};

}  // namespace aurasim::physics
