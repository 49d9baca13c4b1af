// Packet loss (thesis section 5.2.5): 0 to 20% of the datagrams, everything else at its tolerance.
#pragma once

#include "lab/collision.h"

namespace aurasim::lab {

Campaign loss_campaign(const CollisionPlan& plan);

}  // namespace aurasim::lab
