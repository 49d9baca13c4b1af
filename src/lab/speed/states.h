// States that a run has written, for computing errors. Text format: "state STEP", then a line for each body,
//   ID P(3) Q(4, w x y z) V(3) W(3)
#pragma once

#include <filesystem>
#include <ostream>
#include <span>
#include <vector>

#include "core/body_state.h"
#include "lab/speed/speed_scene.h"

namespace aurasim::lab {

struct SeenState {
  core::Step step = 0;
  std::vector<core::BodyRecord> bodies;  ///< ascending id; not all, where an engine has lost some
};

void write_state(std::ostream& out, core::Step step, std::span<const core::BodyRecord> bodies);

/// Numbers may be nan or inf. Throws std::runtime_error, "file:line: ...".
std::vector<SeenState> read_states(const std::filesystem::path& file, const SpeedScene& scene);

}  // namespace aurasim::lab
