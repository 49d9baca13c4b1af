#include <set>

#include "config/workspace.h"

namespace aurasim::config {
namespace {

const char* kScene = R"(name: world
materials: {stone: {friction: 0.6}}
shapes:
  ball: {sphere: {radius: 0.5}}
  pair: {compound: {parts: [{sphere: {radius: 0.3}}, {box: {size: [1, 1, 1]}, position: [1, 0, 0]}]}}
prototypes:
  ball: {shape: ball, mass: 1, material: stone}
  pair: {shape: pair, mass: 2}
statics: [{name: ground, shape: {plane: {normal: [0, 0, 1]}}}, {name: gate, shape: ball}]
bodies: [{prototype: ball, position: [0, 0, 5], name: a}, {prototype: ball, position: [0, 0, 9], name: b}]
joints:
  - {hinge: {limits_deg: [0, 1], motor: {speed: 1, max_impulse: 1}}, bodies: [a, b], break_impulse: 3}
  - {spring: {x: {stiffness: 1}}, bodies: [a]}
  - {slider: {limits: [0, 1], drive: {stiffness: 1}}, bodies: [b]}
  - {ball: {}, bodies: [b]}
injectors:
  - {name: rain, seed: 1, rate: 1, count: 10, volume: {center: [0, 0, 9], size: [1, 1, 1]}, prototypes: [ball]}
)";

class Agreement : public testing::Test {
 protected:
  Agreement() { workspace_.write("scene.yaml", kScene); }

  std::uint64_t of(const std::vector<std::string>& overrides = {}) const {
    return read_launch(workspace_.write("launch.yaml", kSmallLaunch), overrides).agreement();
  }

  const Workspace workspace_;
};

TEST_F(Agreement, IsTheSameForTheSameContentElsewhere) {
  workspace_.write("far/away/world.yml", std::string("# the same\n") + kScene);
  const auto file =
      workspace_.write("far/launch.yaml",
                       "regions: {width: 40.0, count: 2, layout: columns}   # other order\nscene: away/world.yml\n"
                       "time: {step_hz: 60}\n");
  EXPECT_EQ(read_launch(file).agreement(), of());
}

TEST_F(Agreement, DependsOnTheLimitOfTheExchangeOnlyWhereItDecides) {
  EXPECT_NE(of({"exchange_limit=0.001"}), of());
  EXPECT_EQ(of({"exchange=aura", "exchange_limit=0.001"}), of({"exchange=aura"}));
}

TEST_F(Agreement, DoesNotDependOnHowTheRunIsConnectedAndWatched) {
  workspace_.write("qos.xml", "<dds/>");
  workspace_.write("keys/identity_ca.pem", "");
  EXPECT_EQ(of({"dds.security=keys", "dds.domain=42", "dds.profiles=qos.xml", "dds.interfaces=[10.0.0.1]",
                "dds.impair.delay=0.01", "observe.tick_hz=1"}),
            of());
  EXPECT_EQ(of({"ros2={domain: 3}"}), of());
}

TEST_F(Agreement, DiffersWithEverythingThatIsComputed) {
  std::set<std::uint64_t> seen = {of()};
  const std::vector<std::string> changes = {
      "exchange=coupled",
      "exchange=aura",
      "regions.count=3",
      "regions={layout: columns, count: 3, width: 41}",
      "regions.neighbour_distance=30",
      "time.step_hz=50",
      "time.substeps=3",
      "control.late=drop",
      "control.silence=2",
      "control.on_silence=zero",
      "time.sync=deterministic",
      "time.lookahead=3",
      "time.pace=none",
      "tolerances.speed=31",
      "tolerances.latency=0.003",
      "tolerances.frame=0.016",
      "aura.radius=tight",
      "aura.uncertainty=0.4",
      "physics.block=17",
      "physics.iterations=11",
      "physics.solver=sequential_impulse",
      "physics.friction_directions=2",
      "physics.erp=0.1",
      "physics.continuous=false",
      "scene.name=other",
      "scene.gravity=[0, 0, -9]",
      "scene.materials.stone.friction=0.5",
      "scene.materials.stone.restitution=0.5",
      "scene.shapes.ball.sphere.radius=0.4",
      "scene.shapes.pair.compound.parts.0.sphere.radius=0.2",
      "scene.shapes.pair.compound.parts.1.position=[2, 0, 0]",
      "scene.prototypes.ball.mass=3",
      "scene.prototypes.ball.can_sleep=false",
      "scene.prototypes.ball.shape=pair",
      "scene.prototypes.ball.inertia=[1, 1, 1]",
      "scene.prototypes.ball.inertia=[1, 1, 2]",
      "scene.prototypes.ball.collides=false",
      "scene.statics.0.name=floor",
      "scene.statics.0.belt=[1, 0, 0]",
      "scene.statics.1.path={stops: [{at: 1}]}",
      "scene.statics.1.path={stops: [{at: 2}]}",
      "scene.statics.1.path={stops: [{at: 1, position: [1, 0, 0]}]}",
      "scene.statics.1.path={stops: [{at: 1, orientation: {rpy_deg: [0, 0, 1]}}]}",
      "scene.statics.1.path={stops: [{at: 1}], repeats: true}",
      "scene.statics.1.path={stops: [{at: 1}], smooth: false}",
      "scene.joints.0.bodies=[b, a]",
      "scene.joints.0.bodies=[a]",
      "scene.joints.0.name=elbow",
      "scene.joints.0.position=[0, 0, 6]",
      "scene.joints.0.collide=true",
      "scene.joints.0.break_impulse=4",
      "scene.joints.0.hinge.axis=[1, 0, 0]",
      "scene.joints.0.hinge.limits_deg=[0, 2]",
      "scene.joints.0.hinge.motor.speed=2",
      "scene.joints.0.hinge.motor.max_impulse=2",
      "scene.joints.0.hinge.limits_deg=[none, 1]",
      "scene.joints.0.hinge.stiffness=1",
      "scene.joints.0.hinge.rest_deg=1",
      "scene.joints.0.hinge.damping=1",
      "scene.joints.0.hinge.friction=1",
      "scene.joints.2.slider.limits=[0, none]",
      "scene.joints.2.slider.rest=1",
      "scene.joints.2.slider.drive.position=1",
      "scene.joints.2.slider.drive.speed=1",
      "scene.joints.2.slider.drive.stiffness=2",
      "scene.joints.2.slider.drive.damping=1",
      "scene.joints.2.slider.drive.effort=1",
      "scene.joints.2.slider.drive.max_effort=1",
      "scene.joints.2.slider.follows={joint: joint 0}",
      "scene.joints.2.slider.follows={joint: joint 0, ratio: 2}",
      "scene.joints.3.ball.damping=1",
      "scene.joints.1.spring.x.rest=1",
      "scene.joints.1.spring.x.stiffness=2",
      "scene.joints.1.spring.x.damping=2",
      "scene.joints.1.spring.y={}",
      "scene.statics.0.position=[0, 0, 1]",
      "scene.bodies.0.id=5",
      "scene.bodies.0.position.0=1",
      "scene.bodies.0.velocity=[1, 0, 0]",
      "scene.bodies.0.spin=[1, 0, 0]",
      "scene.bodies.0.prototype=pair",
      "scene.bodies.0.orientation={rpy_deg: [0, 0, 1]}",
      "scene.injectors.0.seed=2",
      "scene.injectors.0.rate=2",
      "scene.injectors.0.count=11",
      "scene.injectors.0.start=1",
      "scene.injectors.0.random_orientation=true",
      "scene.injectors.0.volume.size=[1, 1, 2]",
      "scene.injectors.0.velocity={min: [0, 0, 0], max: [1, 0, 0]}",
      "scene.injectors.0.prototypes=[pair]"};
  for (const std::string& change : changes) EXPECT_TRUE(seen.insert(of({change})).second) << change;
}

TEST_F(Agreement, DoesNotSeeTheSignOfZero) { EXPECT_EQ(of({"scene.bodies.0.position=[-0.0, 0, 5]"}), of()); }

}  // namespace
}  // namespace aurasim::config
