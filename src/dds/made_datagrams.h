// Datagrams that the guard puts together in place of what came.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dds/datagram_findings.h"

namespace aurasim::dds {

/// What the writer of `claim` would have sent had it not been too large: one sample. `header` is of the datagram that
/// the claim was found in.
std::vector<std::uint8_t> datagram_of_data(const Claim& claim, std::span<const std::uint8_t> header,
                                           std::span<const std::uint8_t> payload);
/// A gap that has no bits.
std::vector<std::uint8_t> datagram_of_gap(const Claim& claim, std::span<const std::uint8_t> header);

}  // namespace aurasim::dds
