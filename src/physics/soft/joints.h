// The joints of awake bodies, as the soft step solves them: coloured as patches are (soft/layout.h), side by side in
// blocks. They start from nothing in each substep, from where their bodies are by then.
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

/// What of a joint is told with it, and what it has been driven by is told there, as its user pointer: JointAxes*.
class SoftJoints {
 public:
  explicit SoftJoints(double substep_s);

  void clear() { joints_.clear(); }
  /// Between two movers, as the joint names them. Those of an island in an order that follows from the island alone.
  void add(btTypedConstraint& joint, std::int32_t first, std::int32_t second);
  /// Lays out all that was added, between bodies that are where the step began.
  void build(std::size_t movers, std::span<const SoftInertia> inertias, int threads);

  // By each worker, for its share. When they return, all have done theirs.
  /// As the bodies are now.
  void look(const soft::Mover* movers, const soft::Worker& worker);
  /// A substep: what has been pushed in the one before is forgotten; springs push.
  void begin(soft::Mover* movers, const soft::Worker& worker);
  /// Each once.
  void solve(soft::Mover* movers, const soft::Worker& worker);

  /// Breaks the joints that took more than they bear in a substep.
  void finish();

 private:
  struct Joint {
    btTypedConstraint* joint;
    std::int32_t a, b;  ///< movers
    unsigned what;      ///< soft::kHeldAxis and so on
  };

  void fill(std::size_t at, std::span<const SoftInertia> inertias);

  double substep_s_;
  soft::Real h_s_;
  std::vector<Joint> joints_;
  std::vector<unsigned> kinds_;  ///< what joints have, ascending
  SoftLayout layout_;            ///< by kind
  std::vector<soft::JointBlock> blocks_;
};

}  // namespace aurasim::physics
