// Sizes of messages on the wire, by their contents.
#pragma once

#include <nlohmann/json.hpp>

namespace aurasim::lab {

/// Bytes of serialised payloads: `aura_batch` (empty), `aura_update` by aura kind, `aura_delete`, `hand_off_body`,
/// `hand_off_contact_point`, `hand_off` (empty), `ack`. The size of an element is the difference between two messages
/// with different numbers of it.
nlohmann::json message_sizes();

}  // namespace aurasim::lab
