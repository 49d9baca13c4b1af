// What setpoints cost a node: a state in which each of its bodies has a torque that a program says anew. The same
// world, left alone, takes turns, so that a busy machine slows both: look at the ratio.
#include <chrono>
#include <cmath>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "node/node.h"
#include "transport/memory_transport.h"

namespace aurasim {
namespace {

using namespace core;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kBodies = 1000, kPerMessage = 800;
constexpr Step kWarmUp = 700;  ///< states; by then as many are remembered as ever

/// Balls that roll about and do not meet.
Scene balls() {
  Scene scene;
  scene.shapes = {{"ball", Sphere{0.4}}, {"floor", Plane{}}};
  scene.materials = {Material{}};
  scene.prototypes = {{"ball", 0, 0, 1, false}};
  scene.statics = {{"floor", 1, 0, {}}};
  for (std::size_t i = 0; i < kBodies; ++i) {
    InitialBody& body = scene.bodies.emplace_back();
    body.id = BodyId{i};
    body.pose.p_WB = {1.3 * static_cast<double>(i % 32), 1.3 * static_cast<double>(i / 32), 0.4};
    body.v_WB = {0.001, 0, 0};
  }
  return scene;
}

struct OneNode {
  explicit OneNode(const Scene& scene, const RegionMap& map)
      : network({{}}, {}, 1), node(setup(), scene, map, network.endpoint(RegionId{0})) {
    node.start();
  }
  static node::NodeSetup setup() {
    node::NodeSetup setup;
    setup.protocol.sync = SyncMode::kDeterministic;
    setup.protocol.aura.redo = true;
    setup.physics.solver = physics::Solver::kSoftStep;
    setup.physics.friction_directions = 2;
    return setup;
  }
  void step() {
    network.advance_to(static_cast<double>(node.current_step()) / 60);
    node.ready();
    node.step();
  }

  transport::MemoryNetwork network;
  node::Node node;
};

std::vector<Setpoints> torques(Step step) {
  std::vector<Setpoints> said;
  for (std::size_t i = 0; i < kBodies; ++i) {
    if (i % kPerMessage == 0) {
      Setpoints& message = said.emplace_back();
      message.client = 42;
      message.at_step = step;
      message.sequence = static_cast<std::uint64_t>(2 * step) + i / kPerMessage;
    }
    const double phase = 0.7 * static_cast<double>(i) + 0.05 * static_cast<double>(step);
    said.back().bodies.push_back(
        {BodyId{i}, Quantity::kTorque, Vec3(1e-4 * std::sin(phase), 1e-4 * std::cos(phase), 0)});
  }
  return said;
}

double ms(Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

/// Iteration time: a state with torques. Counters: ms a state for hearing and for computing it, and for computing what
/// is left alone.
void a_torque_on_each_of_1000_bodies(benchmark::State& state) {
  const Scene scene = balls();
  const RegionMap map = RegionMap::grid(1, 1, 1000, 1000);
  OneNode alone(scene, map), told(scene, map);
  double hear_ms = 0, told_ms = 0, alone_ms = 0;
  for (Step i = 0; i < kWarmUp; ++i) {
    alone.step();
    for (const Setpoints& said : torques(told.node.current_step() + 4)) told.node.hear(said);
    told.step();
  }
  for (auto _ : state) {
    const std::vector<Setpoints> words = torques(told.node.current_step() + 4);
    const auto t0 = Clock::now();
    alone.step();
    const auto t1 = Clock::now();
    for (const Setpoints& said : words) told.node.hear(said);
    const auto t2 = Clock::now();
    told.step();
    const auto t3 = Clock::now();
    alone_ms += ms(t1 - t0), hear_ms += ms(t2 - t1), told_ms += ms(t3 - t2);
    state.SetIterationTime(1e-3 * ms(t3 - t1));
  }
  const auto count = static_cast<double>(state.iterations());
  state.counters["hear_ms"] = hear_ms / count;
  state.counters["told_ms"] = told_ms / count;
  state.counters["alone_ms"] = alone_ms / count;
  state.counters["told_over_alone"] = (hear_ms + told_ms) / alone_ms;
}

BENCHMARK(a_torque_on_each_of_1000_bodies)->Iterations(600)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace aurasim
