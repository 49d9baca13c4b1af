// What clients ask of a world, from JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "cli/command_client.h"
#include "core/command.h"

namespace aurasim::cli::agent {

/// Gives meshes to the nodes. Throws Problem (kRefused) with what is wrong.
core::Ask ask_of(const nlohmann::json& json, const core::Scene& scene, CommandClient& client);

/// "static": its number, or the name that the scene gives it. Throws Problem.
core::StaticId static_of(const nlohmann::json& json, const core::Scene& scene);
/// "p", m, and "q", a quaternion w x y z of any length. Throws Problem.
core::Pose pose_of(const nlohmann::json& json);
/// "name", of a saved world. Throws Problem.
std::string save_name_of(const nlohmann::json& json);
/// Three numbers, all finite. Throws Problem.
core::Vec3 vector_of(const nlohmann::json& json, const char* key);

}  // namespace aurasim::cli::agent
