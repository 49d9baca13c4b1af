// What a client is told, as JSON and bytes; client/answers.cpp reads it.
#pragma once

#include "cli/agent/run_link.h"
#include "client/message.h"

namespace aurasim::cli::agent {

client::Message state_message(const WorldState& state, double step_s);
nlohmann::json nodes_json(const std::map<core::RegionId, dds::SeenStatus>& nodes);
nlohmann::json info_json(const RunLink& run);
/// Of anything but a ray or a saved world; with a key `refused` if it is not done. Throws Problem if nobody has said
/// why it is not.
nlohmann::json act_json(const Delivery& delivery);
/// Throw Problem if it is not done.
nlohmann::json ray_json(const Delivery& delivery);
/// Makes one file of its parts, beside them.
nlohmann::json save_json(const Delivery& delivery, const std::string& name);

}  // namespace aurasim::cli::agent
