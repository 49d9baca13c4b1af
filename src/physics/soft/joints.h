// Joints in the soft step: rows as Bullet's joints state them, made anew in each substep from where their bodies are.
#pragma once

#include <cstdint>
#include <vector>

#include <LinearMath/btVector3.h>

#include "physics/soft/lanes.h"

class btTypedConstraint;

namespace aurasim::physics {

class SoftJoints {
 public:
  void clear() { joints_.clear(), movers_.clear(), is_known_.clear(); }
  /// Between the bodies of movers a and b. Those of an island in an order that follows from the island alone.
  void add(btTypedConstraint& joint, std::uint32_t a, std::uint32_t b);
  bool empty() const { return joints_.empty(); }
  /// Of all joints.
  const std::vector<std::uint32_t>& movers() const { return movers_; }

  /// From the present poses and velocities of the bodies. What the rows have pushed so far is forgotten.
  void begin(soft::Real h_s);
  /// Each row once.
  void solve(soft::Mover* movers);
  /// Breaks the joints that took more than they bear in this substep.
  void finish();

 private:
  /// J v = error, in m/s or rad/s.
  struct Row {
    btVector3 linear_a, angular_a, linear_b, angular_b;  ///< J
    btVector3 v_a, w_a, v_b, w_b;                        ///< what a unit impulse changes
    btScalar mass, error, mixing, low, high, impulse;
  };
  struct Joint {
    btTypedConstraint* joint;
    std::uint32_t a, b;  ///< movers
    std::uint32_t first_row, rows;
  };

  void make_rows(Joint& joint, soft::Real h_s);

  std::vector<Joint> joints_;
  std::vector<Row> rows_;
  std::vector<std::uint32_t> movers_;
  std::vector<char> is_known_;  ///< by mover: is in movers_
};

}  // namespace aurasim::physics
