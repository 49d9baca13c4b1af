// Two bodies on their ways through one step, of which only both ends are known: may they have touched? Errs on the safe
// side.
#pragma once

#include "core/aura.h"

namespace aurasim::core {

/// How far a path of length `longest` between two points can leave the straight line, if they are `apart` from each
/// other. All in metres.
double bulge(double longest, double apart);

/// A body on its way through one step.
struct StepMotion {
  Path at_start, at_end;
  double stray_m = 0;  ///< how far its surface may be off the straight way in between
};

class StepMotions {
 public:
  explicit StepMotions(const Aura& aura) : aura_(aura) {}

  /// The motion of a body through the step that ends in `now`; `before`: its path a state earlier. Without it the
  /// body's announcement has just begun: it was far from foreign bodies a state ago, so a straight way is assumed.
  StepMotion of(const Path& now, const Path* before) const;
  /// May two bodies have touched during the step? Physics looks for contacts at the start of each substep.
  bool touch(const StepMotion& a, const StepMotion& b) const;

 private:
  Pose pose(const StepMotion& motion, double share) const;
  bool meet_ahead(const StepMotion& a, const StepMotion& b, double allowed_m) const;
  bool meet_on(const Pose& a, const Pose& b, const StepMotion& of_a, const StepMotion& of_b, const Vec3& way,
               double allowed_m) const;
  bool sweeps_into(const StepMotion& moving, const StepMotion& other, double share, double allowed_m) const;

  const Aura& aura_;
};

}  // namespace aurasim::core
