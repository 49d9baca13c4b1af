// Scene files as parts of others.
#include <numbers>

#include "config/workspace.h"

namespace aurasim::config {
namespace {

const char* kArm = R"(name: arm
gravity: [0, 0, 0]
materials: {rubber: {friction: 0.9}, grip: {friction: 1.5}}
shapes:
  rod: {compound: {parts: [{box: {size: [1, 0.1, 0.1]}}, {sphere: {radius: 0.1}, material: grip}]}}
prototypes: {link: {shape: rod, mass: 2, material: rubber}}
statics: [{name: base, shape: rod, position: [0, 0, 1]}]
bodies:
  - {prototype: link, name: upper, id: 40, position: [1, 0, 0], velocity: [1, 0, 0], spin: [0, 1, 0]}
  - {prototype: link, name: lower, position: [2, 0, 0]}
joints: [{hinge: {}, bodies: [lower, upper], name: elbow, position: [1.5, 0, 0]}]
)";

const char* kTwoArms = R"(include:
  - {file: arm.yaml, name: left}
  - {file: arm.yaml, name: right, at: {position: [0, 5, 0], orientation: {rpy_deg: [0, 0, 90]}}}
shapes: {ball: {sphere: {radius: 1}}}
prototypes: {ball: {shape: ball, mass: 1}, spare: {shape: left/rod, mass: 3, material: left/rubber}}
statics: [{name: ground, shape: {plane: {}}}]
bodies:
  - {prototype: ball, name: prop}
  - {prototype: right/link, name: extra, id: 2}
joints: [{ball: {}, bodies: [left/lower, right/lower]}]
)";

class Includes : public testing::Test {
 protected:
  Includes() { workspace_.write("arm.yaml", kArm); }

  std::vector<std::string> errors(const std::string& scene) const { return workspace_.scene_errors(scene); }

  const Workspace workspace_;
};

std::size_t shape_named(const core::Scene& scene, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(scene.shapes, name, &core::NamedShape::name) -
                                  scene.shapes.begin());
}

TEST_F(Includes, EveryCopyHasNamesAndAPlaceOfItsOwn) {
  const core::Scene scene = workspace_.scene(kTwoArms);
  EXPECT_EQ(scene.gravity.z(), -9.81) << "that of the file that includes";
  ASSERT_EQ(scene.statics.size(), 3u);
  EXPECT_EQ(scene.statics[2].name, "right/base");
  EXPECT_TRUE(scene.statics[2].pose.p_WB.isApprox(core::Vec3(0, 5, 1)));
  ASSERT_EQ(scene.bodies.size(), 6u);
  const core::InitialBody& upper = *core::find_body(scene, core::BodyId{4});
  EXPECT_TRUE(upper.pose.p_WB.isApprox(core::Vec3(0, 6, 0)));
  EXPECT_TRUE(upper.v_WB.isApprox(core::Vec3(0, 1, 0)));
  EXPECT_TRUE(upper.w_WB.isApprox(core::Vec3(-1, 0, 0)));
  const core::Prototype& link = scene.prototypes[value_of(upper.prototype)];
  EXPECT_EQ(link.name, "right/link");
  EXPECT_EQ(link.shape, shape_named(scene, "right/rod"));
  EXPECT_EQ(scene.materials[link.material].name, "right/rubber");
  const auto& parts = std::get<core::Compound>(scene.shapes[link.shape].shape).parts;
  EXPECT_EQ(scene.materials[parts[1].material.value()].name, "right/grip");
}

TEST_F(Includes, IdsFollowThoseOfTheFileItself) {
  const core::Scene scene = workspace_.scene(kTwoArms);
  std::vector<std::pair<std::uint64_t, std::string>> found;
  for (const core::InitialBody& body : scene.bodies) {
    found.emplace_back(value_of(body.id), scene.prototypes[value_of(body.prototype)].name);
  }
  EXPECT_THAT(found, testing::ElementsAre(testing::Pair(0, "ball"), testing::Pair(1, "left/link"),
                                          testing::Pair(2, "right/link"), testing::Pair(3, "left/link"),
                                          testing::Pair(4, "right/link"), testing::Pair(5, "right/link")));
}

TEST_F(Includes, JointsBindTheirOwnCopyAndTheFilesJointsBindAny) {
  const core::Scene scene = workspace_.scene(kTwoArms);
  ASSERT_EQ(scene.joints.size(), 3u);
  EXPECT_EQ(scene.joints[0].a, core::BodyId{3});
  EXPECT_EQ(scene.joints[0].b, core::BodyId{5});
  EXPECT_EQ(scene.joints[2].name, "right/elbow");
  EXPECT_EQ(scene.joints[2].a, core::BodyId{5});
  EXPECT_EQ(scene.joints[2].b, core::BodyId{4});
  EXPECT_TRUE(scene.joints[2].X_WJ.p_WB.isApprox(core::Vec3(0, 6.5, 0)));
}

TEST_F(Includes, FilesMayIncludeFilesAndMeshesLieBesideThem) {
  workspace_.write("parts/cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  workspace_.write("parts/rock.yaml", "statics: [{name: rock, shape: {mesh: {file: cube.obj}}}]\n");
  workspace_.write("garden.yaml",
                   "include: [{file: parts/rock.yaml, name: one, at: {position: [1, 0, 0]}}]\n"
                   "injectors:\n  - {name: rain, rate: 1, count: 5, volume: {center: [0, 0, 9], size: [1, 1, 1]}, "
                   "prototypes: [drop]}\nprototypes: {drop: {shape: {sphere: {radius: 1}}, mass: 1}}\n");
  const core::Scene scene = workspace_.scene(
      "include: [{file: garden.yaml, name: a}, {file: garden.yaml, name: b, at: {position: [10, 0, 0]}}]\n");
  ASSERT_EQ(scene.statics.size(), 2u);
  EXPECT_EQ(scene.statics[1].name, "b/one/rock");
  EXPECT_EQ(scene.statics[1].pose.p_WB.x(), 11);
  ASSERT_EQ(scene.injectors.size(), 2u);
  EXPECT_EQ(scene.injectors[1].name, "b/rain");
  EXPECT_EQ(scene.injectors[1].first_id, core::BodyId{5});
  EXPECT_EQ(scene.injectors[1].volume_min.x(), 9.5);
  EXPECT_EQ(scene.prototypes[value_of(scene.injectors[1].prototypes[0])].name, "b/drop");
}

TEST_F(Includes, WhatIsIncludedIsAgreedUpon) {
  const auto agreement = [&] {
    workspace_.write("scene.yaml", kTwoArms);
    return read_launch(workspace_.write("launch.yaml", kSmallLaunch)).agreement();
  };
  const std::uint64_t before = agreement();
  std::string heavier = kArm;
  heavier.replace(heavier.find("mass: 2"), 7, "mass: 3");
  workspace_.write("arm.yaml", heavier);
  EXPECT_NE(agreement(), before);
}

TEST_F(Includes, ErrorsAreThoseOfTheFileThatHasThem) {
  workspace_.write("bad.yaml", "gravity: [0, 0]\n");
  expect_errors(errors("include: [{file: bad.yaml, name: a}]\n"), {"bad.yaml:1:10: gravity: found a list of 2"});
}

TEST_F(Includes, CirclesAreRefusedByName) {
  workspace_.write("a.yaml", "include: [{file: b.yaml, name: b}]\n");
  workspace_.write("b.yaml", "include: [{file: a.yaml, name: a}]\n");
  expect_errors(errors("include: [{file: a.yaml, name: x}]\n"),
                {"b.yaml:1:18: include[0].file: found a circle: a.yaml includes b.yaml includes a.yaml, allowed: files "
                 "that do not include themselves"});
  expect_errors(errors("include: [{file: scene.yaml, name: x}]\n"),
                {"scene.yaml:1:18: include[0].file: found a circle: scene.yaml includes scene.yaml"});
}

TEST_F(Includes, WrongOnesAreRefusedByName) {
  expect_errors(errors("include: [{file: robot.urdf, name: x}]\n"),
                {"scene.yaml:1:18: include[0].file: found a model of another format, allowed: a scene file; `aurasim "
                 "import robot.urdf --out robot.yaml` makes one"});
  expect_errors(errors("include: [{file: arm.yaml}]\n"), {"scene.yaml:1:11: include[0].name: missing"});
  expect_errors(errors("include: [{file: arm.yaml, name: x}, {file: arm.yaml, name: x}]\n"),
                {"scene.yaml:1:61: include[1].name: found the name \"x\" a second time"});
  expect_errors(errors("include: [{file: nowhere.yaml, name: x}]\n"),
                {"nowhere.yaml:1:1: the file: found nothing to read"});
  expect_errors(errors("include: [{file: arm.yaml, name: x}]\nstatics: [{name: x/base, shape: {plane: {}}}]\n"),
                {"scene.yaml:1:11: include[0]: found the name \"x/base\" a second time"});
  expect_errors(errors("include: [{file: arm.yaml, name: x}]\nshapes: {x/rod: {sphere: {radius: 1}}}\n"),
                {"scene.yaml:2:17: shapes.x/rod: found the name \"x/rod\" a second time"});
}

TEST_F(Includes, InjectorsMayNotBeTurned) {
  workspace_.write("rain.yaml",
                   "prototypes: {drop: {shape: {sphere: {radius: 1}}, mass: 1}}\n"
                   "injectors:\n  - {name: rain, rate: 1, count: 5, volume: {center: [0, 0, 9], size: [1, 1, 1]}, "
                   "prototypes: [drop]}\n");
  expect_errors(errors("include: [{file: rain.yaml, name: x, at: {orientation: {rpy_deg: [0, 0, 45]}}}]\n"),
                {"scene.yaml:1:11: include[0]: found an injector in what is turned"});
}

}  // namespace
}  // namespace aurasim::config
