// Makes a region's node leave, so that another process takes the region over.
#pragma once

#include "dds/control.h"

namespace aurasim::steering {

/// For users, when the region has been waited for in vain.
inline constexpr const char* kNobodyTakesOver = "nobody has taken the region over: is there a spare, or a launcher?";

class Draining {
 public:
  /// Sends the drain command. Throws SteeringRefused if the region has no live node. `control` must outlive this
  /// object.
  Draining(dds::ControlBus& control, core::RegionId region);

  /// Status of the process that has taken the region over, once the run goes on. Null before.
  const messages::Status* successor();

 private:
  dds::ControlBus& control_;
  core::RegionId region_;
  std::uint64_t leaving_ = 0;
};

}  // namespace aurasim::steering
