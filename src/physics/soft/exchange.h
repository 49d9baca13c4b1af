// Exchange of movers between coupled regions, before a phase of a sweep.
#pragma once

#include "physics/soft/lanes.h"
#include "physics/soft/seams.h"

namespace aurasim::physics {

class SoftExchange {
 public:
  virtual ~SoftExchange() = default;

  /// Sends the movers that other regions need for a phase of a sweep. `bounces`: only contacts that may bounce count.
  virtual void post(SoftPhase phase, bool bounces, const soft::Mover* movers) = 0;
  /// Waits for those of other regions. Bodies of theirs in the phase's contacts are then as their hosts have them.
  virtual void fetch(SoftPhase phase, bool bounces, soft::Mover* movers) = 0;
};

}  // namespace aurasim::physics
