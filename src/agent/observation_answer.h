// The answer with an observed state, as JSON and bytes. client/observation.cpp reads it.
#pragma once

#include "agent/observer.h"
#include "client/message.h"

namespace aurasim::agent {

client::Message observation_message(const Observed& observed, double step_s);

}  // namespace aurasim::agent
