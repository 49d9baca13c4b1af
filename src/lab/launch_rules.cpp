#include "lab/launch_rules.h"

namespace aurasim::lab {

ClusterRules launch_rules(const config::Launch& launch, const SetupOf& setup_of) {
  ClusterRules rules;
  const node::NodeSetup setup = setup_of(launch, core::RegionId{0});
  rules.aura = setup.protocol.aura;
  rules.sync = setup.protocol.sync;
  rules.neighbour_distance_m = setup.protocol.neighbour_distance_m;
  rules.physics = setup.physics;
  rules.control = setup.control;
  // No link is measured in virtual time, so `exchange: auto` means aura there.
  rules.coupled = launch.exchange == config::Exchange::kCoupled && launch.regions.size() > 1;
  return rules;
}

}  // namespace aurasim::lab
