// Converts the agent's answers to the library's types.
#pragma once

#include <aurasim/client.h>

#include "client/columns.h"
#include "client/message.h"

namespace aurasim::client {

/// Reads the bodies of an answer, whose columns lie one after the other in the message's body. Throws Error if they do
/// not fit.
Bodies bodies_of(const Message& answer);
/// Reads the bodies of an answer from `columns`, where other columns may follow. Throws Error if they do not fit.
void take_bodies(const Message& answer, Columns& columns, Bodies& bodies);
RunInfo info_of(const nlohmann::json& head);
std::vector<NodeStatus> nodes_of(const nlohmann::json& head);
Acknowledgement acknowledgement_of(const nlohmann::json& head);
RayHit ray_hit_of(const nlohmann::json& head);
SavedWorld saved_world_of(const nlohmann::json& head);

/// Converts a box. A side that is null is infinite, because JSON has no infinite numbers.
std::vector<double> box_of(const nlohmann::json& json);

}  // namespace aurasim::client
