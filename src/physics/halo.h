// What a region tells another before a step: bodies that it hands over, and bodies near the other's blocks (guests
// there).
#pragma once

#include <vector>

#include "core/body_state.h"
#include "physics/parcel.h"

namespace aurasim::physics {

/// A body in the state before the step, with what orders and setpoints of the step have done to it.
struct Visit {
  core::BodyRecord body;
  core::RegionId host{};                                               ///< in this step
  core::Vec3 force = core::Vec3::Zero(), torque = core::Vec3::Zero();  ///< N, N m
};

struct Halo {
  std::vector<Visit> guests;
  /// Bodies for the receiver, with all their contacts, and the visits of the same bodies.
  core::ClusterState for_you;
  std::vector<Visit> arrivals;       ///< in the order of for_you.bodies; only forces count
  std::vector<core::BodyId> broken;  ///< bodies that broke down in the state before the step
};

void write(const Halo& halo, ParcelWriter& parcel);
/// Throws BadParcel.
Halo read_halo(ParcelReader& parcel);

}  // namespace aurasim::physics
