// What physics pays for a hand-off: a touching cluster taken out of one world and adopted by another that is K steps
// on.
#include <vector>

#include <benchmark/benchmark.h>

#include "physics/region_world.h"

namespace aurasim {
namespace {

using namespace core;

Scene stack(std::size_t count) {
  Scene scene;
  scene.shapes = {{"box", Box{{0.5, 0.5, 0.5}}}, {"ground", Plane{}}};
  scene.materials = {Material{}};
  scene.prototypes = {{"box", 0, 0, 1, true}};
  scene.statics = {{"ground", 1, 0, {}}};
  for (std::size_t i = 0; i < count; ++i) {
    InitialBody body;
    body.id = BodyId{i};
    body.pose.p_WB = {0.01 * static_cast<double>(i % 3), 0, 0.5 + static_cast<double>(i)};
    scene.bodies.push_back(body);
  }
  return scene;
}

/// Release, adopt with `late` steps of catch-up.
void hand_off(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  const auto late = static_cast<int>(state.range(1));
  const Scene scene = stack(count);
  physics::Settings settings;
  physics::RegionWorld from(scene, settings);
  std::vector<BodyRecord> records;
  std::vector<BodyId> ids;
  for (const InitialBody& body : scene.bodies) {
    records.push_back(initial_record(body));
    ids.push_back(body.id);
  }
  from.add(records);
  for (int i = 0; i < 30; ++i) from.step();
  const ClusterState cluster = from.peek(ids);
  physics::RegionWorld to(scene, settings);
  for (int i = 0; i < 30 + late; ++i) to.step();
  for (auto _ : state) {
    to.adopt(cluster, from.step_number());
    benchmark::DoNotOptimize(to.release(ids));
  }
  state.counters["manifolds"] = static_cast<double>(cluster.manifolds.size());
}

/// A pile of five layers, loosely dropped, `side` boxes wide, at x = `x_m`.
void add_pile(Scene& scene, std::size_t side, double x_m) {
  for (std::size_t i = 0; i < 5 * side * side; ++i) {
    InitialBody body;
    body.id = BodyId{scene.bodies.size()};
    const auto column = static_cast<double>(i % side), row = static_cast<double>(i / side % side);
    const auto layer = static_cast<double>(i / side / side);
    body.pose.p_WB = {x_m + 1.05 * column + 0.3 * layer, 1.05 * row + 0.2 * layer, 0.6 + 1.1 * layer};
    scene.bodies.push_back(body);
  }
}

/// A pile of 5 side^2 bodies joins a world that hosts three times as many.
void adopt_pile(benchmark::State& state) {
  const auto side = static_cast<std::size_t>(state.range(0));
  const auto late = static_cast<int>(state.range(1));
  Scene scene = stack(0);
  for (int k = 0; k < 4; ++k) add_pile(scene, side, 2.0 * k * static_cast<double>(side));
  physics::Settings settings;
  settings.substeps = 1;
  physics::RegionWorld from(scene, settings), to(scene, settings);
  std::vector<BodyRecord> pile, others;
  std::vector<BodyId> ids;
  for (const InitialBody& body : scene.bodies) {
    const bool leaves = pile.size() < 5 * side * side;
    (leaves ? pile : others).push_back(initial_record(body));
    if (leaves) ids.push_back(body.id);
  }
  from.add(pile);
  to.add(others);
  for (int i = 0; i < 30; ++i) from.step();
  const ClusterState cluster = from.peek(ids);
  for (int i = 0; i < 30 + late; ++i) to.step();
  for (auto _ : state) {
    to.adopt(cluster, from.step_number());
    state.PauseTiming();
    to.release(ids);
    state.ResumeTiming();
  }
  state.counters["bodies"] = static_cast<double>(ids.size());
  state.counters["manifolds"] = static_cast<double>(cluster.manifolds.size());
}

BENCHMARK(adopt_pile)->ArgNames({"side", "steps_late"})->ArgsProduct({{8, 17}, {0, 1}})->Unit(benchmark::kMillisecond);

BENCHMARK(hand_off)
    ->ArgNames({"bodies", "steps_late"})
    ->ArgsProduct({{1, 20}, {0, 1, 3}})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace aurasim
