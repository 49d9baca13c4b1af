// Parameter lists (RTPS 2.2, section 9.4.2.11): inline QoS, and what discovery says of participants and endpoints.
#pragma once

#include <cstdint>
#include <optional>

#include "dds/datagram_findings.h"
#include "dds/wire_cursor.h"

namespace aurasim::dds {

enum class ListKind : std::uint8_t { kInlineQos, kInlineQosOfSamples, kParticipant, kEndpoint };

/// What a list says of its subject.
struct ListFindings {
  std::optional<WireGuid> subject;  ///< participant or endpoint
  double lease_s = 0;               ///< of a participant
  bool gone = false;                ///< disposed of or unregistered
};

/// Reads up to and including the end of the list. Adds to `findings.hidden_parameters`.
std::optional<Refusal> check_parameters(WireCursor& cursor, ListKind kind, ListFindings& list, Findings& findings);

/// A token of DDS Security: a class, and properties with text and octets.
bool is_data_holder(WireCursor& cursor);
/// Length, text without zeros, a zero.
bool is_string(WireCursor& cursor, std::size_t most);

}  // namespace aurasim::dds
