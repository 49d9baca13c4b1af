// What looking at one state costs the protocol: sparse and piled bodies, half of them near a border, with tight and
// with swept auras. The pile has contacts; the neighbour mirrors it on the other side of the border.
#include <cmath>
#include <random>

#include <benchmark/benchmark.h>

#include "core/protocol.h"
#include "physics/clearance.h"
#include "physics/region_world.h"

namespace aurasim {
namespace {

using namespace core;

Scene shapes() {
  Scene scene;
  scene.shapes = {{"ball", Sphere{0.3}}, {"cuboid", Box{{0.15, 0.15, 0.5}}}, {"capsule", Capsule{0.3, 1.4}}};
  scene.materials = {Material{}};
  scene.prototypes = {{"ball", 0, 0, 1, true}, {"cuboid", 1, 0, 1, true}, {"capsule", 2, 0, 1, true}};
  return scene;
}

/// `count` bodies at x > 0, the nearest at the border x = 0: in a pile 0.7 m apart and in contact, or 4 m apart.
Snapshot bodies(std::size_t count, bool piled) {
  Snapshot snapshot;
  std::mt19937_64 random(7);
  const auto u = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };
  const double spacing = piled ? 0.7 : 4;
  const std::size_t layers = piled ? 3 : 1;
  const auto side =
      static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count) / static_cast<double>(layers))));
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t cell = i / layers;
    BodyState body;
    body.id = BodyId{i};
    body.prototype = PrototypeId{static_cast<std::uint32_t>(i % 3)};
    body.pose.p_WB = {spacing * (0.5 + static_cast<double>(cell / side)), spacing * static_cast<double>(cell % side),
                      0.3 + spacing * static_cast<double>(i % layers)};
    body.v_WB = Vec3(u(), u(), u()) * (piled ? 0.3 : 8.0);
    snapshot.bodies.push_back(body);
    if (piled && i % layers != 0)
      snapshot.contacts.push_back({static_cast<std::uint32_t>(i - 1), static_cast<std::uint32_t>(i)});
  }
  return snapshot;
}

/// The same bodies on the other side, as the neighbour's aura batch.
AuraBatch mirrored(const Snapshot& snapshot, const Aura& aura, std::uint64_t map_version) {
  AuraBatch batch;
  batch.source = RegionId{0};
  batch.map_version = map_version;
  batch.full = true;
  batch.top_speed_m_s = 15;
  batch.top_radius_m = 1;
  for (const BodyState& body : snapshot.bodies) {
    if (body.pose.p_WB.x() > 6) continue;
    AuraRecord record;
    record.id = BodyId{value_of(body.id) + 1'000'000};
    record.host = RegionId{0};
    record.prototype = body.prototype;
    record.pose = body.pose;
    record.pose.p_WB.x() *= -1;
    record.v_WB = body.v_WB;
    record.speed_m_s = aura.speed_of(body);
    batch.updates.push_back(record);
  }
  return batch;
}

void observe(benchmark::State& state) {
  const bool piled = state.range(1) != 0;
  const Scene scene = shapes();
  const auto clearance = physics::make_clearance_query(scene);
  const RegionMap map = RegionMap::columns(2, 200);
  ProtocolSettings settings;
  settings.self = RegionId{1};
  settings.aura.kind = state.range(2) != 0 ? AuraKind::kSwept : AuraKind::kTight;
  settings.aura.substeps = 4;
  Protocol protocol(settings, map, *clearance);
  Snapshot snapshot = bodies(static_cast<std::size_t>(state.range(0)), piled);
  Inbox inbox;
  inbox.auras.push_back(mirrored(snapshot, protocol.aura(), map.version()));
  protocol.accept(inbox);
  protocol.receive(1);
  snapshot.step = 1;
  for (auto _ : state) benchmark::DoNotOptimize(protocol.observe(snapshot).size());
  state.counters["us_per_body"] =
      benchmark::Counter(static_cast<double>(state.range(0)) * 1e-6,
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["projecting"] = static_cast<double>(protocol.projection().projecting());
  state.counters["foreign"] = static_cast<double>(protocol.matching().foreign_auras());
  state.counters["largest_cluster"] = static_cast<double>(protocol.largest_cluster());
}

BENCHMARK(observe)
    ->ArgNames({"bodies", "piled", "swept"})
    ->ArgsProduct({{1000, 5000, 20000}, {0, 1}, {0, 1}})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace aurasim
