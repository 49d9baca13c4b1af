// Whether a datagram is RTPS of the form that a run's peers send. Debian's Fast DDS 2.9.1 takes much of a datagram on
// trust: some lengths end the process, some numbers make it count for minutes. What can be verified from the bytes
// alone is verified here, before Fast DDS sees them; what takes a memory is returned as claims for datagram_guard.h.
// Pure; knows nothing of Fast DDS. The form: OMG DDSI-RTPS 2.2, sections 8.3 and 9.4; DDS Security 1.1, section 7.3.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "dds/datagram_findings.h"

namespace aurasim::dds {

/// Nothing: Fast DDS may see the first `findings.size` bytes, once `findings.hide` has been called on them.
std::optional<Refusal> check_datagram(std::span<const std::uint8_t> bytes, Findings& findings);

}  // namespace aurasim::dds
