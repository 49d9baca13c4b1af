// What the equal bits cost: one step of a pile in a RegionWorld against the same pile in Bullet as it comes. The two
// worlds take turns, so that a busy machine slows both: look at the ratio.
#include <chrono>
#include <memory>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>
#include <btBulletDynamicsCommon.h>

#include "physics/region_world.h"

namespace aurasim {
namespace {

using namespace core;
using Clock = std::chrono::steady_clock;

constexpr int kSubsteps = 4;
constexpr double kStep_s = 1.0 / 60;

/// Boxes, spheres and capsules that rain onto a floor and never sleep.
Scene pile(std::size_t count) {
  Scene scene;
  scene.shapes = {
      {"box", Box{{0.4, 0.3, 0.5}}}, {"ball", Sphere{0.4}}, {"pill", Capsule{0.3, 0.5}}, {"floor", Plane{}}};
  scene.materials = {Material{}};
  for (std::uint32_t kind = 0; kind < 3; ++kind) scene.prototypes.push_back({"", kind, 0, 1, false});
  scene.statics = {{"floor", 3, 0, {}}};
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> jitter(-0.1, 0.1);
  for (std::size_t i = 0; i < count; ++i) {
    InitialBody body;
    body.id = BodyId{i};
    body.prototype = PrototypeId{static_cast<std::uint32_t>(i % 3)};
    const auto column = static_cast<double>(i % 625);
    body.pose.p_WB = {1.3 * std::fmod(column, 25) + jitter(random), 1.3 * std::floor(column / 25) + jitter(random),
                      1 + 1.4 * static_cast<double>(i / 625)};
    scene.bodies.push_back(body);
  }
  return scene;
}

/// Bullet with its own defaults, as its manual sets it up.
class PlainBullet {
 public:
  explicit PlainBullet(const Scene& scene) {
    world_.setGravity(btVector3(scene.gravity.x(), scene.gravity.y(), scene.gravity.z()));
    add(floor_, 0, btVector3(0, 0, 0));
    for (const InitialBody& body : scene.bodies) {
      const Vec3& p = body.pose.p_WB;
      add(*shapes_[value_of(body.prototype)], 1, btVector3(p.x(), p.y(), p.z()));
      bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    }
  }
  ~PlainBullet() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  PlainBullet(const PlainBullet&) = delete;
  PlainBullet& operator=(const PlainBullet&) = delete;

  void step() { world_.stepSimulation(kStep_s, kSubsteps, kStep_s / kSubsteps); }

 private:
  void add(btCollisionShape& shape, double mass, const btVector3& p) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape.calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
    info.m_startWorldTransform.setOrigin(p);
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    world_.addRigidBody(bodies_.back().get());
  }

  btBoxShape box_{btVector3(0.4, 0.3, 0.5)};
  btSphereShape ball_{0.4};
  btCapsuleShapeZ pill_{0.3, 0.5};
  btStaticPlaneShape floor_{btVector3(0, 0, 1), 0};
  std::array<btCollisionShape*, 3> shapes_ = {&box_, &ball_, &pill_};
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

/// The pile has settled for 5 s when the clock starts. Iteration time: one step of ours.
void equal_bits_against_plain_bullet(benchmark::State& state) {
  const Scene scene = pile(static_cast<std::size_t>(state.range(0)));
  PlainBullet plain(scene);
  physics::Settings settings;
  settings.substeps = kSubsteps;
  physics::RegionWorld ours(scene, settings);
  std::vector<BodyRecord> records;
  for (const InitialBody& body : scene.bodies) records.push_back(initial_record(body));
  ours.add(records);
  for (int i = 0; i < 300; ++i) {
    plain.step();
    ours.step();
  }
  double plain_s = 0, ours_s = 0;
  for (auto _ : state) {
    const auto t0 = Clock::now();
    plain.step();
    const auto t1 = Clock::now();
    ours.step();
    benchmark::DoNotOptimize(ours.snapshot());
    const auto t2 = Clock::now();
    plain_s += seconds(t1 - t0);
    ours_s += seconds(t2 - t1);
    state.SetIterationTime(seconds(t2 - t1));
  }
  state.counters["plain_ms"] = 1e3 * plain_s / static_cast<double>(state.iterations());
  state.counters["ours_over_plain"] = ours_s / plain_s;
}

BENCHMARK(equal_bits_against_plain_bullet)->Arg(5000)->Iterations(60)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace aurasim
