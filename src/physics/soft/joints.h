// The joints of awake bodies, as the soft step solves them: coloured like patches (soft/layout.h), side by side in
// blocks. Their impulses start from 0 in each substep, at the poses that their bodies have by then.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "physics/soft/lanes.h"
#include "physics/soft/layout.h"
#include "physics/soft/patches.h"
#include "physics/soft/threads.h"

class btTypedConstraint;

namespace aurasim::physics {

struct JointAxes;

/// A joint's user pointer is its JointAxes*, from which its settings are read and into which the drive's impulse is
/// written.
class SoftJoints {
 public:
  explicit SoftJoints(double substep_s);

  void clear(std::size_t joints) { joints_.resize(joints); }
  /// Sets the i-th joint, between two movers in the order of its bodies. The joints of an island have to come in an
  /// order that follows from the island alone. Several threads may set different joints.
  void put(std::size_t i, btTypedConstraint& joint, std::int32_t first, std::int32_t second);
  /// Requests the memory that put() reads, for a joint that has been prefetched itself.
  static void prefetch_parts(btTypedConstraint& joint);
  /// Lays out all joints. Bodies have to be at their poses of the start of the step.
  void build(std::size_t movers, std::span<const SoftInertia> inertias, soft::Team& team);

  // The next three are called by each worker for its share. They return when all workers are done. Joints that share
  // bodies, however indirectly, are those of one worker, unless they are too many.
  /// Updates the joints to the present poses of the bodies.
  void look(const soft::Mover* movers, const soft::Worker& worker);
  /// Starts a substep: clears the impulses of the one before, and applies springs. Then solves each joint so many
  /// times.
  void begin_and_solve(soft::Mover* movers, int sweeps, const soft::Worker& worker);
  /// Updates the joints, and solves each so many times.
  void look_and_solve(soft::Mover* movers, int sweeps, const soft::Worker& worker);

  /// Breaks the joints that took more than their break impulse in a substep.
  void finish(soft::Team& team);

 private:
  struct Joint {
    btTypedConstraint* joint;
    JointAxes* axes;
    std::int32_t a, b;  ///< movers
    unsigned what;      ///< bits soft::kHeldAxis and so on
  };

  void find_groups(std::size_t movers);
  std::int32_t first_of(std::int32_t mover);
  void fill(std::size_t at, std::span<const SoftInertia> inertias);
  void finish(std::size_t at);

  double substep_s_;
  soft::Real h_s_;
  std::vector<Joint> joints_;
  std::vector<unsigned> kinds_;  ///< the different values of Joint::what, ascending
  /// by mover: another one of the same mechanism, or itself (union-find)
  std::vector<std::int32_t> parents_;
  std::vector<std::int32_t> groups_;                   ///< by the first mover of a mechanism: its number, or -1
  SoftLayout layout_{SoftLayout::Waits::kOnceForAll};  ///< the kind is the index in kinds_
  std::vector<soft::JointBlock> blocks_;
};

}  // namespace aurasim::physics
