// A scene file, as a whole. Lengths in metres, masses in kilograms, speeds in m/s and rad/s. All keys but
// `prototypes` are optional; unknown keys are errors. The shipped scenes in launch_configs/scenes are the examples.
//
//   name: rain                       # default: the file's name
//   gravity: [0, 0, -9.81]
//   layout: launch                   # only for injectors with `per`: the launch file's regions, or a layout of its
//                                    # own ({layout: columns, count: 4, width: 80}; all of config/region_layout.h),
//                                    # which keeps the scene the same however many nodes simulate it
//   materials:  {NAME: {friction: 0.5, ...}}        # config/bodies.h; what gives none has the material "default"
//   shapes:     {NAME: {sphere: {radius: 0.3}}}     # config/shapes.h
//   prototypes: {NAME: {shape, mass, material, can_sleep}}      # what bodies of one kind share
//   statics:    [{shape, name, material, position, orientation}]
//   bodies:     [{prototype, name, id, position, orientation, velocity, spin}]
//   generators: [{stack: {...}}, ...]               # config/generators.h
//   joints:     [{hinge: {axis: [0, 1, 0]}, bodies: [wheel, car]}, ...]        # config/joints.h
//   injectors:  [...]                               # config/injectors.h
//
// `shape` is a name, or a shape in place; `orientation` is {rpy_deg: [r, p, y]} or {quaternion: [w, x, y, z]}.
// Bodies without an id get the lowest free ones, in the order of the file, generators after `bodies`; the ids of
// injected bodies follow, injector by injector.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "config/errors.h"
#include "config/overrides.h"
#include "config/region_layout.h"
#include "core/scene.h"

namespace aurasim::config {

/// Where `layout: launch` points to.
struct LaunchLayout {
  bool is_known = false;  ///< false: the scene is read without a launch file
  std::optional<RegionLayout> layout;
};

/// The scene in `file`, with overrides whose paths begin in the scene. Check `errors` before use.
core::Scene read_scene_file(const std::filesystem::path& file, const std::vector<Override>& overrides,
                            const LaunchLayout& launch, Errors& errors);

}  // namespace aurasim::config
