// What is written is a scene that our own reader takes, with the same numbers.
#include <cmath>
#include <numbers>

#include "import/imported.h"
#include "import/sdf_writer.h"
#include "import/stand_ins.h"
#include "physics/hull_triangles.h"

namespace aurasim::importing {
namespace {

std::string letters_of(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

void expect_same(const std::optional<core::JointLimits>& found, const std::optional<core::JointLimits>& expected) {
  ASSERT_EQ(found.has_value(), expected.has_value());
  if (!expected) return;
  const auto expect_side = [](double side, double wanted) {
    if (std::isinf(wanted)) {
      EXPECT_EQ(side, wanted);
    } else {
      EXPECT_NEAR(side, wanted, kAsTheLibrary);
    }
  };
  expect_side(found->low, expected->low);
  expect_side(found->high, expected->high);
}

/// Of hinges and sliders.
template <class Kind>
void expect_same_own(const core::JointKind& found_kind, const core::JointKind& expected_kind) {
  const auto *found = std::get_if<Kind>(&found_kind), *expected = std::get_if<Kind>(&expected_kind);
  if (expected == nullptr) return;
  expect_same(found->limits, expected->limits);
  EXPECT_EQ(found->resistance.stiffness, expected->resistance.stiffness);
  if (expected->resistance.stiffness != 0) {
    EXPECT_NEAR(found->resistance.rest, expected->resistance.rest, kAsTheLibrary);
  }
  EXPECT_EQ(found->resistance.damping, expected->resistance.damping);
  EXPECT_EQ(found->resistance.friction, expected->resistance.friction);
  ASSERT_EQ(found->drive.has_value(), expected->drive.has_value());
  if (!expected->drive) return;
  EXPECT_NEAR(found->drive->position, expected->drive->position, kAsTheLibrary);
  core::JointDrive same = *expected->drive;
  same.position = found->drive->position;
  EXPECT_EQ(*found->drive, same);
}

class WrittenAndRead : public ::testing::TestWithParam<std::string> {
 protected:
  const Model& model_ = model_of(GetParam());
  core::Scene scene_ = scene_of(model_);

  std::vector<const Link*> moving() const {
    std::vector<const Link*> links;
    for (const Link& link : model_.links) {
      if (!link.is_static) links.push_back(&link);
    }
    return links;
  }
};

TEST_P(WrittenAndRead, BodiesHaveMassAndPose) {
  const std::vector<const Link*> links = moving();
  ASSERT_EQ(scene_.bodies.size(), links.size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    const core::InitialBody& body = scene_.bodies[i];
    const core::Pose expected = body_pose(*links[i]);
    const core::Prototype& prototype = scene_.prototypes[core::value_of(body.prototype)];
    EXPECT_EQ(prototype.mass_kg, links[i]->mass_kg);
    EXPECT_EQ(*prototype.inertia, principal_inertia(links[i]->I_BL).moments);
    EXPECT_EQ(prototype.collides, !links[i]->collisions.empty());
    EXPECT_LT(distance(body.pose.p_WB, expected.p_WB), kAsTheLibrary);
    EXPECT_LT(distance(body.pose.q_WB.toRotationMatrix(), expected.q_WB.toRotationMatrix()), kAsTheLibrary);
  }
}

TEST_P(WrittenAndRead, JointsHaveAnchorAxisAndLimits) {
  ASSERT_EQ(scene_.joints.size(), model_.joints.size() + model_.apart.size());
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    const Joint& expected = model_.joints[i];
    const core::JointSpec& joint = scene_.joints[i];
    EXPECT_EQ(joint.name, expected.name);
    EXPECT_EQ(joint.kind.index(), expected.kind.index());
    EXPECT_EQ(joint.b.has_value(), expected.parent.has_value());
    EXPECT_EQ(joint.collide, expected.collide);
    EXPECT_LT(distance(joint.X_WJ.p_WB, expected.X_WJ.p_WB), kAsTheLibrary);
    if (std::holds_alternative<core::BallJoint>(joint.kind) || std::holds_alternative<core::FixedJoint>(joint.kind))
      continue;
    EXPECT_LT(distance(joint.X_WJ.q_WB * core::Vec3::UnitZ(), expected.X_WJ.q_WB * core::Vec3::UnitZ()), kAsTheLibrary);
    expect_same_own<core::HingeJoint>(joint.kind, expected.kind);
    expect_same_own<core::SliderJoint>(joint.kind, expected.kind);
    if (const auto* spring = std::get_if<core::SpringJoint>(&joint.kind)) {
      EXPECT_LT(distance(joint.X_WJ.q_WB.toRotationMatrix(), expected.X_WJ.q_WB.toRotationMatrix()), kAsTheLibrary);
      for (std::size_t axis = 0; axis < 6; ++axis) {
        const core::SpringAxis& of = std::get<core::SpringJoint>(expected.kind).axes[axis];
        expect_same(spring->axes[axis].limits, of.limits);
        EXPECT_NEAR(spring->axes[axis].rest, of.rest, kAsTheLibrary);
        EXPECT_EQ(spring->axes[axis].stiffness, of.stiffness);
        EXPECT_EQ(spring->axes[axis].damping, of.damping);
      }
    }
  }
}

TEST_P(WrittenAndRead, ShapesAreThoseOfTheModel) {
  const std::vector<const Link*> links = moving();
  for (std::size_t i = 0; i < links.size(); ++i) {
    const core::Shape expected = body_shape(*links[i]);
    const core::Shape& shape = scene_.shapes[scene_.prototypes[core::value_of(scene_.bodies[i].prototype)].shape].shape;
    ASSERT_EQ(shape.index(), expected.index()) << links[i]->name;
    EXPECT_NEAR(core::bounding_radius(shape), core::bounding_radius(expected), kAsTheLibrary);
  }
  std::size_t statics = 0;
  for (const Link& link : model_.links) statics += link.is_static ? link.collisions.size() : 0;
  EXPECT_EQ(scene_.statics.size(), statics);
}

INSTANTIATE_TEST_SUITE_P(Models, WrittenAndRead, ::testing::ValuesIn(all_models()), letters_of);

TEST(Scene, InstancesStandWhereTheyAreToldUnderNamesOfTheirOwn) {
  const core::Quat quarter(Eigen::AngleAxisd(std::numbers::pi / 2, core::Vec3::UnitZ()));
  const Model arm = model_of("arm.urdf");
  const core::Scene scene = scene_of(arm, {{"left", {}}, {"right", {{0, 5, 0}, quarter}}});
  ASSERT_EQ(scene.bodies.size(), 14u);
  EXPECT_EQ(scene.prototypes.size(), 7u) << "shared";
  EXPECT_EQ(scene.joints.front().name, "left/foot");
  const core::Vec3 p = scene.bodies[3].pose.p_WB;
  EXPECT_LT(distance(scene.bodies[10].pose.p_WB, core::Vec3(-p.y(), p.x() + 5, p.z())), kAsTheLibrary);
}

/// A shank that slides, and a foot that grips.
TEST(Scene, EachShapeOfABodyHasItsOwnSurface) {
  const config::Workspace workspace;
  const Model model = read_model(workspace.write("leg.xml", R"(<mujoco>
  <worldbody>
    <body name="leg" pos="0 0 1">
      <freejoint/>
      <geom name="shank" type="capsule" size="0.05 0.2" friction="0.04 0 0" mass="1"/>
      <geom name="foot" type="sphere" size="0.06" pos="0 0 -0.25" friction="1.44 0 0" mass="0.2"/>
      <geom name="knee" type="sphere" size="0.06" pos="0 0 0.25" friction="0.04 0 0" mass="0.2"/>
    </body>
  </worldbody>
</mujoco>)"),
                                 {});
  EXPECT_TRUE(model.lost.empty());
  const core::Scene scene = scene_of(model);
  const core::Prototype& leg = scene.prototypes.at(0);
  EXPECT_NEAR(scene.materials[leg.material].friction, 0.2, 1e-12) << "the root: of a pair it is the product";
  const auto& parts = std::get<core::Compound>(scene.shapes[leg.shape].shape).parts;
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_FALSE(parts[0].material.has_value());
  EXPECT_NEAR(scene.materials[parts[1].material.value()].friction, 1.2, 1e-12);
  EXPECT_FALSE(parts[2].material.has_value()) << "as the body's";

  const SdfText written = sdf_text(scene, {"leg"}, "leg.sdf", physics::hull_triangles);
  const Model back = read_model(workspace.write("leg.sdf", written.xml), {});
  std::vector<double> frictions;
  for (const Collision& collision : back.links.at(0).collisions) frictions.push_back(collision.surface.friction);
  EXPECT_THAT(frictions, ::testing::ElementsAre(::testing::DoubleNear(0.04, 1e-12), ::testing::DoubleNear(1.44, 1e-12),
                                                ::testing::DoubleNear(0.04, 1e-12)));
}

TEST(Scene, FrictionAndRestitutionOfTwoEqualSurfacesAreThoseOfTheFile) {
  const core::Scene scene = scene_of(model_of("shapes.sdf"));
  const core::Material& ground = scene.materials[scene.statics[0].material];
  EXPECT_NEAR(ground.friction * ground.friction, 0.49, 1e-12);
  EXPECT_NEAR(ground.restitution * ground.restitution, 0.25, 1e-12);
  EXPECT_EQ(scene.gravity.z(), -3.7);
}

TEST(Scene, WhatIsKeptApartIsJoinedByWhatHoldsNothing) {
  const core::Scene scene = scene_of(model_of("servos.xml"));
  const auto free = std::get<core::SpringJoint>(scene.joints.back().kind);
  for (const core::SpringAxis& axis : free.axes) EXPECT_FALSE(axis.limits);
  EXPECT_FALSE(scene.joints.back().collide);
}

TEST(Scene, EachInstanceOfAGripperFollowsItsOwnFinger) {
  const core::Scene scene = scene_of(model_of("gripper.urdf"), {{"a", {}}, {"b", {}}});
  for (const core::JointSpec& joint : scene.joints) {
    const auto coupling = core::coupling_of(joint.kind);
    EXPECT_EQ(coupling.has_value(), joint.name.ends_with("right_slide"));
    if (coupling) {
      EXPECT_EQ(scene.joints.at(core::value_of(coupling->leader)).name, joint.name.substr(0, 1) + "/left_slide");
    }
  }
}

TEST(Scene, TheFileSaysWhatIsLost) {
  const SceneText text = scene_text(model_of("screw.sdf"), {{}}, "x.yaml");
  EXPECT_THAT(text.yaml, ::testing::StartsWith("# not as in the file: "));
  EXPECT_THAT(text.yaml, ::testing::HasSubstr("\n# not as in the file: joint 'thread': "));
}

}  // namespace
}  // namespace aurasim::importing
