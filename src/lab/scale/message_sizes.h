// How many bytes messages take on the wire, by what is in them.
#pragma once

#include <nlohmann/json.hpp>

namespace aurasim::lab {

/// Bytes of serialised payloads: `aura_batch` (empty), `aura_update` by aura kind, `aura_delete`, `hand_off_body`,
/// `hand_off_contact_point`, `hand_off` (empty), `ack`. What is added is the difference of two messages.
nlohmann::json message_sizes();

}  // namespace aurasim::lab
