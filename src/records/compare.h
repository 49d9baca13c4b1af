// Two reports of the same scene, side by side: are they the same run, to the last bit, and if not, how far apart?
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "core/ids.h"

namespace aurasim::records {

struct Comparison {
  bool hashes_equal = false;  ///< true if both reports have the same steps from `first_step` on, with equal hashes
  core::Step first_step = 0;  ///< first step of the report that begins later, because it may go on from a saved world
  std::uint64_t steps_compared = 0;
  std::optional<core::Step> first_difference_step;
  std::uint64_t bodies_compared = 0;
  std::uint64_t bodies_in_one_only = 0;
  double max_position_error_m = 0;    ///< in the last state
  double max_rotation_error_rad = 0;  ///< in the last state
};

/// Reads state_hash.csv and the regions' bodies.csv of two reports. Throws std::runtime_error when one has no hashes.
Comparison compare_reports(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace aurasim::records
