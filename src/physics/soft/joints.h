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

  void clear() { joints_.clear(); }
  /// Adds a joint between two movers, in the order of its bodies. The joints of an island have to be added in an order
  /// that follows from the island alone.
  void add(btTypedConstraint& joint, std::int32_t first, std::int32_t second);
  /// Lays out all added joints. Bodies have to be at their poses of the start of the step.
  void build(std::size_t movers, std::span<const SoftInertia> inertias, int threads);

  // The next three are called by each worker for its share. They return when all workers are done.
  /// Updates the joints to the present poses of the bodies.
  void look(const soft::Mover* movers, const soft::Worker& worker);
  /// Starts a substep: clears the impulses of the one before, and applies springs.
  void begin(soft::Mover* movers, const soft::Worker& worker);
  /// Solves each joint once.
  void solve(soft::Mover* movers, const soft::Worker& worker);

  /// Breaks the joints that took more than their break impulse in a substep.
  void finish();

 private:
  struct Joint {
    btTypedConstraint* joint;
    std::int32_t a, b;  ///< movers
    unsigned what;      ///< bits soft::kHeldAxis and so on
  };

  void fill(std::size_t at, std::span<const SoftInertia> inertias);

  double substep_s_;
  soft::Real h_s_;
  std::vector<Joint> joints_;
  std::vector<unsigned> kinds_;  ///< the different values of Joint::what, ascending
  SoftLayout layout_;            ///< the kind is the index in kinds_
  std::vector<soft::JointBlock> blocks_;
};

}  // namespace aurasim::physics
