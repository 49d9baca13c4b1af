// The scenes by which our step is compared with those of other engines (docs/speed.md): the same bodies for all of
// them, without anything that two engines mean differently (damping, rolling friction, springs).
#pragma once

#include <string>
#include <vector>

#include "core/ids.h"
#include "core/scene.h"

namespace aurasim::lab {

struct SpeedScene {
  std::string name;
  int step_hz = 60;
  core::Step steps = 0;
  core::Step states_every = 0;  ///< steps between the states that errors are computed of; the last state is one of them
  double fallen_m = 0.5;        ///< a body that has sunk by more than this since its birth has fallen
  core::Scene scene;            ///< ids are 0, 1, 2 ..., in order of birth; all prototypes may sleep, or none
  std::vector<core::Step> births;  ///< for each of scene.bodies, the state in which it appears
};

enum class SceneSize {
  kWhole,
  kQuick,  ///< few bodies for a second or four, for tests
};

const std::vector<std::string>& speed_scene_names();

/// Throws std::invalid_argument if there is none of this name.
SpeedScene speed_scene(const std::string& name, SceneSize size);

}  // namespace aurasim::lab
