// What clients want of bodies, joints and statics, from their messages.
#pragma once

#include "client/message.h"
#include "config/launch.h"
#include "core/setpoint.h"

namespace aurasim::cli::agent {

/// Throws Problem (kRefused) with what is wrong, then nothing of it acts.
core::Setpoints setpoints_of(const client::Message& message, const config::Launch& launch);

}  // namespace aurasim::cli::agent
