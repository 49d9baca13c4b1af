// Exchange of movers between coupled regions, before a phase of a sweep.
#pragma once

#include "physics/soft/lanes.h"
#include "physics/soft/seams.h"

namespace aurasim::physics {

class SoftExchange {
 public:
  virtual ~SoftExchange() = default;

  /// Exchanges movers before a phase. Bodies of other regions in its contacts are then as their hosts have them. Called
  /// before each phase of a sweep, in order. `bounces`: only contacts that may bounce count.
  virtual void exchange(SoftPhase phase, bool bounces, soft::Mover* movers) = 0;
};

}  // namespace aurasim::physics
