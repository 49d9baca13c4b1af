// What the built-in writers of a participant say: discovery, liveliness and handshakes (RTPS 2.2, sections 8.5 and 9.6;
// DDS Security 1.1, section 7.4.3). What a user's writer says is the codecs' to check. Pure.
#pragma once

#include <cstdint>
#include <optional>

#include "dds/datagram_findings.h"
#include "dds/parameter_check.h"
#include "dds/wire_cursor.h"

namespace aurasim::dds {

/// Of discovery of participants and of handshakes.
bool introduces(std::uint32_t writer);

/// `body` begins with the encapsulation. `destination`: the participant that it is for; zeros: all. Adds to
/// `findings.claims` and `findings.introduces`.
std::optional<Refusal> check_payload(std::uint32_t writer, WireCursor& body, const GuidPrefix& destination,
                                     Findings& findings);

/// There is no payload: inline QoS says what is gone.
void add_gone(std::uint32_t writer, const ListFindings& inline_qos, const GuidPrefix& destination, Findings& findings);

}  // namespace aurasim::dds
