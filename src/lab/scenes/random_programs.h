// Programs of a random world that steer its bodies and joints in mid-run.
#pragma once

#include <string>
#include <vector>

#include "lab/scenes/formations.h"
#include "lab/scenes/json.h"

namespace aurasim::lab {

/// "programs" of interference.json (interference.h) for a scene that has its bodies and joints. `lookahead`: K.
Json random_programs(const Makings& makings, const Json& scene, int lookahead, Chance& chance);

/// More of them: one that sends the statics of these names about, by little and little or far at once.
Json random_movers(const std::vector<std::string>& statics, const Json& scene, int lookahead, Chance& chance);

/// "control" of the launch file: what becomes of a program that says nothing any more.
Json random_control_rules(Chance& chance);

}  // namespace aurasim::lab
