// What every driver does with its engine's world: puts in each body when it is born, steps, measures the steps alone,
// and writes one row of runs.csv and the states that the errors are told from.
//   DRIVER SCENE.txt OUT THREADS
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include <time.h>

#include "scene.h"

namespace peers {

struct State {
  Vec3 p;
  Quat q;
  Vec3 v, w;
};

/// CPU time of the whole process, all threads of the engine.
inline double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

inline double wall_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The last steps of a run, by when a pile has become what it will be: 5 s, or a quarter of a short run. The same in
/// src/lab/speed/speed.cpp.
inline long late_steps(const Scene& scene) { return std::min(std::lround(5 / scene.step_s), scene.steps / 4); }

struct Times {
  double cpu_ms = 0, late_cpu_ms = 0, wall_ms = 0, late_wall_ms = 0, body_steps = 0;
};

class File {
 public:
  File(const std::filesystem::path& path, const char* mode) : file_(std::fopen(path.c_str(), mode)) {
    if (!file_) throw std::runtime_error("cannot write " + path.string());
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { std::fclose(file_); }
  std::FILE* get() { return file_; }

 private:
  std::FILE* file_;
};

template <class World>
void write_state(std::FILE* out, const World& world, long step, std::size_t bodies) {
  std::fprintf(out, "state %ld\n", step);
  for (std::size_t i = 0; i < bodies; ++i) {
    const State s = world.state(i);
    std::fprintf(out, "%zu", i);
    for (const double x : {s.p.x, s.p.y, s.p.z, s.q.w, s.q.x, s.q.y, s.q.z, s.v.x, s.v.y, s.v.z, s.w.x, s.w.y, s.w.z}) {
      std::fprintf(out, " %.9g", x);
    }
    std::fputc('\n', out);
  }
}

inline void write_row(const std::filesystem::path& path, const Scene& scene, const std::string& engine,
                      const char* precision, int threads, const Times& t) {
  const bool is_new = !std::filesystem::exists(path);
  File file(path, "a");
  if (is_new) {
    std::fputs("scene,engine,precision,threads,steps,body_steps,cpu_ms,late_steps,late_cpu_ms,wall_ms,late_wall_ms\n",
               file.get());
  }
  std::fprintf(file.get(), "%s,%s,%s,%d,%ld,%.0f,%.3f,%ld,%.3f,%.3f,%.3f\n", scene.name.c_str(), engine.c_str(),
               precision, threads, scene.steps, t.body_steps, t.cpu_ms, late_steps(scene), t.late_cpu_ms, t.wall_ms,
               t.late_wall_ms);
}

template <class World>
Times run_scene(World& world, const Scene& scene, std::FILE* states) {
  Times t;
  std::size_t born = 0;
  for (long step = 1; step <= scene.steps; ++step) {
    for (; born < scene.bodies.size() && scene.bodies[born].birth < step; ++born) world.add(scene.bodies[born]);
    if (step == 1) world.join();
    const double wall_before = wall_ms(), cpu_before = cpu_ms();
    world.step();
    const double cpu = cpu_ms() - cpu_before, wall = wall_ms() - wall_before;
    t.cpu_ms += cpu;
    t.wall_ms += wall;
    t.body_steps += static_cast<double>(born);
    if (step > scene.steps - late_steps(scene)) {
      t.late_cpu_ms += cpu;
      t.late_wall_ms += wall;
    }
    if (step % scene.states_every == 0) write_state(states, world, step, born);
  }
  return t;
}

/// World: World(const Scene&, int threads), add(const Body&), join() after the bodies of state 0, step(),
/// state(std::size_t body) in order of add.
template <class World>
int drive(int argc, char** argv, const std::string& engine, const char* precision) {
  if (argc != 4) {
    std::fprintf(stderr, "%s SCENE.txt OUT THREADS\n", argv[0]);
    return 2;
  }
  try {
    const Scene scene = read_scene(argv[1]);
    const std::filesystem::path out = argv[2];
    const int threads = std::atoi(argv[3]);
    std::filesystem::create_directories(out / "states");
    File states(out / "states" / (scene.name + "." + engine + "." + precision + "." + argv[3] + ".txt"), "w");
    const auto world = std::make_unique<World>(scene, threads);
    const Times times = run_scene(*world, scene, states.get());
    write_row(out / "runs.csv", scene, engine, precision, threads, times);
    return 0;
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "%s: %s\n", engine.c_str(), problem.what());
    return 1;
  }
}

}  // namespace peers
