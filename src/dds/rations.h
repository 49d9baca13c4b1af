// Rate limits for one process on topics command (rays, and all the rest) and run_control: more than any page or client
// sends. An operator with keys gets no more: a key may be in wrong hands, and a program out of control.
#pragma once

#include <string>

#include <fmt/format.h>

#include "dds/rate_limit.h"

namespace aurasim::dds {

inline constexpr double kWordsASecond = 500;
inline constexpr double kWordsAtOnce = 1000;

/// Setpoint messages of one program a second: four for each of 240 states.
inline constexpr double kSetpointsASecond = 1000;
inline constexpr double kSetpointsAtOnce = 4000;

/// Setpoint messages allowed in addition for each state that the node computes. A program in lock-step sends one for
/// each state, however fast they are computed.
inline constexpr double kWordsAState = 1;
inline constexpr double kSetpointsAState = 4;

inline std::string words_of_ration() { return fmt::format("{:g} a second, {:g} at once", kWordsASecond, kWordsAtOnce); }

}  // namespace aurasim::dds
