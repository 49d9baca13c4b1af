// A region's node leaves, and another process takes the region over.
#pragma once

#include "dds/control.h"

namespace aurasim::cli {

class Drain {
 public:
  /// Asks for it. Throws SteeringRefused if the region has no node that is alive. `control` outlives it.
  Drain(dds::ControlBus& control, core::RegionId region);

  /// What the process says that computes the region now, once nobody waits any more; null: not yet.
  const dds::Status* successor();

 private:
  dds::ControlBus& control_;
  core::RegionId region_;
  std::uint64_t leaving_ = 0;
};

}  // namespace aurasim::cli
