// What a world costs in which almost everything sleeps: 50 balls roll past pairs of boxes that lie on each other. The
// frame of a node and its parts, and the memory of a body, on one node and on four, also coupled ones.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <utility>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "lab/virtual_cluster.h"

namespace aurasim {
namespace {

using namespace core;

constexpr std::size_t kBalls = 50;
constexpr double kSpacing_m = 3;
/// State from which on frames are measured: all boxes sleep, and their contacts are packed.
constexpr Step kFirst = 660;

double resident_bytes() {
  double pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

std::size_t side_of(std::size_t boxes) {
  return static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(boxes) / 2)));
}

Scene kinds() {
  Scene scene;
  scene.shapes = {{"box", Box{{0.5, 0.5, 0.5}}}, {"ball", Sphere{0.3}}, {"ground", Plane{}}};
  scene.materials = {Material{}};
  scene.prototypes = {{"box", 0, 0, 1, true}, {"ball", 1, 0, 1, false}};
  scene.statics = {{"ground", 2, 0, {}}};
  return scene;
}

/// What happens in a world at rest, every kPeriod states.
enum class What : std::uint8_t { kNothing, kWake, kRemove, kSpawn, kCross };
constexpr int kPeriod = 30;

/// Boxes that are about to fall asleep, and balls in the lanes between them. kCross: every kPeriod states a ball comes
/// to x = 0.
WorldCut world_of(std::size_t boxes, double step_s, What what) {
  WorldCut world;
  world.births_known = 1000;
  const std::size_t side = side_of(boxes);
  const double middle = kSpacing_m * static_cast<double>(side) / 2;
  const auto add = [&](PrototypeId kind, const Vec3& p_WB) -> BodyRecord& {
    BodyRecord& body = world.bodies.bodies.emplace_back();
    body.id = BodyId{world.bodies.bodies.size() - 1};
    body.prototype = kind;
    body.p_WB = p_WB;
    return body;
  };
  for (std::size_t i = 0; i < boxes; ++i) {
    const double x = kSpacing_m * static_cast<double>(i / 2 % side), y = kSpacing_m * static_cast<double>(i / 2 / side);
    add(PrototypeId{0}, {x - middle, y - middle, 0.5 + static_cast<double>(i % 2)}).deactivation_time = 2 - 5 * step_s;
  }
  for (std::size_t i = 0; i < kBalls; ++i) {
    const auto lane = static_cast<double>(i * side / kBalls);
    double x = i % 2 == 0 ? -40.0 : 10.0;
    if (what == What::kCross) x = -step_s * static_cast<double>(kFirst + kPeriod * i / 2);
    BodyRecord& ball = add(PrototypeId{1}, {x, kSpacing_m * (lane + 0.5) - middle, 0.3});
    ball.v_WB = {1, 0, 0};
    ball.w_WB = {0, 1 / 0.3, 0};
  }
  return world;
}

lab::ClusterRules rules(std::size_t nodes, bool coupled) {
  const bool checked = nodes > 1 && !coupled;
  lab::ClusterRules rules;
  rules.coupled = coupled;
  rules.aura.redo = checked;
  rules.sync = nodes > 1 ? SyncMode::kDeterministic : SyncMode::kBounded;
  rules.physics.solver = physics::Solver::kSoftStep;
  rules.physics.continuous = true;
  if (coupled) rules.physics.top_speed_m_s = 20;
  rules.hash_states = true;
  rules.clock = node::PhaseClock::kThreadCpu;
  rules.neighbour_distance_m = 100;
  rules.shortest_frame_s = rules.longest_frame_s = 0.001;
  return rules;
}

/// Makes the event of a state, which concerns one box.
void make(What what, std::uint64_t number, lab::VirtualCluster& cluster) {
  const BodyId box{7 + 2 * number};
  const auto give = [&](const Action& action) { cluster.node(0).order(action, number + 1); };
  if (what == What::kWake) give(Impulse{box, {0, 0, 1e-3}});
  if (what == What::kRemove) give(RemoveBody{box});
  if (what != What::kSpawn) return;
  Spawn spawn;
  spawn.id = BodyId{kFirstClientBody + number};
  spawn.pose.p_WB = {-20 - kSpacing_m * static_cast<double>(number), -20 - kSpacing_m / 2, 0.5};
  give(spawn);
}

/// Microseconds of the frames of the node of region 0, after the boxes have fallen asleep: on average, the longest one,
/// and the longest one after an event, on average over all events. B_each: memory of the process for each box.
void rest(benchmark::State& state) {
  const auto boxes = static_cast<std::size_t>(state.range(0));
  const auto nodes = static_cast<std::size_t>(state.range(1));
  const auto what = static_cast<What>(state.range(3));
  const double before = resident_bytes();
  const Scene scene = kinds();
  const double cell = kSpacing_m * static_cast<double>(side_of(boxes)) / 2;
  const RegionMap map = nodes == 1 ? RegionMap::columns(1, cell) : RegionMap::grid(2, 2, cell, cell);
  const lab::ClusterRules how = rules(nodes, state.range(2) != 0);
  auto world = std::make_unique<WorldCut>(world_of(boxes, how.aura.step_s, what));
  lab::VirtualCluster cluster(scene, map, how, world.get());
  world.reset();
  node::Durations sum;
  double frames_s = 0, longest_s = 0, longest_of_period_s = 0, longest_of_events_s = 0, awake = 0;
  int frames = 0;
  const auto take = [&] {
    const lab::VirtualCluster::Event event = cluster.next();
    if (event.region != RegionId{0} || event.report->step < kFirst) return false;
    const node::Durations& d = event.report->durations;
    sum.physics_s += d.physics_s, sum.protocol_s += d.protocol_s, sum.transport_s += d.transport_s;
    sum.watch_s += d.watch_s, sum.cut_s += d.cut_s, sum.hash_s += d.hash_s;
    awake += static_cast<double>(event.report->awake);
    return true;
  };
  while (!take()) continue;
  sum = {}, awake = 0;
  double spent_s = cluster.node(0).time_spent().all_s();
  for (auto _ : state) {
    if (frames % kPeriod == 0) {
      longest_of_events_s += std::exchange(longest_of_period_s, 0);
      make(what, static_cast<std::uint64_t>(frames / kPeriod), cluster);
    }
    while (!take()) continue;
    const double now_s = cluster.node(0).time_spent().all_s();
    frames_s += now_s - spent_s;
    longest_s = std::max(longest_s, now_s - spent_s);
    longest_of_period_s = std::max(longest_of_period_s, now_s - spent_s);
    spent_s = now_s;
    ++frames;
  }
  const auto us = [frames](double seconds) { return 1e6 * seconds / frames; };
  state.counters["frame"] = us(frames_s);
  state.counters["longest"] = 1e6 * longest_s;
  state.counters["event"] = kPeriod * us(longest_of_events_s + longest_of_period_s);
  state.counters["physics"] = us(sum.physics_s);
  state.counters["hash"] = us(sum.hash_s);
  state.counters["protocol"] = us(sum.protocol_s);
  state.counters["watch"] = us(sum.watch_s);
  state.counters["cut"] = us(sum.cut_s);
  state.counters["transport"] = us(sum.transport_s);
  state.counters["awake"] = awake / frames;
  state.counters["redos"] = cluster.node(0).redos();
  state.counters["B_each"] = (resident_bytes() - before) / static_cast<double>(boxes);
}

BENCHMARK(rest)
    ->ArgNames({"boxes", "nodes", "coupled", "what"})
    ->ArgsProduct({{1000, 50000, 100000}, {1, 4}, {0}, {0}})
    ->ArgsProduct({{1000, 20000, 100000}, {4}, {1}, {0}})
    ->ArgsProduct({{100000}, {1, 4}, {0}, {1, 2, 3, 4}})
    ->ArgsProduct({{100000}, {4}, {1}, {1, 2, 3, 4}})
    ->Iterations(600)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace aurasim
