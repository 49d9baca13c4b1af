// The contact cache, what Bullet remembers of a contact, as rows of numbers. The conversion is exact both ways, so a
// contact goes on in another world with the same bits.
//
// Columns of one row (world frame, metres, newton seconds; A is the manifold's body0, B its body1):
//    0- 2  point on A in A's frame                28  applied impulse, along the normal
//    3- 5  point on B in B's frame                29  right-hand side of the last solve
//    6- 8  point on B                             30  slip, m, along the first of two directions
//    9-11  point on A                             31  slip along the second (friction_anchors.h)
//   12-14  normal on B, towards A                 32  contact motion, first lateral direction
//   15-17  first lateral direction of friction    33  contact motion, second lateral direction
//   18-20  second lateral direction               34  constraint force mixing (or contact stiffness)
//   21     distance, negative: overlap            35  error reduction (or contact damping)
//   22     friction of the two materials          36  constraint force mixing of friction
//   23     rolling friction                       37  part of A: of a mesh, or feature (whole_manifold.h); -1
//   24     spinning friction                      38  part of B
//   25     restitution                            39  index in A: child of a compound, triangle of a mesh, or -1
//   26     contact flags                          40  index in B
//   27     age in substeps
#pragma once

#include <span>
#include <vector>

#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>

#include "core/body_state.h"
#include "physics/parts.h"

class btCollisionObject;
class btPersistentManifold;
struct btBroadphasePair;

namespace aurasim::physics {

/// Columns of a row.
inline constexpr std::size_t kLocalPointA = 0;
inline constexpr std::size_t kLocalPointB = 3;

/// `row` has core::kContactPointDoubles numbers.
void write_point(const btManifoldPoint& point, double* row);
btManifoldPoint read_point(const double* row);

/// The parts of a manifold with at least one point.
Parts parts_of(const btPersistentManifold& manifold);
/// Like parts_of(manifold), from the row of its first point. `compound0`, `compound1`: whether each body is a compound.
Parts parts_of(const double* row, bool compound0, bool compound1);

struct PartManifold {
  btPersistentManifold* manifold = nullptr;
  Parts parts;
};

/// Sets `result` to all manifolds of a pair, empty ones too, in the order of its children. A pair of compounds has one
/// for each pair of children whose bounds overlap.
void collect_manifolds(const btBroadphasePair& pair, std::vector<PartManifold>& result);

/// Adds points to the manifold of these parts with this first body; there need not be one. `rows`: as many as points.
/// Returns the manifold, or null.
btPersistentManifold* restore_points(std::span<const PartManifold> made, const btCollisionObject& body0, Parts parts,
                                     std::span<const double> rows);

}  // namespace aurasim::physics
