// The speed experiment: the scenes of docs/speed.md in one world, without nodes and protocol, as other engines run them
// (scripts/peers.sh). The results lie in one folder, ours and theirs:
//   scenes/SCENE.txt                             the scenes for all engines (scene_text.h)
//   runs.csv                                     a row for each run: how long its steps took
//   states/SCENE.ENGINE.PRECISION.THREADS.txt    some states of the latest run (states.h)
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "lab/on_threads.h"
#include "lab/speed/speed_errors.h"
#include "lab/speed/speed_scene.h"
#include "physics/settings.h"
#include "records/csv.h"

namespace aurasim::lab {

/// How our step is set up: the presets, of which "balanced" is what a launch file has that says nothing; the soft step
/// with "12_substeps"; Bullet's own solver in "one_substep", as Bullet and the thesis, and in four:
/// "sequential_impulse".
struct SpeedSettings {
  std::string name;
  physics::Settings physics;
};
const std::vector<SpeedSettings>& speed_settings();

struct SpeedPlan {
  std::vector<std::string> scenes;                   ///< none: every scene
  std::vector<std::string> settings = {"balanced"};  ///< names of speed_settings()
  int threads = 1;
  SceneSize size = SceneSize::kWhole;
  int repeats = 1;  ///< 0: only the scenes are written
};

/// CPU time is that of the whole process, in the steps alone.
struct SpeedRun {
  std::string scene;
  std::string engine;     ///< "aurasim-" and the settings
  std::string precision;  ///< some of the other engines compute in single precision
  int threads = 1;
  core::Step steps = 0;
  double body_steps = 0;  ///< number of bodies, summed over the steps
  double cpu_ms = 0;
  core::Step late_steps = 0;  ///< number of steps in the last 5 s, or in the last quarter of a short run
  double late_cpu_ms = 0;
  double wall_ms = 0;
  double late_wall_ms = 0;

  /// Drivers of other engines write the same columns (tests/bench/peers/driver.h).
  static constexpr auto columns() {
    using records::Column;
    constexpr std::string_view kMs = "{:.3f}";
    return std::tuple{Column{"scene", &SpeedRun::scene},
                      Column{"engine", &SpeedRun::engine},
                      Column{"precision", &SpeedRun::precision},
                      Column{"threads", &SpeedRun::threads},
                      Column{"steps", &SpeedRun::steps},
                      Column{"body_steps", &SpeedRun::body_steps, "{:.0f}"},
                      Column{"cpu_ms", &SpeedRun::cpu_ms, kMs},
                      Column{"late_steps", &SpeedRun::late_steps},
                      Column{"late_cpu_ms", &SpeedRun::late_cpu_ms, kMs},
                      Column{"wall_ms", &SpeedRun::wall_ms, kMs},
                      Column{"late_wall_ms", &SpeedRun::late_wall_ms, kMs}};
  }
};

/// Runs one scene, and writes its states to `states` meanwhile.
SpeedRun run_speed(const SpeedScene& scene, const SpeedSettings& settings, std::ostream& states);

/// Runs the plan, its scenes and settings in turn, and appends to runs.csv in `directory`.
std::vector<SpeedRun> run_speed(const SpeedPlan& plan, const std::filesystem::path& directory,
                                const Progress& progress);

}  // namespace aurasim::lab
