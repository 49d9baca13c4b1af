// The joints of one world. A joint is in Bullet's world while all its bodies are here and it is not broken. A hand-off
// of each of its bodies carries its state.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/mechanisms.h"
#include "core/scene.h"
#include "physics/body_table.h"
#include "physics/constraints.h"
#include "physics/dynamics_world.h"
#include "physics/joint_axes.h"

namespace aurasim::physics {

using core::JointMotion;

class JointTable {
 public:
  /// The scene has to outlive the table. All calls have to pass the same body table and the same world.
  JointTable(const core::Scene& scene, const Settings& settings);

  /// Takes the joint states of a cluster that has just joined. Call before connect().
  void restore(const core::ClusterState& cluster, const BodyTable& bodies);
  /// Inserts the joints of a body whose other body is here.
  void connect(core::BodyId body, BodyTable& bodies, DynamicsWorld& world);
  /// Removes the joints of bodies that are about to leave.
  void disconnect(const core::ClusterState& leaving, BodyTable& bodies, DynamicsWorld& world);
  /// Sets all joints to the states of `then`, the bodies of which are all bodies here. Joints that are in Bullet's
  /// world and unbroken stay there.
  void put_back(const core::ClusterState& then, BodyTable& bodies, DynamicsWorld& world);
  /// Updates coupled joints with the positions of their leaders. Call before each look for contacts.
  void follow();
  /// Call after a look's substeps: removes joints that broke in them for good, and counts the turns of hinges.
  void finish_look(DynamicsWorld& world);
  /// Resets all joints. Clusters that join bring the states of their joints.
  void forget();

  /// Replaces the drive of a hinge or slider from the next step on, until it breaks. Hand-offs of its bodies carry the
  /// drive. Does nothing for other joints and for joints without a body here. Numbers are clamped to +-1e12, and NaN
  /// counts as 0. A max_effort that is NaN, negative or beyond 1e12 counts as infinite.
  void drive(core::JointId id, const core::JointDrive& drive);
  /// Gives the joint its drive of the scene back, from the next step on.
  void let_go(core::JointId id);
  /// Motion of a hinge or slider that holds bodies here; nothing for others. Whole turns of a hinge are counted from
  /// the start. The count is wrong if it turns by more than half a turn per step beyond what its speed predicts.
  std::optional<JointMotion> motion(core::JointId id) const;

  /// Appends the states of the joints of the cluster's bodies to it, in order of id. Returns the number of unbroken
  /// joints that also hold a body here outside the cluster.
  std::uint64_t append_to(core::ClusterState& cluster) const;

  /// Replaces the joints of `all` by those of all bodies of the table, in order of id.
  void copy_all(const BodyTable& bodies, core::ClusterState& all) const;

  /// The mechanisms that the joints in Bullet's world make.
  const std::vector<core::BoundBody>& mechanisms() const { return mechanisms_; }
  /// Updates mechanisms(). Returns false if they have been up to date.
  bool mechanisms_changed();

  /// Lists the pairs of bodies that joints hold together here, by place in the table, in order.
  void list_pairs(const BodyTable& bodies, std::vector<core::Contact>& pairs) const;

 private:
  struct Entry {
    JointAxes axes;
    std::unique_ptr<btTypedConstraint> constraint;
    bool broken = false;
    bool driven_anew = false;  ///< its drive is not that of the scene
    double speed = 0;          ///< present speed of a hinge or slider
  };

  struct Follower {
    core::JointId joint{};
    core::JointCoupling coupling;
    std::vector<core::JointId> way;  ///< joints from this one to its leader, which is the last
  };

  const std::vector<core::JointId>& joints_of(core::BodyId body) const;
  void connect(core::JointId id, BodyTable& bodies, DynamicsWorld& world);
  void begin(Entry& entry);
  void disconnect(Entry& entry, DynamicsWorld& world);
  void forget_broken_off();
  void read_values(std::span<const double> values, Entry& entry) const;
  std::size_t value_count(const Entry& entry) const;
  void write_values(const Entry& entry, std::span<double> values) const;
  void append(core::JointId id, core::ClusterState& cluster) const;
  void measure_again(Entry& entry, double since_s);
  void forget(core::JointId id);

  const core::Scene* scene_;
  double substep_s_;
  double look_s_;
  bool is_soft_;
  std::vector<Entry> entries_;                                              ///< by joint of Scene::joints
  std::unordered_map<core::BodyId, std::vector<core::JointId>> joints_of_;  ///< only looked up by id, never iterated
  std::vector<core::JointId> connected_;                                    ///< ascending
  std::vector<core::BoundBody> mechanisms_;
  bool mechanisms_are_old_ = false;
  std::vector<Follower> followers_;      ///< ascending
  std::unique_ptr<btRigidBody> ground_;  ///< second body of joints to the world; in no Bullet world
};

}  // namespace aurasim::physics
