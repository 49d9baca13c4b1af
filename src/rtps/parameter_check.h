// Checks parameter lists (RTPS 2.2, section 9.4.2.11): inline QoS, and the lists by which discovery describes
// participants and endpoints.
#pragma once

#include <cstdint>
#include <optional>

#include "rtps/datagram_findings.h"
#include "rtps/wire_cursor.h"

namespace aurasim::rtps {

enum class ListKind : std::uint8_t { kInlineQos, kInlineQosOfSamples, kParticipant, kEndpoint };

/// Content of a list that later checks need.
struct ListFindings {
  std::optional<WireGuid> subject;  ///< participant or endpoint that the list describes
  double lease_s = 0;               ///< lease of the participant
  bool gone = false;                ///< the subject is disposed of or unregistered
};

/// Checks a list and reads up to and including its end. Returns why it is refused; nothing: it is sound. Adds to
/// `findings.hidden_parameters`.
std::optional<Refusal> check_parameters(WireCursor& cursor, ListKind kind, ListFindings& list, Findings& findings);

/// Reads a token of DDS Security: a class, and properties with text and octets. Returns whether it is well-formed.
bool is_data_holder(WireCursor& cursor);
/// Reads a string: length, text without zeros, a final zero. `most`: largest length. Returns whether it is well-formed.
bool is_string(WireCursor& cursor, std::size_t most);

}  // namespace aurasim::rtps
