// Wakes bodies up.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/moving_body.h"

namespace aurasim::physics {

/// Makes a body active and restarts its time below the sleeping thresholds. Bodies that never sleep and disabled bodies
/// stay as they are.
inline void awaken(btRigidBody& body) {
  if (body.getActivationState() == DISABLE_DEACTIVATION || body.getActivationState() == DISABLE_SIMULATION) return;
  body.forceActivationState(ACTIVE_TAG);
  body.setDeactivationTime(0);
  note_change(body);
}

}  // namespace aurasim::physics
