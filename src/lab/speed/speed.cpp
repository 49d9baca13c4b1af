#include "lab/speed/speed.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <time.h>

#include "config/presets.h"
#include "lab/speed/scene_text.h"
#include "physics/region_world.h"
#include "physics/solver_names.h"

namespace aurasim::lab {
namespace {

double process_cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double steady_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Number of late steps (SpeedRun::late_steps). tests/bench/peers/driver.h has the same formula.
core::Step late_steps_of(const SpeedScene& scene) { return std::min<core::Step>(5 * scene.step_hz, scene.steps / 4); }

SpeedSettings settings_of(const std::string& name, int substeps, int iterations, int friction_directions,
                          physics::Solver solver = physics::Solver::kSequentialImpulse) {
  physics::Settings physics;
  physics.substeps = substeps;
  physics.solver_iterations = iterations;
  physics.friction_directions = friction_directions;
  physics.solver = solver;
  physics.continuous = physics.looks_once();
  return {name, physics};
}

SpeedSettings settings_named(const std::string& name) {
  for (const SpeedSettings& settings : speed_settings()) {
    if (settings.name == name) return settings;
  }
  throw std::invalid_argument("there are no settings \"" + name + "\"");
}

void append_row(const SpeedRun& run, const std::filesystem::path& file) {
  const bool is_new = !std::filesystem::exists(file);
  std::ofstream out(file, std::ios::app);
  if (is_new) out << records::csv_header<SpeedRun>();
  out << records::csv_line(run);
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

SpeedRun run_into(const std::filesystem::path& directory, const SpeedScene& scene, const SpeedSettings& settings) {
  std::ostringstream states;
  SpeedRun run = run_speed(scene, settings, states);
  const std::filesystem::path file =
      directory / "states" / fmt::format("{}.{}.{}.{}.txt", run.scene, run.engine, run.precision, run.threads);
  std::ofstream out(file);
  out << states.str();
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file.string());
  append_row(run, directory / "runs.csv");
  return run;
}

}  // namespace

const std::vector<SpeedSettings>& speed_settings() {
  static const std::vector<SpeedSettings> all = [] {
    std::vector<SpeedSettings> made = {settings_of("sequential_impulse", 4, 10, 1),
                                       settings_of("one_substep", 1, 10, 1),
                                       settings_of("12_substeps", 12, 1, 2, physics::Solver::kSoftStep)};
    for (const config::Preset& p : config::kPresets) {
      made.push_back(
          settings_of(p.name, p.substeps, p.iterations, p.friction_directions, physics::solver_named(p.solver)));
    }
    return made;
  }();
  return all;
}

SpeedRun run_speed(const SpeedScene& all, const SpeedSettings& settings, std::ostream& states) {
  SpeedRun run;
  run.scene = all.name;
  run.engine = "aurasim-" + settings.name;
  run.precision = "double";
  run.threads = settings.physics.threads;
  run.steps = all.steps;
  run.late_steps = late_steps_of(all);
  physics::Settings physics = settings.physics;
  physics.step_s = 1.0 / all.step_hz;
  physics::RegionWorld world(all.scene, physics);
  std::size_t born = 0;
  for (core::Step step = 1; step <= all.steps; ++step) {
    std::vector<core::BodyRecord> newborn;
    for (; born < all.births.size() && all.births[born] < step; ++born) {
      newborn.push_back(core::initial_record(all.scene.bodies[born], all.births[born]));
    }
    world.add(newborn);
    const double wall_before = steady_ms(), cpu_before = process_cpu_ms();
    world.step();
    const double cpu_ms = process_cpu_ms() - cpu_before, wall_ms = steady_ms() - wall_before;
    run.cpu_ms += cpu_ms;
    run.wall_ms += wall_ms;
    run.body_steps += static_cast<double>(born);
    if (step > all.steps - run.late_steps) {
      run.late_cpu_ms += cpu_ms;
      run.late_wall_ms += wall_ms;
    }
    if (step % all.states_every == 0) write_state(states, step, world.records());
  }
  return run;
}

std::vector<SpeedRun> run_speed(const SpeedPlan& plan, const std::filesystem::path& directory,
                                const Progress& progress) {
  const std::vector<std::string>& names = plan.scenes.empty() ? speed_scene_names() : plan.scenes;
  std::vector<SpeedScene> scenes;
  for (const std::string& name : names) {
    scenes.push_back(speed_scene(name, plan.size));
    write_scene_text(scenes.back(), scene_file(directory, name));
  }
  std::filesystem::create_directories(directory / "states");
  const double whole = static_cast<double>(plan.repeats) * static_cast<double>(scenes.size() * plan.settings.size());
  std::vector<SpeedRun> runs;
  for (int repeat = 0; repeat < plan.repeats; ++repeat) {
    for (const SpeedScene& scene : scenes) {
      for (const std::string& name : plan.settings) {
        if (!progress(static_cast<double>(runs.size()) / whole)) return runs;
        SpeedSettings settings = settings_named(name);
        settings.physics.threads = plan.threads;
        runs.push_back(run_into(directory, scene, settings));
      }
    }
  }
  return runs;
}

}  // namespace aurasim::lab
