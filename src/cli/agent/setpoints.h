// What clients want of bodies and joints, from their messages.
#pragma once

#include "client/message.h"
#include "core/scene.h"
#include "core/setpoint.h"

namespace aurasim::cli::agent {

/// Throws Problem (kRefused) with what is wrong, then nothing of it acts.
core::Setpoints setpoints_of(const client::Message& message, const core::Scene& scene);

}  // namespace aurasim::cli::agent
