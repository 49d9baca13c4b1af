// Answers to a client, as JSON and bytes. client/answers.cpp reads them.
#pragma once

#include "agent/run_link.h"
#include "client/message.h"

namespace aurasim::agent {

client::Message state_message(const WorldState& state, double step_s);
nlohmann::json nodes_json(const std::map<core::RegionId, messages::SeenStatus>& nodes);
nlohmann::json info_json(const RunLink& run);
/// Answer for any command but a ray or a save. It has a key `refused` if the command was not executed. Throws Problem
/// if no reply says why.
nlohmann::json act_json(const steering::Delivery& delivery);
/// Answers for rays and saves. Throw Problem if the command was not executed.
nlohmann::json ray_json(const steering::Delivery& delivery);
/// Also joins the parts into one file in their folder.
nlohmann::json save_json(const steering::Delivery& delivery, const std::string& name);

}  // namespace aurasim::agent
