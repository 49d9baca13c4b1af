// Times of sending of one writer's samples: each later than the one before, whatever the wall clock does.
#pragma once

#include <algorithm>
#include <cstdint>

namespace aurasim::dds {

/// Fast DDS 2.9.1 sorts what a reader has received of one writer by number, and of two writers by time of sending
/// (ChangeComparison.hpp). If the times of a writer do not rise with its numbers, this is no order: A1 < A2 by number,
/// A2 < B < A1 by time. A sample then lands before one with a lower number, is not reported, but can be taken, and the
/// next one of its key ends the process by an assertion (DataReaderInstance::update_state). Equal times would do so,
/// too.
class RisingTime {
 public:
  /// Time of a sample that is sent now: nanoseconds since 1970.
  std::int64_t next(std::int64_t wall_ns) {
    last_ns_ = std::max(wall_ns, last_ns_ + kStep_ns);
    return last_ns_;
  }

 private:
  static constexpr std::int64_t kStep_ns = 1000;  ///< more than what rounding on the wire takes away

  std::int64_t last_ns_ = 0;
};

}  // namespace aurasim::dds
