// Keeps the contacts of two bodies that have hardly moved relative to each other since these were computed. Only the
// distances are updated.
//
// The relative pose then is stored in fields of the contact points that Bullet's solvers use and the soft step does
// not, so a hand-off carries it. m_lateralFrictionDir1: the normal in the frame of B. m_lateralFrictionDir2: the
// position of B in the frame of A. m_contactMotion1, m_contactMotion2, m_frictionCFM: its rotation (x, y, z of the
// quaternion with w >= 0). m_contactERP is 1.
#pragma once

class btPersistentManifold;

namespace aurasim::physics {

/// If the bodies have hardly moved, moves the contacts with them, drops those that have opened, and returns true.
bool keep_contacts(btPersistentManifold& manifold);

/// Stores the relative pose of contacts that have just been computed.
void note_contacts(btPersistentManifold& manifold);

}  // namespace aurasim::physics
