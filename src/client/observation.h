// Interests as the agent takes them, and observed states as it tells them (cli/agent/observation_answer.cpp).
#pragma once

#include <aurasim/client.h>

#include "client/message.h"

namespace aurasim::client {

nlohmann::json interest_json(const Interest& interest);
/// Its columns lie one after the other in the message's body. Throws Error if they do not fit.
Observation observation_of(const Message& answer);

}  // namespace aurasim::client
