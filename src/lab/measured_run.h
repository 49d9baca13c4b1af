// Runs a case to its end on one or several nodes in virtual time, and measures its errors, bits and cost.
#pragma once

#include <cstdint>
#include <vector>

#include "core/aura.h"
#include "core/protocol.h"
#include "core/region_map.h"
#include "lab/case.h"
#include "physics/region_world.h"

namespace aurasim::lab {

struct RunRules {
  int step_hz = 60;
  int substeps = 1;
  physics::Solver solver = physics::Solver::kSequentialImpulse;
  int iterations = 10;
  int friction_directions = 1;
  double block_m = core::kUsualBlock_m;
  core::SyncMode sync = core::SyncMode::kDeterministic;
  int lookahead = 1;
  core::AuraKind aura = core::AuraKind::kSwept;
};

struct MeasuredRun {
  std::vector<double> errors;       ///< one for each of Case::metrics, in their order
  std::vector<std::uint64_t> hash;  ///< hash of every state
  double cpu_us_per_step = 0;       ///< CPU time of the busiest node, with its protocol, microseconds
  std::uint64_t hand_offs = 0;      ///< bodies
  std::uint64_t violations = 0;
  core::Step steps = 0;
};

/// Runs the case on the regions of `map`. The errors leave out states in which a body is under way between two nodes
/// (lookahead above 1).
MeasuredRun run_case(const Case& c, const RunRules& rules, const core::RegionMap& map);

/// Regions of a width that no case crosses, the middle border at Case::border_x_m.
core::RegionMap one_node();
core::RegionMap columns_at(double border_x_m, int count);

}  // namespace aurasim::lab
