// What clients ask of a world, from JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "cli/command_client.h"
#include "core/command.h"

namespace aurasim::cli::agent {

/// Gives meshes to the nodes. Throws Problem (kRefused) with what is wrong.
core::Ask ask_of(const nlohmann::json& json, const core::Scene& scene, CommandClient& client);

/// Three numbers, all finite. Throws Problem.
core::Vec3 vector_of(const nlohmann::json& json, const char* key);

}  // namespace aurasim::cli::agent
