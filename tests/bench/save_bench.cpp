// What it costs to keep a world: 5,000 boxes in loose piles, at rest on each other. To capture is what a step pays; the
// file is written beside the run. Also what a redo pays: to keep a cut, and to go back to it.
#include <ctime>

#include <benchmark/benchmark.h>

#include "cut/cut_file.h"
#include "physics/region_world.h"

namespace aurasim {
namespace {

using namespace core;

Scene piles(std::size_t bodies) {
  Scene scene;
  scene.shapes = {{"box", Box{{0.5, 0.5, 0.5}}}, {"ground", Plane{}}};
  scene.materials = {Material{}};
  scene.prototypes = {{"box", 0, 0, 1, true}};
  scene.statics = {{"ground", 1, 0, {}}};
  for (std::size_t i = 0; i < bodies; ++i) {
    InitialBody& body = scene.bodies.emplace_back();
    body.id = BodyId{i};
    const auto pile = static_cast<double>(i / 5), layer = static_cast<double>(i % 5);
    body.pose.p_WB = {1.3 * pile + 0.1 * layer, 0.05 * layer, 0.5 + layer};
  }
  return scene;
}

struct Run {
  explicit Run(std::size_t bodies) : scene(piles(bodies)), world(scene, settings()) {
    std::vector<BodyRecord> records;
    for (const InitialBody& body : scene.bodies) records.push_back(initial_record(body));
    world.add(records);
    for (int i = 0; i < 60; ++i) world.step();
  }
  static physics::Settings settings() {
    physics::Settings settings;
    settings.solver = physics::Solver::kSoftStep;
    settings.continuous = true;
    settings.substeps = 8;
    return settings;
  }
  cut::SavedWorld saved() const {
    cut::SavedWorld saved;
    saved.cut.step = world.step_number();
    saved.cut.bodies = world.peek_all();
    return saved;
  }

  Scene scene;
  physics::RegionWorld world;
};

void capture_world(benchmark::State& state) {
  const Run run(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(run.world.peek_all());
}

void encode_world(benchmark::State& state) {
  const cut::SavedWorld saved = Run(static_cast<std::size_t>(state.range(0))).saved();
  for (auto _ : state) benchmark::DoNotOptimize(cut::encode(saved));
  state.counters["bytes"] = static_cast<double>(cut::encode(saved).size());
  state.counters["points"] = static_cast<double>(saved.cut.bodies.points.size() / kContactPointDoubles);
}

void decode_world(benchmark::State& state) {
  const std::string bytes = cut::encode(Run(static_cast<std::size_t>(state.range(0))).saved());
  for (auto _ : state) benchmark::DoNotOptimize(cut::decode(bytes));
}

/// Into a world that has none of it.
void put_back_world(benchmark::State& state) {
  const Run run(static_cast<std::size_t>(state.range(0)));
  const ClusterState all = run.world.peek_all();
  for (auto _ : state) {
    physics::RegionWorld other(run.scene, Run::settings());
    other.put_back(run.world.step_number(), all);
    benchmark::DoNotOptimize(other.body_count());
  }
}

/// A heap of 2,000 boxes, and `bodies` - 2,000 that fly above it.
Scene heap_and_rain(std::size_t bodies) {
  Scene scene = piles(bodies);
  for (std::size_t i = 0; i < bodies; ++i) {
    InitialBody& body = scene.bodies[i];
    const bool flies = i >= 2000;
    const std::size_t side = flies ? 40 : 20, n = flies ? i - 2000 : i;
    const double apart = flies ? 2.5 : 1.02;
    body.pose.p_WB = {apart * static_cast<double>(n % side) + 0.1 * static_cast<double>(n % 7),
                      apart * static_cast<double>(n / side % side) + 0.1 * static_cast<double>(n % 5),
                      (flies ? 20 : 0.5) + (flies ? 2.5 : 1.01) * static_cast<double>(n / side / side)};
    if (flies) body.v_WB = {3.0 - static_cast<double>(n % 7), 3.0 - static_cast<double>(n % 5), 4};
  }
  return scene;
}

struct RainRun {
  explicit RainRun(std::size_t bodies) : scene(heap_and_rain(bodies)), world(scene, Run::settings()) {
    std::vector<BodyRecord> records;
    for (const InitialBody& body : scene.bodies) records.push_back(initial_record(body));
    world.add(records);
    for (int i = 0; i < 60; ++i) world.step();
  }
  Scene scene;
  physics::RegionWorld world;
};

void take_cut(benchmark::State& state) {
  const RainRun run(static_cast<std::size_t>(state.range(0)));
  ClusterState cut;
  for (auto _ : state) run.world.copy_all(cut);
  state.counters["points"] = static_cast<double>(cut.points.size() / kContactPointDoubles);
}

/// A world goes back by `states` states; `emptied`: it is emptied first, so that every body is new. CPU time.
template <class World>
void go_back(benchmark::State& state) {
  World run(static_cast<std::size_t>(state.range(0)));
  const ClusterState cut = run.world.peek_all();
  const Step then = run.world.step_number();
  std::vector<BodyId> ids;
  for (const BodyRecord& body : cut.bodies) ids.push_back(body.id);
  for (auto _ : state) {
    for (int i = 0; i < state.range(1); ++i) run.world.step();
    const std::clock_t begin = std::clock();
    if (state.range(2) != 0) run.world.release(ids);
    run.world.put_back(then, cut);
    state.SetIterationTime(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  state.counters["manifolds"] = static_cast<double>(cut.manifolds.size());
}

BENCHMARK(take_cut)->Arg(5000)->Unit(benchmark::kMillisecond);
void back_by(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"bodies", "states", "emptied"})->ArgsProduct({{5000}, {5, 20}, {0, 1}});
  bench->UseManualTime()->Iterations(10)->Unit(benchmark::kMillisecond);
}
BENCHMARK(go_back<RainRun>)->Apply(back_by);
BENCHMARK(go_back<Run>)->Apply(back_by);
BENCHMARK(capture_world)->Arg(500)->Arg(5000)->Unit(benchmark::kMillisecond);
BENCHMARK(encode_world)->Arg(500)->Arg(5000)->Unit(benchmark::kMillisecond);
BENCHMARK(decode_world)->Arg(500)->Arg(5000)->Unit(benchmark::kMillisecond);
BENCHMARK(put_back_world)->Arg(500)->Arg(5000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace aurasim
