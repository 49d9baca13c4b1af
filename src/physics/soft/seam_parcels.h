// Movers, bodies and contacts in the parcels that coupled regions exchange in a soft step (docs/protocol.md, "Coupled
// regions"). Readers throw BadParcel.
#pragma once

#include <cstddef>
#include <cstdint>

#include "physics/parcel.h"
#include "physics/soft/lanes.h"
#include "physics/soft/touch.h"

class btRigidBody;

namespace aurasim::physics {

/// A mover has 13 numbers in a parcel.
inline constexpr std::size_t kRowBytes = 13 * sizeof(soft::Real);
inline constexpr std::size_t kBodyBytes = 8 + 1 + 1 + 13 * sizeof(soft::Real);
inline constexpr std::size_t kLeastPatchBytes = 8 + 8 + 8 + 1 + 13 * sizeof(soft::Real) + 1;

void write_row(const soft::Mover& mover, ParcelWriter& parcel);
void read_row(soft::Mover& mover, ParcelReader& parcel);

/// Writes all of a patch but what names its bodies.
void write_patch(const SoftPatch& patch, ParcelWriter& parcel);
SoftPatch read_patch(ParcelReader& parcel);

/// Writes the id of a body, whether it moves in the step, the phases (as bits) in which it has contacts that the
/// receiver does not solve, its inverse mass and inertia, and its velocities.
void write_body(const btRigidBody& body, bool moves, std::uint8_t elsewhere, ParcelWriter& parcel);

/// Writes the impulses that the step has left in the points of a touch.
void write_impulses(const SoftTouch& touch, ParcelWriter& parcel);
/// Sets the impulses of a touch that has the same points.
void read_impulses(ParcelReader& parcel, const SoftTouch& touch);

}  // namespace aurasim::physics
