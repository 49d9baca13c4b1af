// Programs of a random world that steer its bodies and joints in mid-run.
#pragma once

#include <string>
#include <vector>

#include "lab/scenes/formations.h"
#include "lab/scenes/json.h"

namespace aurasim::lab {

/// The entry "programs" of interference.json (interference.h). Precondition: `scene` has its bodies and joints.
/// `lookahead`: K.
Json random_programs(const Makings& makings, const Json& scene, int lookahead, Chance& chance);

/// A further program that moves the named statics, in small steps or far at once.
Json random_movers(const std::vector<std::string>& statics, const Json& scene, int lookahead, Chance& chance);

/// The entry "control" of the launch file: rules for programs that send nothing any more.
Json random_control_rules(Chance& chance);

}  // namespace aurasim::lab
