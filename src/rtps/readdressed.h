// Makes a datagram that was sent to one participant one for everybody.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rtps/datagram_findings.h"

namespace aurasim::rtps {

/// Returns the datagram with the receiver's prefix replaced by zeros (everybody) in each INFO_DST submessage. Nothing:
/// it is no sound sequence of submessages.
std::optional<std::vector<std::uint8_t>> for_everybody(std::span<const std::uint8_t> datagram);

/// Prefix of the participant that sent the datagram; zeros if it is too short.
GuidPrefix sender_of(std::span<const std::uint8_t> datagram);

}  // namespace aurasim::rtps
