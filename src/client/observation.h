// Converts interests to the agent's form, and its answers to observations (agent/observation_answer.cpp).
#pragma once

#include <aurasim/client.h>

#include "client/message.h"

namespace aurasim::client {

nlohmann::json interest_json(const Interest& interest);
/// Reads an observation, whose columns lie one after the other in the message's body. Throws Error if they do not fit.
Observation observation_of(const Message& answer);

}  // namespace aurasim::client
