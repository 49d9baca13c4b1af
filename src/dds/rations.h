// How much one process may ask of a run, on command (rays, and all the rest) and on run_control: more than any page or
// client sends. With keys an operator has no more: a key may be in wrong hands, and a program out of hand.
#pragma once

#include <string>

#include <fmt/format.h>

#include "dds/rate_limit.h"

namespace aurasim::dds {

inline constexpr double kWordsASecond = 500;
inline constexpr double kWordsAtOnce = 1000;

/// Of setpoints, by one program: four messages for each of 240 states a second.
inline constexpr double kSetpointsASecond = 1000;
inline constexpr double kSetpointsAtOnce = 4000;

/// Besides, for each state that the node computes: a program in lock-step says so much for each, however fast they are.
inline constexpr double kWordsAState = 1;
inline constexpr double kSetpointsAState = 4;

inline std::string words_of_ration() { return fmt::format("{:g} a second, {:g} at once", kWordsASecond, kWordsAtOnce); }

}  // namespace aurasim::dds
