// From a launch file to what nodes, transports and worlds want to know.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "config/launch.h"
#include "dds/control.h"
#include "dds/settings.h"
#include "node/node.h"

namespace aurasim::cli {

/// Nothing for `region`: a process that only watches or steers.
dds::Settings dds_settings(const config::Launch& launch, std::optional<core::RegionId> region = {});
core::AuraRules aura_rules(const config::Launch& launch);
/// How far apart regions may be that listen to each other: as configured, and never less than the reach of an aura.
double listening_distance_m(const config::Launch& launch);
/// Of each node where so many run on this host: as the file says, else its share of the cores.
int threads_of(const config::Launch& launch, std::size_t nodes);
node::NodeSetup node_setup(const config::Launch& launch, core::RegionId region, core::Generation generation);
dds::WorldMap world_map(const config::Launch& launch);

/// Another program of ours, in the folder of the running one. Throws std::runtime_error with the remedy if it is not
/// there.
std::filesystem::path program_beside(const std::string& name, const std::string& remedy);

}  // namespace aurasim::cli
