// Exchange of movers between coupled regions, before a phase of a sweep.
#pragma once

#include "physics/soft/lanes.h"
#include "physics/soft/seams.h"

namespace aurasim::physics {

class SoftExchange {
 public:
  virtual ~SoftExchange() = default;

  /// Exchanges the movers for a phase. Bodies of other regions are then as their hosts have them. `bounces`: only
  /// contacts that may bounce count.
  virtual void exchange(SoftPhase phase, bool bounces, soft::Mover* movers) = 0;
};

}  // namespace aurasim::physics
