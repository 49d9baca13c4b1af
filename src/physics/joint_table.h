// The joints of one world. A joint is in Bullet while all its bodies are here and it is whole; what is known of it
// travels with each of its bodies.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
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

using core::JointMotion;

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
  /// Before each look: joints that follow others learn where those are.
  void follow();
  /// After it: joints that broke in it are gone for good, and hinges are seen to turn.
  void finish_look(DynamicsWorld& world);
  /// While there are no bodies: those that come say what is known of their joints.
  void forget();

  /// From the next step on, instead of what has driven the joint so far, for as long as it is not broken; it goes with
  /// the bodies wherever they go. For hinges and sliders of bodies that are here; of other joints nothing is done.
  /// Numbers beyond 1e12 either way count as that, no number as 0; max_effort as infinite.
  void drive(core::JointId id, const core::JointDrive& drive);
  /// Likewise: as the scene says again.
  void let_go(core::JointId id);
  /// Of a hinge or slider that holds bodies here. How often a hinge has turned is counted from the start on; one that
  /// turns by more than half a turn in a step beyond what its speed says is seen wrongly.
  std::optional<JointMotion> motion(core::JointId id) const;

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
    bool driven_anew = false;  ///< not by what the scene says
    double speed = 0;          ///< of a hinge or slider, as the bodies are
  };

  struct Follower {
    core::JointId joint{};
    core::JointCoupling coupling;
    std::vector<core::JointId> way;  ///< to its leader, which is the last
  };

  const std::vector<core::JointId>& joints_of(core::BodyId body) const;
  void disconnect(Entry& entry, DynamicsWorld& world);
  void read_values(std::span<const double> values, Entry& entry) const;
  std::size_t value_count(const Entry& entry) const;
  void write_values(const Entry& entry, std::span<double> values) const;
  void measure_again(Entry& entry, double since_s);
  void forget(core::JointId id);

  const core::Scene* scene_;
  double substep_s_;
  double look_s_;
  bool is_soft_;
  std::vector<Entry> entries_;                                              ///< as Scene::joints
  std::unordered_map<core::BodyId, std::vector<core::JointId>> joints_of_;  ///< asked by id only
  std::vector<core::JointId> connected_;                                    ///< ascending
  std::vector<Follower> followers_;                                         ///< ascending
  std::unique_ptr<btRigidBody> ground_;  ///< what joints to the world hold on to; in no world
};

}  // namespace aurasim::physics
