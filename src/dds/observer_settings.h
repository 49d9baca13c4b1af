#pragma once

#include <cstdint>

namespace aurasim::dds {

/// Identity of the run that an observer watches. Replicas of other runs are refused and counted.
struct ObserverSettings {
  std::uint64_t map_version = 0;
  std::uint32_t region_count = 0;
  std::uint32_t prototype_count = 0;

  bool operator==(const ObserverSettings&) const = default;
};

}  // namespace aurasim::dds
