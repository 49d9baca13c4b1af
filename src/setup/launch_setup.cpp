#include "setup/launch_setup.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "core/horizon.h"
#include "core/make_aura.h"
#include "physics/soft/threads.h"
#include "physics/solver_names.h"
#include "records/setpoint_record.h"

namespace aurasim::setup {

dds::Settings dds_settings(const config::Launch& launch, std::optional<core::RegionId> region) {
  dds::Settings settings;
  settings.domain = static_cast<std::uint32_t>(launch.dds.domain);
  settings.profiles = launch.dds.profiles;
  settings.interfaces = launch.dds.interfaces;
  settings.peers = launch.dds.peers;
  settings.hub = launch.dds.hub;
  const config::Impair& impair = launch.dds.impair;
  settings.impairment = {impair.delay_s, impair.jitter_s,  impair.loss, impair.bandwidth_B_s,
                         impair.reorder, impair.discovery, impair.seed};
  settings.impairment_stream = region ? core::value_of(*region) + std::uint64_t{1} : 0;
  settings.discovery = launch.dds.discovery;
  settings.nodes = launch.regions.size();
  return settings;
}

core::AuraRules aura_rules(const config::Launch& launch) {
  core::AuraRules rules;
  rules.kind = launch.aura.radius;
  rules.step_s = launch.step_s();
  rules.substeps = launch.time.substeps;
  rules.looks_once = launch.physics.looks_once();
  rules.lookahead = launch.lookahead();
  rules.top_speed_m_s = launch.tolerances.speed_m_s;
  rules.frame_s = launch.tolerances.frame_s;
  rules.latency_s = launch.tolerances.latency_s;
  rules.uncertainty = launch.uncertainty();
  rules.gravity = launch.scene.gravity;
  rules.sweeps = launch.physics.is_continuous();
  rules.redo = launch.redoes();
  if (launch.is_coupled()) rules.kind = core::AuraKind::kNone;  // nobody publishes any
  return rules;
}

double listening_distance_m(const config::Launch& launch) {
  double radius = 0;
  for (const core::Prototype& prototype : launch.scene.prototypes) {
    radius = std::max(radius, core::bounding_radius(launch.scene.shapes[prototype.shape].shape));
  }
  const core::NoShapes no_shapes;
  const double zone_m = core::make_aura(aura_rules(launch), no_shapes)->listening_distance_m(radius);
  return std::max(launch.neighbour_distance_m, zone_m);
}

int threads_of(const config::Launch& launch, std::size_t nodes) {
  const std::size_t share = static_cast<std::size_t>(physics::soft::usable_cores()) / nodes;
  return launch.physics.threads.value_or(static_cast<int>(std::clamp<std::size_t>(share, 1, 64)));
}

physics::Settings physics_settings(const config::Launch& launch) {
  physics::Settings settings;
  settings.step_s = launch.step_s();
  settings.substeps = launch.time.substeps;
  settings.top_speed_m_s = launch.tolerances.speed_m_s;
  settings.solver = physics::solver_named(launch.physics.solver);
  settings.solver_iterations = launch.physics.iterations;
  settings.friction_directions = launch.physics.friction_directions;
  settings.contact_erp = launch.physics.contact_erp;
  settings.continuous = launch.physics.is_continuous();
  settings.block_m = launch.block_m();
  settings.threads = threads_of(launch, launch.regions.size());
  settings.foresight_s = launch.step_s() * core::horizon::announcing(launch.lookahead(), core::horizon::kMostHops);
  return settings;
}

node::NodeSetup node_setup(const config::Launch& launch, core::RegionId region, core::Generation generation) {
  node::NodeSetup setup;
  setup.protocol.self = region;
  setup.protocol.generation = generation;
  setup.protocol.sync = launch.time.sync;
  setup.protocol.aura = aura_rules(launch);
  setup.protocol.neighbour_distance_m = listening_distance_m(launch);
  setup.protocol.listening_ends = launch.dds.security.empty();  // docs/decisions/0059-listening-ends.md
  setup.physics = physics_settings(launch);
  setup.control = launch.control_rules();
  if (!launch.control.replay.empty()) setup.recorded = records::read_setpoints(launch.control.replay);
  return setup;
}

messages::WorldMap world_map(const config::Launch& launch) {
  messages::WorldMap map;
  map.map_version = launch.regions.version();
  map.agreement = launch.agreement();
  map.scene = launch.scene.name;
  for (std::uint32_t r = 0; r < launch.regions.size(); ++r)
    map.regions.push_back(launch.regions.region(core::RegionId{r}));
  return map;
}

std::filesystem::path program_beside(const std::string& name, const std::string& remedy) {
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe");
  std::filesystem::path program = self.parent_path() / name;
  if (!std::filesystem::exists(program)) throw std::runtime_error(program.string() + " is missing. " + remedy);
  return program;
}

}  // namespace aurasim::setup
