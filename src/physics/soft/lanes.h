// The data of the soft step (soft/step.h), laid out for so many patches or joints at a time, and its arithmetic, which
// is compiled once for each set of instructions. No lane ever sees another, and nothing is contracted or reordered, so
// neither their number nor the set changes a bit.
#pragma once

#include <cstddef>
#include <cstdint>

namespace aurasim::physics::soft {

// Nothing else may be included here or in soft/kernel*.h: what is inline elsewhere would exist once for all sets.

/// Also where bodies have doubles: speeds change by what is computed here, and bodies move by it, from where and as
/// fast as they were at the start of the step.
using Real = float;
inline constexpr int kLanes = 32 / sizeof(Real);
using Lanes __attribute__((vector_size(32))) = Real;

inline constexpr int kMostPoints = 4;
inline constexpr std::size_t kPointsAtOnce = 16;  ///< of a hull

/// A body, as the substeps see it, in two halves.
struct alignas(64) Mover {
  Real v[3] = {}, w[3] = {};  ///< m/s, rad/s
  Real unused[2] = {};
  Real dp[3] = {};            ///< how far it has come since the start of the step, m
  Real dq[4] = {0, 0, 0, 1};  ///< x, y, z, w: and how it has turned
};

/// What makes kLanes movers in a row tumble: the spin of such a body changes while nothing acts on it.
struct alignas(64) Tumblers {
  Lanes start[4];        ///< x, y, z, w: the body's frame at the start of the step
  Lanes inertia[3];      ///< about its axes, kg m^2; 0: it turns evenly
  Lanes inv_inertia[3];  ///< 1/(kg m^2); likewise
  bool any;              ///< tumbles
};

struct Substep {
  Real per_s = 0;         ///< one over its length
  Real top_push_m_s = 0;  ///< overlaps are undone no faster
  bool pushes = false;    ///< apart what overlaps, by springs; else contacts are rigid, and rub
};

/// Contact points of two bodies with one normal, for kLanes pairs of bodies. None shares a body that moves with
/// another.
struct alignas(64) Block {
  struct Point {
    Lanes r_a[3], r_b[3];         ///< from the centres of mass, at the start of the step, m
    Lanes gap;                    ///< at the start of the step, m; negative: overlap
    Lanes mass;                   ///< along the normal, kg
    Lanes impulse, most_impulse;  ///< N s; the largest of any substep
    Lanes approach;               ///< along the normal at the start of the step, m/s; negative: they come closer
  };

  std::int32_t a[kLanes], b[kLanes];         ///< movers; 0 never moves, below: statics that do
  Lanes inv_mass_a, inv_mass_b;              ///< 1/kg
  Lanes inv_inertia_a[6], inv_inertia_b[6];  ///< xx, xy, xz, yy, yz, zz, world frame
  Lanes normal[3], first[3], second[3];      ///< from a to b; directions of friction
  Lanes belt_1, belt_2;                      ///< of the surface of b from that of a, by belts, m/s
  Lanes rate_per_s;                          ///< of the overlap that springs undo
  Lanes soft_mass, soft_impulse;             ///< share of a rigid contact's impulse; of the impulse that is given back
  Lanes friction, restitution;
  Lanes spinning_m, rolling_m;  ///< friction against turning
  Point points[kMostPoints];
  Lanes centre_a[3], centre_b[3];   ///< of the points: where friction acts, m
  Lanes lever_m;                    ///< mean distance of the points from there
  Lanes mass_11, mass_12, mass_22;  ///< of friction, kg
  Lanes mass_twist, mass_roll[6];   ///< kg m^2
  Lanes rub_1, rub_2;               ///< impulses of friction, N s
  Lanes twist, roll[3];             ///< N m s
};

/// The bits of what joints have: axes that are held or limited, axes with springs, and a motor about the last.
inline constexpr unsigned kHeldAxis = 1, kSpringAxis = 1 << 6, kJointMotor = 1 << 12;
/// Along the axis that a hinge (the last) or a slider (the third) leaves: a drive, a spring with a damper, friction. Of
/// a hinge whether whole turns count. Of a ball joint whether it is damped.
inline constexpr unsigned kJointDrive = 1 << 13, kJointSpring = 1 << 14, kJointFriction = 1 << 15;
inline constexpr unsigned kSlides = 1 << 16, kWholeTurns = 1 << 17, kDampedBall = 1 << 18;

/// Joints of kLanes pairs of bodies. None shares a body that moves with another. What is measured is J of a from J of
/// b: how far it is along the axes of b's, m, and the angles x, y, z of turns about x, then y, then z as they lie then,
/// rad. Directions are the world's.
struct alignas(64) JointBlock {
  struct Axis {
    Lanes low, high;           ///< m or rad; the same: held
    Lanes stiffness, damping;  ///< N/m and N s/m, or N m/rad and N m s/rad
    Lanes rest;                ///< springs pull there, m or rad
    Lanes impulse;             ///< in this substep so far, N s or N m s
    // As the bodies are now:
    Lanes x;            ///< m or rad
    Lanes n[3];         ///< an impulse acts along it, or about it
    Lanes mass;         ///< kg or kg m^2
    Lanes wanted;       ///< of a from b, m/s or rad/s
    Lanes least, most;  ///< impulses
  };

  /// As physics/joint_axes.h has it: impulse = pull - give * speed.
  struct Pull {
    Lanes position, drift, stiffness, steady, give, most;
    Lanes pull;     ///< N s or N m s
    Lanes impulse;  ///< in this substep so far
  };

  std::int32_t a[kLanes], b[kLanes];             ///< movers; 0 never moves
  Lanes inv_mass_a, inv_mass_b;                  ///< 1/kg
  Lanes start_inertia_a[6], start_inertia_b[6];  ///< inverse, as in Block, at the start of the step
  Lanes r_a[3], r_b[3];                ///< of J in a and b, from the centres of mass, at the start of the step, m
  Lanes frame_a[3][3], frame_b[3][3];  ///< axes of J in a and b at the start of the step
  Lanes apart[3];                      ///< of J in a from J in b at the start of the step, m
  Lanes motor_rad_s, motor_impulse;    ///< of a; N m s in a substep
  Lanes breaks;                        ///< by such an impulse in a substep, N s or N m s
  Lanes took;                          ///< the largest of any substep before
  Lanes whole;                         ///< 1, or 0: broken
  Lanes motor_took;                    ///< in this substep so far, N m s
  Axis axes[6];
  // As the bodies are now:
  Lanes inv_inertia_a[6], inv_inertia_b[6];
  Lanes arm_a[3], arm_b[3];  ///< where impulses act, from the centres of mass, m

  // Along the axis that is left:
  Pull drive, spring;
  Lanes friction, rubbed;    ///< N s or N m s in a substep: at most, and in this one so far
  Lanes ball_give;           ///< N m s^2/rad
  Lanes own_mass;            ///< kg or kg m^2, as the bodies move that the held axes hold
  Lanes own_push[3];         ///< an impulse of 1 on a, and against b
  Lanes own_a[3], own_b[3];  ///< and what it turns them by
  Lanes borne[6];            ///< and what each held axis takes of it
};

/// Who tumbles does so in turns of at most so much, if there are not more of them in a substep.
struct Turns {
  Real angle_rad, most;
};

/// The substeps of `count` blocks of `points` points each, or of joints that have `what`.
struct Kernel {
  /// Rows of kLanes movers each: on, by their speeds, for h_s.
  void (*move)(Mover* movers, const Tumblers* tumblers, std::size_t first_row, std::size_t last_row, Real h_s,
               const Turns& turns);
  void (*warm_start)(const Block* blocks, std::size_t count, int points, Mover* movers);
  void (*solve)(Block* blocks, std::size_t count, int points, Mover* movers, const Substep& substep);
  /// Restitution, for what came closer than `threshold_m_s` (below 0).
  void (*bounce)(Block* blocks, std::size_t count, int points, Mover* movers, Real threshold_m_s);
  /// As the bodies are now, for substeps of h_s.
  void (*look_at_joints)(JointBlock* blocks, std::size_t count, unsigned what, const Mover* movers, Real h_s);
  /// What has been pushed in the substep before is forgotten; springs push.
  void (*begin_joints)(JointBlock* blocks, std::size_t count, unsigned what, Mover* movers, Real h_s);
  /// Each axis once.
  void (*solve_joints)(JointBlock* blocks, std::size_t count, unsigned what, Mover* movers);
  /// The first of the `count` points, a multiple of kPointsAtOnce, that is farthest in a direction.
  std::size_t (*farthest_double)(const double* x, const double* y, const double* z, std::size_t count,
                                 const double (&along)[3]);
  std::size_t (*farthest_single)(const float* x, const float* y, const float* z, std::size_t count,
                                 const float (&along)[3]);
};

Kernel kernel_sse2();
Kernel kernel_avx2();
Kernel kernel_avx512();
/// The fastest that this machine can run.
const Kernel& kernel();

}  // namespace aurasim::physics::soft
