// What nodes may say of bodies, contacts and joints: twice what a world bears (core/limits.h), and what its heaviest
// and fastest bodies could do to each other.
#pragma once

#include <cstdint>

#include "core/limits.h"

namespace aurasim::dds::bearable {

inline constexpr double kFarthest_m = 2 * core::limits::kFarthestBody_m;
inline constexpr double kFastest_m_s = 2 * core::limits::kFastestBody_m_s;
inline constexpr double kFastestSpin_rad_s = 2 * core::limits::kFastestSpin_rad_s;
inline constexpr double kFarthestReach_m = 1e9;           ///< of an aura
inline constexpr double kFastestReach_m_s = 1e9;          ///< what a body may come to have
inline constexpr double kLargestOfAContact = 1e15;        ///< m, N s, s: any column
inline constexpr double kLargestOfAnOrder = 1e9;          ///< any number, but for regions, states and ids
inline constexpr std::int64_t kMostStatesToBirth = 4096;  ///< of a body that is announced
inline constexpr std::uint32_t kMostEpochs = 1U << 31U;   ///< how often a body has changed host: so often none has

}  // namespace aurasim::dds::bearable
