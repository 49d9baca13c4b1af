// Encodes what the check of states needs (core/state_check.h) as the alarm_* and past_* columns of an AuraBatch.
#pragma once

#include <optional>

#include "core/messages.h"
#include "messages/wire_error.h"

namespace aurasim::wire {
class AuraBatch;
}

namespace aurasim::messages {

void encode_checks(const core::AuraBatch& batch, wire::AuraBatch& out);
std::optional<WireError> check_checks(const wire::AuraBatch& in, const Expected& expected);
/// Precondition: check_checks has found nothing wrong with the columns.
void decode_checks(const wire::AuraBatch& in, core::AuraBatch& batch);

}  // namespace aurasim::messages
