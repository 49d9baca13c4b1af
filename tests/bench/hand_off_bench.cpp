// What physics pays for a hand-off: a touching cluster taken out of one world and adopted by another that is K steps
// on.
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

BENCHMARK(hand_off)
    ->ArgNames({"bodies", "steps_late"})
    ->ArgsProduct({{1, 20}, {0, 1, 3}})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace aurasim
