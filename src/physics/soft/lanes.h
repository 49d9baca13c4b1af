// The data of the soft step (soft/step.h), laid out for so many patches or joints at a time, and its arithmetic, which
// is compiled once for each set of instructions. Lanes never mix, and no operation is contracted or reordered. So
// neither the number of lanes nor the set of instructions changes a bit.
#pragma once

#include <cstddef>
#include <cstdint>

namespace aurasim::physics::soft {

// No other header may be included here or in soft/kernel*.h: an inline function from elsewhere would exist once for all
// sets.

/// Single precision, also where bodies use double: the kernels compute only changes of pose and velocity since the
/// start of the step.
using Real = float;
inline constexpr int kLanes = 32 / sizeof(Real);
using Lanes __attribute__((vector_size(32))) = Real;

inline constexpr int kMostPoints = 4;
inline constexpr std::size_t kPointsAtOnce = 16;  ///< points of a hull that are searched at once

/// State of a body in the substeps, in two halves: velocities, and the motion since the start of the step.
struct alignas(64) Mover {
  Real v[3] = {}, w[3] = {};  ///< m/s, rad/s
  Real unused[2] = {};
  Real dp[3] = {};            ///< displacement since the start of the step, m
  Real dq[4] = {0, 0, 0, 1};  ///< rotation since the start of the step; x, y, z, w
};

/// Inertia of kLanes movers in a row of which some tumble: their spin changes while nothing acts on them.
struct alignas(64) Tumblers {
  Lanes start[4];        ///< x, y, z, w: the body's frame at the start of the step
  Lanes inertia[3];      ///< about the body's axes, kg m^2; 0: it turns evenly
  Lanes inv_inertia[3];  ///< 1/(kg m^2); 0: it turns evenly
  bool any;              ///< some mover of the row tumbles
};

struct Substep {
  Real per_s = 0;         ///< 1 / length of the substep
  Real top_push_m_s = 0;  ///< highest speed at which overlaps are pushed apart
  bool pushes = false;    ///< true: springs push overlaps apart; false: contacts are rigid and have friction
};

/// Patches (contact points of two bodies with one normal) of kLanes pairs of bodies. No two lanes share a body that
/// moves.
struct alignas(64) Block {
  struct Point {
    Lanes r_a[3], r_b[3];         ///< the point from the centres of mass, at the start of the step, m
    Lanes gap;                    ///< distance at the start of the step, m; negative: overlap
    Lanes mass;                   ///< effective mass along the normal, kg
    Lanes impulse, most_impulse;  ///< N s; most_impulse: the largest of any substep
    Lanes approach;               ///< speed along the normal at the start of the step, m/s; negative: approaching
  };

  std::int32_t a[kLanes], b[kLanes];         ///< movers; 0 never moves, negative: moving statics
  Lanes inv_mass_a, inv_mass_b;              ///< 1/kg
  Lanes inv_inertia_a[6], inv_inertia_b[6];  ///< xx, xy, xz, yy, yz, zz, world frame
  Lanes normal[3], first[3], second[3];      ///< normal from a to b; the two directions of friction
  Lanes belt_1, belt_2;                      ///< speed of b's surface relative to a's by belts, m/s
  Lanes rate_per_s;                          ///< share of the overlap that springs undo, 1/s
  Lanes soft_mass, soft_impulse;  ///< share of a rigid contact's impulse; share of the impulse that the spring yields
  Lanes friction, restitution;
  Lanes spinning_m, rolling_m;  ///< spinning and rolling friction
  Point points[kMostPoints];
  Lanes centre_a[3], centre_b[3];   ///< centre of the points, where friction acts, m
  Lanes lever_m;                    ///< mean distance of the points from the centre, m
  Lanes mass_11, mass_12, mass_22;  ///< effective mass of friction, kg
  Lanes mass_twist, mass_roll[6];   ///< kg m^2
  Lanes rub_1, rub_2;               ///< impulses of friction, N s
  Lanes twist, roll[3];             ///< N m s
};

/// Bits of the features of a joint: axes that are held or limited, axes with springs (one bit for each axis), and a
/// motor about the last axis.
inline constexpr unsigned kHeldAxis = 1, kSpringAxis = 1 << 6, kJointMotor = 1 << 12;
/// Bits of features along the free axis of a hinge (the last axis) or slider (the third): a drive, a spring with
/// damper, friction. kSlides: it is a slider. kWholeTurns: whole turns of a hinge count. kDampedBall: a ball joint with
/// damping.
inline constexpr unsigned kJointDrive = 1 << 13, kJointSpring = 1 << 14, kJointFriction = 1 << 15;
inline constexpr unsigned kSlides = 1 << 16, kWholeTurns = 1 << 17, kDampedBall = 1 << 18;

/// kHeldShifts: the three translations are held, and solved together.
inline constexpr unsigned kHeldShifts = 1 << 19;

/// Joints of kLanes pairs of bodies. No two lanes share a body that moves. Coordinates are those of J of a relative to
/// J of b: translations along the axes of b's J, m, then angles of turns about x, then y, then z, each about the axis
/// as turned by then, rad. Directions are in the world frame.
struct alignas(64) JointBlock {
  struct Axis {
    Lanes low, high;           ///< limits, m or rad; equal: the axis is held
    Lanes stiffness, damping;  ///< N/m and N s/m, or N m/rad and N m s/rad
    Lanes rest;                ///< rest position of the spring, m or rad
    Lanes impulse;             ///< impulse in this substep so far, N s or N m s
    // For the present poses of the bodies:
    Lanes x;            ///< m or rad
    Lanes n[3];         ///< direction along or about which an impulse acts
    Lanes mass;         ///< kg or kg m^2
    Lanes wanted;       ///< wanted speed of a relative to b, m/s or rad/s
    Lanes least, most;  ///< bounds of the impulse
  };

  /// An ImplicitPull (physics/joint_axes.h): impulse = pull - give * speed.
  struct Pull {
    Lanes position, drift, stiffness, steady, give, most;
    Lanes pull;     ///< N s or N m s
    Lanes impulse;  ///< impulse in this substep so far
  };

  std::int32_t a[kLanes], b[kLanes];             ///< movers; 0 never moves
  Lanes inv_mass_a, inv_mass_b;                  ///< 1/kg
  Lanes start_inertia_a[6], start_inertia_b[6];  ///< inverse inertia as in Block, at the start of the step
  Lanes r_a[3], r_b[3];                          ///< J in a and b from the centres of mass, at the start of the step, m
  Lanes frame_a[3][3], frame_b[3][3];            ///< axes of J in a and b at the start of the step
  Lanes apart[3];                                ///< J in a from J in b at the start of the step, m
  Lanes motor_rad_s, motor_impulse;              ///< target speed of a; most impulse, N m s in a substep
  Lanes breaks;                                  ///< break impulse in a substep, N s or N m s
  Lanes took;                                    ///< largest impulse of the substeps before
  Lanes whole;                                   ///< 1: whole; 0: broken
  Lanes motor_took;                              ///< impulse of the motor in this substep so far, N m s
  Axis axes[6];
  // For the present poses of the bodies:
  Lanes inv_inertia_a[6], inv_inertia_b[6];
  Lanes arm_a[3], arm_b[3];  ///< where impulses act, from the centres of mass, m
  Lanes shift_mass[6];       ///< effective mass of the three translations together, as inertia in Block, kg

  // For the free axis:
  Pull drive, spring;
  Lanes friction, rubbed;    ///< friction impulse, N s or N m s: the most in a substep, and in this one so far
  Lanes ball_give;           ///< N m s^2/rad
  Lanes own_mass;            ///< effective mass along the free axis with the held axes held, kg or kg m^2
  Lanes own_push[3];         ///< linear impulse on a, and opposite on b, for an impulse of 1
  Lanes own_a[3], own_b[3];  ///< angular impulses on a, and opposite on b, for an impulse of 1
  Lanes borne[6];            ///< share of it that each held axis bears
};

/// Tumbling bodies turn by at most angle_rad at a time, in at most `most` turns a substep.
struct Turns {
  Real angle_rad, most;
};

/// The functions of one set of instructions. They act on `count` blocks of patches with `points` points each, or of
/// joints with the features `what`.
struct Kernel {
  /// Moves rows of kLanes movers by their speeds for h_s.
  void (*move)(Mover* movers, const Tumblers* tumblers, std::size_t first_row, std::size_t last_row, Real h_s,
               const Turns& turns);
  void (*warm_start)(const Block* blocks, std::size_t count, int points, Mover* movers);
  void (*solve)(Block* blocks, std::size_t count, int points, Mover* movers, const Substep& substep);
  /// Applies restitution to points that approached faster than `threshold_m_s`.
  void (*bounce)(Block* blocks, std::size_t count, int points, Mover* movers, Real threshold_m_s);
  /// Updates joints to the present poses, for substeps of h_s.
  void (*look_at_joints)(JointBlock* blocks, std::size_t count, unsigned what, const Mover* movers, Real h_s);
  /// Starts a substep: clears the impulses of the one before, and applies springs.
  void (*begin_joints)(JointBlock* blocks, std::size_t count, unsigned what, Mover* movers, Real h_s);
  /// Solves each axis of the joints once.
  void (*solve_joints)(JointBlock* blocks, std::size_t count, unsigned what, Mover* movers);
  /// Index of the farthest of `count` points in the direction `along`; the first one of several. `count` is a multiple
  /// of kPointsAtOnce.
  std::size_t (*farthest_double)(const double* x, const double* y, const double* z, std::size_t count,
                                 const double (&along)[3]);
  std::size_t (*farthest_single)(const float* x, const float* y, const float* z, std::size_t count,
                                 const float (&along)[3]);
  /// Writes the products of `count` points with `along`, and lowers `bounds` to them. Returns the index of the highest
  /// bound; the first one of several. `count` is a multiple of kPointsAtOnce. No bound may be NaN.
  std::size_t (*tighten)(const double* x, const double* y, const double* z, std::size_t count, const double (&along)[3],
                         double* products, double* bounds);
  /// The least and the largest product of `count` points with `along`. `count` is a multiple of kPointsAtOnce.
  void (*reach)(const double* x, const double* y, const double* z, std::size_t count, const double (&along)[3],
                double (&ends)[2]);
};

Kernel kernel_sse2();
Kernel kernel_avx2();
Kernel kernel_avx512();
/// The kernel of the best set of instructions that this machine has.
const Kernel& kernel();

}  // namespace aurasim::physics::soft
