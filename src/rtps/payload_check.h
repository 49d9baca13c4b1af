// Checks the payloads of a participant's built-in writers: discovery, liveliness and handshakes (RTPS 2.2, sections 8.5
// and 9.6; DDS Security 1.1, section 7.4.3). Payloads of user writers are checked by the codecs. Pure.
#pragma once

#include <cstdint>
#include <optional>

#include "rtps/datagram_findings.h"
#include "rtps/parameter_check.h"
#include "rtps/wire_cursor.h"

namespace aurasim::rtps {

/// True for the writers of participant discovery and of handshakes.
bool introduces(std::uint32_t writer);

/// Checks a payload and returns why it is refused; nothing: it is sound. `body` begins with the encapsulation.
/// `destination`: the addressed participant; zeros: all. Adds to `findings.claims` and `findings.introduces`.
std::optional<Refusal> check_payload(std::uint32_t writer, WireCursor& body, const GuidPrefix& destination,
                                     Findings& findings);

/// Adds the claim that a participant or endpoint is gone. For a sample without payload, whose inline QoS names it.
void add_gone(std::uint32_t writer, const ListFindings& inline_qos, const GuidPrefix& destination, Findings& findings);

}  // namespace aurasim::rtps
