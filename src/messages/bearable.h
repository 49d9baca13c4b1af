// Limits of the quantities that messages may carry for bodies, contacts and joints: twice the limits of a world
// (core/limits.h), and what its heaviest and fastest bodies could do to each other. Messages beyond them are refused.
#pragma once

#include <cstdint>

#include "core/limits.h"

namespace aurasim::messages::bearable {

inline constexpr double kFarthest_m = 2 * core::limits::kFarthestBody_m;
inline constexpr double kFastest_m_s = 2 * core::limits::kFastestBody_m_s;
inline constexpr double kFastestSpin_rad_s = 2 * core::limits::kFastestSpin_rad_s;
inline constexpr double kFarthestReach_m = 1e9;           ///< farthest reach of an aura
inline constexpr double kFastestReach_m_s = 1e9;          ///< highest speed that an aura may allow for
inline constexpr double kLargestOfAContact = 1e15;        ///< any column of a contact: m, N s or s
inline constexpr double kLargestOfAnOrder = 1e9;          ///< any number in an order except regions, states and ids
inline constexpr std::int64_t kMostStatesToBirth = 4096;  ///< states until an announced body is born
inline constexpr std::uint32_t kMostEpochs = 1U << 31U;   ///< limit of a body's epoch; no real body reaches it

}  // namespace aurasim::messages::bearable
