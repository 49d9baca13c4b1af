// Settings of nodes, transports and worlds, made from a launch file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "config/launch.h"
#include "dds/control.h"
#include "dds/settings.h"
#include "node/node.h"

namespace aurasim::setup {

/// DDS settings. `region`: empty for a process that only observes or steers.
dds::Settings dds_settings(const config::Launch& launch, std::optional<core::RegionId> region = {});
core::AuraRules aura_rules(const config::Launch& launch);
/// Largest distance of regions that exchange batches, metres: as configured, and never less than the reach of an aura.
double listening_distance_m(const config::Launch& launch);
/// Number of threads of each node when `nodes` run on this host: as in the file, or else its share of the cores that
/// this process may use, but at least 1.
int threads_of(const config::Launch& launch, std::size_t nodes);
physics::Settings physics_settings(const config::Launch& launch);
node::NodeSetup node_setup(const config::Launch& launch, core::RegionId region, core::Generation generation);
messages::WorldMap world_map(const config::Launch& launch);

/// Path of another program of aurasim, in the folder of the running one. Throws std::runtime_error with `remedy` if it
/// is not there.
std::filesystem::path program_beside(const std::string& name, const std::string& remedy);

}  // namespace aurasim::setup
