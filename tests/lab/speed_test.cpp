// Scenes for other engines, and what is told of them: the text loses nothing, our step makes sense of every scene, and
// the errors can tell right from wrong.
#include "lab/speed/speed.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/peers/scene.h"
#include "lab/speed/overlap.h"
#include "lab/speed/scene_text.h"
#include "scratch_folder.h"

namespace aurasim::lab {
namespace {

using core::Vec3;

class SpeedTest : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& text) const { return scratch_.write("text.txt", text); }

  /// The errors of our step with the first of its settings.
  SpeedErrors run_quick(const std::string& name) const {
    const SpeedScene scene = speed_scene(name, SceneSize::kQuick);
    std::ostringstream states;
    const SpeedRun run = run_speed(scene, speed_settings().front(), states);
    EXPECT_EQ(run.steps, scene.steps);
    EXPECT_GT(run.cpu_ms, 0);
    EXPECT_LE(run.late_cpu_ms, run.cpu_ms);
    EXPECT_LE(run.body_steps, static_cast<double>(scene.scene.bodies.size()) * static_cast<double>(run.steps));
    return errors_of(scene, read_states(file(states.str()), scene));
  }

  test::ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
};

/// A state in which nothing has moved.
SeenState first_state(const SpeedScene& all) {
  SeenState state{1, {}};
  for (const core::InitialBody& body : all.scene.bodies) state.bodies.push_back(core::initial_record(body));
  return state;
}

bool same(const peers::Vec3& a, const Vec3& b) { return a.x == b.x() && a.y == b.y() && a.z == b.z(); }
bool same(const peers::Quat& a, const core::Quat& b) {
  return a.w == b.w() && a.x == b.x() && a.y == b.y() && a.z == b.z();
}

TEST_F(SpeedTest, DriversOfOtherEnginesReadWhatWeWrite) {
  for (const std::string& name : speed_scene_names()) {
    const SpeedScene ours = speed_scene(name, SceneSize::kQuick);
    const peers::Scene theirs = peers::read_scene(file(scene_text(ours)).string());
    EXPECT_EQ(theirs.name, name);
    EXPECT_EQ(theirs.steps, ours.steps);
    EXPECT_EQ(theirs.step_s, 1.0 / ours.step_hz);
    EXPECT_TRUE(same(theirs.gravity, ours.scene.gravity));
    EXPECT_EQ(theirs.sleeping, ours.scene.prototypes.front().can_sleep);
    EXPECT_EQ(theirs.shapes.size(), ours.scene.shapes.size());
    ASSERT_EQ(theirs.materials.size(), ours.scene.materials.size());
    for (std::size_t i = 0; i < theirs.materials.size(); ++i) {
      EXPECT_EQ(theirs.materials[i].friction, ours.scene.materials[i].friction);
      EXPECT_EQ(theirs.materials[i].restitution, ours.scene.materials[i].restitution);
    }
    ASSERT_EQ(theirs.statics.size(), ours.scene.statics.size());
    for (std::size_t i = 0; i < theirs.statics.size(); ++i) {
      EXPECT_EQ(theirs.statics[i].shape, ours.scene.statics[i].shape);
      EXPECT_TRUE(same(theirs.statics[i].p, ours.scene.statics[i].pose.p_WB));
      EXPECT_TRUE(same(theirs.statics[i].q, ours.scene.statics[i].pose.q_WB));
    }
    ASSERT_EQ(theirs.kinds.size(), ours.scene.prototypes.size());
    ASSERT_EQ(theirs.bodies.size(), ours.scene.bodies.size());
    for (std::size_t i = 0; i < theirs.bodies.size(); ++i) {
      const peers::Body& body = theirs.bodies[i];
      const core::InitialBody& first = ours.scene.bodies[i];
      EXPECT_TRUE(same(body.p, first.pose.p_WB) && same(body.q, first.pose.q_WB));
      EXPECT_TRUE(same(body.v, first.v_WB) && same(body.w, first.w_WB));
      EXPECT_EQ(body.birth, ours.births[i]);
      EXPECT_EQ(theirs.kinds[body.kind].mass, ours.scene.prototypes[core::value_of(first.prototype)].mass_kg);
    }
    ASSERT_EQ(theirs.joints.size(), ours.scene.joints.size());
    for (std::size_t i = 0; i < theirs.joints.size(); ++i) {
      const auto* hinge = std::get_if<core::HingeJoint>(&ours.scene.joints[i].kind);
      EXPECT_TRUE(same(theirs.joints[i].p, ours.scene.joints[i].X_WJ.p_WB));
      ASSERT_EQ(theirs.joints[i].is_hinge, hinge != nullptr);
      EXPECT_EQ(theirs.joints[i].high, hinge ? hinge->limits->high : 0);
    }
  }
}

TEST_F(SpeedTest, WholeScenesHaveTheBodiesThatThePageSpeaksOf) {
  const std::pair<const char*, std::size_t> expected[] = {{"rain", 9588},     {"pyramid", 5050},    {"hulls", 2000},
                                                          {"ragdolls", 4400}, {"card_houses", 600}, {"gas", 64000}};
  for (const auto& [name, bodies] : expected) {
    const SpeedScene scene = speed_scene(name, SceneSize::kWhole);
    EXPECT_EQ(scene.scene.bodies.size(), bodies) << name;
    EXPECT_TRUE(std::is_sorted(scene.births.begin(), scene.births.end())) << name;
    EXPECT_EQ(scene.steps % scene.states_every, 0) << name;
    const SpeedErrors at_first = errors_of(scene, {first_state(scene)});
    if (scene.births.back() > 0) continue;
    EXPECT_LT(at_first.overlap_m, 1e-6) << name;
    EXPECT_LT(at_first.in_static_m, 1e-6) << name;
  }
}

TEST_F(SpeedTest, ASceneInAFolderIsTheOneThatWasWrittenThere) {
  for (const SceneSize size : {SceneSize::kQuick, SceneSize::kWhole}) {
    const SpeedScene scene = speed_scene("card_houses", size);
    write_scene_text(scene, scene_file(folder_, scene.name));
    EXPECT_EQ(scene_text(scene_written_in(folder_, scene.name)), scene_text(scene));
  }
  std::ofstream(scene_file(folder_, "card_houses"), std::ios::app) << "static 0 0 0 0 0 1 0 0 0\n";
  EXPECT_THROW(scene_written_in(folder_, "card_houses"), std::runtime_error) << "it is of another version";
  EXPECT_THROW(scene_written_in(folder_, "gas"), std::runtime_error) << "it is not there";
}

TEST_F(SpeedTest, WhatEnginesMeanDifferentlyIsRefused) {
  SpeedScene damped = speed_scene("pyramid", SceneSize::kQuick);
  damped.scene.materials.front().linear_damping = 0.1;
  EXPECT_THROW(scene_text(damped), std::invalid_argument);
  SpeedScene sprung = speed_scene("ragdolls", SceneSize::kQuick);
  sprung.scene.joints.front().kind = core::SpringJoint{};
  EXPECT_THROW(scene_text(sprung), std::invalid_argument);
}

TEST_F(SpeedTest, PilesStandRagdollsHoldTogetherAndGasKeepsItsEnergy) {
  const SpeedErrors pyramid = run_quick("pyramid");
  EXPECT_EQ(pyramid.fallen, 0);
  EXPECT_LT(pyramid.sunk_m, 1e-3);
  EXPECT_LT(pyramid.overlap_m, 1e-3);
  const SpeedErrors houses = run_quick("card_houses");
  EXPECT_EQ(houses.fallen, 0);
  EXPECT_LT(houses.drift_m, 0.1);
  const SpeedErrors ragdolls = run_quick("ragdolls");
  EXPECT_LT(ragdolls.joint_gap_m, 0.05);
  EXPECT_LT(ragdolls.hinge_turn_rad, 0.2);
  EXPECT_EQ(ragdolls.lost, 0);
  const SpeedErrors gas = run_quick("gas");
  EXPECT_LT(std::abs(gas.energy), 1e-3);
  EXPECT_EQ(gas.lost, 0);
  EXPECT_GT(gas.drift_m, 1) << "it moves";
}

TEST_F(SpeedTest, WhatFallsEndsOnTheGround) {
  for (const char* name : {"rain", "hulls"}) {
    const SpeedErrors errors = run_quick(name);
    EXPECT_EQ(errors.lost, 0) << name;
    EXPECT_LT(errors.overlap_m, 0.05) << name;
    EXPECT_LT(errors.in_static_m, 0.1) << name;
    EXPECT_GT(errors.sunk_m, 1) << "it has fallen";
  }
}

TEST_F(SpeedTest, ErrorsSeeWhatHasFallenWhatIsGoneAndWhatOverlaps) {
  const SpeedScene scene = speed_scene("pyramid", SceneSize::kQuick);
  SeenState state = first_state(scene);
  EXPECT_LT(errors_of(scene, {state}).overlap_m, 1e-12);
  state.bodies.back().p_WB.z() -= 0.75;  // the top cube, into the two below
  const SpeedErrors errors = errors_of(scene, {state});
  EXPECT_EQ(errors.fallen, 1);
  EXPECT_NEAR(errors.sunk_m, 0.75, 1e-12);
  EXPECT_NEAR(errors.drift_m, 0.75, 1e-12);
  EXPECT_NEAR(errors.overlap_m, 0.5, 1e-9) << "the way out is sideways";
  EXPECT_EQ(errors.lost, 0);
  state.bodies.front().p_WB.z() = -1;
  state.bodies[1].v_WB.x() = std::numeric_limits<double>::quiet_NaN();
  state.bodies.pop_back();
  const SpeedErrors worse = errors_of(scene, {state});
  EXPECT_EQ(worse.lost, 3) << "below the ground, not a number, missing";
  EXPECT_NEAR(worse.in_static_m, 1.5, 1e-12);
}

TEST_F(SpeedTest, ErrorsSeeJointsThatGapAndHingesThatBend) {
  const SpeedScene scene = speed_scene("ragdolls", SceneSize::kQuick);
  SeenState state = first_state(scene);
  EXPECT_LT(errors_of(scene, {state}).joint_gap_m, 1e-12);
  EXPECT_LT(errors_of(scene, {state}).hinge_turn_rad, 1e-6);
  // The left shin, whose knee bends from 0 to 130 degrees about y.
  core::BodyRecord& shin = state.bodies[6];
  const auto knee_turned_by = [&](double angle, const Vec3& axis) {
    SeenState turned = state;
    const core::Mat3 turn = core::Quat(Eigen::AngleAxisd(angle, axis)).toRotationMatrix();
    const Vec3 p_knee = shin.p_WB + Vec3(0, 0, 4.72 - 4.48);
    turned.bodies[6].p_WB = p_knee + turn * (shin.p_WB - p_knee);
    turned.bodies[6].R_WB = turn;
    return errors_of(scene, {turned});
  };
  EXPECT_LT(knee_turned_by(1, Vec3::UnitY()).hinge_turn_rad, 1e-6) << "as it may";
  EXPECT_NEAR(knee_turned_by(-0.3, Vec3::UnitY()).hinge_turn_rad, 0.3, 1e-6) << "over its limit";
  EXPECT_NEAR(knee_turned_by(0.2, Vec3::UnitX()).hinge_turn_rad, 0.2, 1e-6) << "off its axis";
  EXPECT_LT(knee_turned_by(0.2, Vec3::UnitX()).joint_gap_m, 1e-9);
  shin.p_WB.x() += 0.04;
  EXPECT_NEAR(errors_of(scene, {state}).joint_gap_m, 0.04, 1e-9);
}

class OverlapsTest : public testing::Test {
 protected:
  OverlapsTest() {
    all_.scene.materials.emplace_back();
    for (const core::Shape& shape : {core::Shape(core::Sphere{0.5}), core::Shape(core::Box{}),
                                     core::Shape(core::Capsule{0.25, 1}), core::Shape(cube_as_hull())}) {
      core::Prototype prototype;
      prototype.shape = static_cast<std::uint32_t>(all_.scene.shapes.size());
      all_.scene.shapes.push_back({"", shape});
      all_.scene.prototypes.push_back(prototype);
    }
  }

  static core::ConvexHull cube_as_hull() {
    core::ConvexHull hull;
    for (int i = 0; i < 8; ++i) hull.points.emplace_back(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    return hull;
  }

  double depth(std::uint32_t a, std::uint32_t b, const Vec3& p_AB) const {
    core::BodyRecord first, second;
    first.prototype = core::PrototypeId{a};
    second.prototype = core::PrototypeId{b};
    second.id = core::BodyId{1};
    second.p_WB = p_AB;
    return Overlaps(all_.scene).between_bodies(std::vector{first, second});
  }

  static constexpr std::uint32_t kSphere = 0, kBox = 1, kCapsule = 2, kHull = 3;
  SpeedScene all_;
};

TEST_F(OverlapsTest, AreAsDeepAsTheShapesAreInEachOther) {
  EXPECT_NEAR(depth(kSphere, kSphere, {0.9, 0, 0}), 0.1, 1e-12);
  EXPECT_NEAR(depth(kBox, kBox, {0.98, 0.3, 0}), 0.02, 1e-12);
  EXPECT_NEAR(depth(kBox, kHull, {0.98, 0.3, 0}), 0.02, 1e-3);
  EXPECT_NEAR(depth(kHull, kHull, {0.1, 0.95, 0.2}), 0.05, 1e-3);
  EXPECT_NEAR(depth(kCapsule, kBox, {0.7, 0, 0.3}), 0.05, 1e-3);
  EXPECT_NEAR(depth(kSphere, kBox, {0.9, 0.9, 0}), 0, 1e-12) << "past the edge";
}

TEST_F(OverlapsTest, AreNoneWhereShapesJustTouch) {
  EXPECT_EQ(depth(kBox, kBox, {1, 0.5, 0}), 0);
  EXPECT_LT(depth(kHull, kHull, {1, 0.5, 0}), 1e-9);
  EXPECT_LT(depth(kHull, kBox, {0, 0, 1}), 1e-9);
}

}  // namespace
}  // namespace aurasim::lab
