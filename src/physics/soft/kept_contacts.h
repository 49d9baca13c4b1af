// Who has hardly moved against whom since their contacts were told keeps them, with their present distances.
//
// What is compared with lies in fields of the contact points that Bullet's solvers need and the soft step does not, so
// a hand-off carries it: in m_lateralFrictionDir1 the normal, in the frame of B; in m_lateralFrictionDir2 where B was
// in the frame of A, in m_contactMotion1, m_contactMotion2 and m_frictionCFM its rotation (x, y, z of the quaternion
// with w >= 0); m_contactERP is 1.
#pragma once

class btPersistentManifold;

namespace aurasim::physics {

/// If the bodies have hardly moved, moves the contacts with them, drops those that have opened, and returns true.
bool keep_contacts(btPersistentManifold& manifold);

/// Of contacts just told.
void note_contacts(btPersistentManifold& manifold);

}  // namespace aurasim::physics
