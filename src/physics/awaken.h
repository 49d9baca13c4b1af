// Waking a body up.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace aurasim::physics {

/// Also a body that had fallen asleep starts anew. One that is never to sleep stays so.
inline void awaken(btRigidBody& body) {
  if (body.getActivationState() == DISABLE_DEACTIVATION || body.getActivationState() == DISABLE_SIMULATION) return;
  body.forceActivationState(ACTIVE_TAG);
  body.setDeactivationTime(0);
}

}  // namespace aurasim::physics
