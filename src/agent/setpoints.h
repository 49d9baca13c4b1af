// Reads clients' setpoints for bodies, joints and statics from their messages.
#pragma once

#include "client/message.h"
#include "config/launch.h"
#include "core/setpoint.h"

namespace aurasim::agent {

/// The setpoints of a message. Throws Problem (kRefused) or steering::BadAsk; then no setpoint takes effect.
core::Setpoints setpoints_of(const client::Message& message, const config::Launch& launch);

}  // namespace aurasim::agent
