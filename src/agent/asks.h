// Reads clients' commands from JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "core/command.h"
#include "steering/command_client.h"

namespace aurasim::agent {

/// The command in `json`; also sends its meshes to the nodes. Throws Problem (kRefused) with the error.
core::Ask ask_of(const nlohmann::json& json, const core::Scene& scene, steering::CommandClient& client);

/// The static that key "static" gives by number or by its name in the scene. Throws Problem.
core::StaticId static_of(const nlohmann::json& json, const core::Scene& scene);
/// The pose in keys "p" (metres) and "q" (a quaternion w x y z of any length). Throws Problem.
core::Pose pose_of(const nlohmann::json& json);
/// The name of a saved world in key "name". Throws Problem.
std::string save_name_of(const nlohmann::json& json);
/// Three finite numbers in key `key`. Throws Problem.
core::Vec3 vector_of(const nlohmann::json& json, const char* key);

}  // namespace aurasim::agent
