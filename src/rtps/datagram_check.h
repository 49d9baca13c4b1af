// Checks whether a datagram is RTPS of the form that a run's peers send. Debian's Fast DDS 2.9.1 trusts much of a
// datagram: some lengths end the process, some numbers make it count for minutes. This check verifies what follows from
// the bytes alone, before Fast DDS sees them. What can only be judged from earlier datagrams is returned as claims, for
// datagram_guard.h. Pure; knows nothing of Fast DDS. The form: OMG DDSI-RTPS 2.2, sections 8.3 and 9.4; DDS Security
// 1.1, section 7.3.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "rtps/datagram_findings.h"

namespace aurasim::rtps {

/// Returns why the datagram is refused. Nothing: Fast DDS may see its first `findings.size` bytes, after
/// `findings.hide` has been called on them.
std::optional<Refusal> check_datagram(std::span<const std::uint8_t> bytes, Findings& findings);

}  // namespace aurasim::rtps
