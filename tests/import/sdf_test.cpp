// SDF and URDF, beside what sdformat says of the same file.
#include <sdf/sdf.hh>

#include "import/imported.h"

namespace aurasim::importing {
namespace {

core::Vec3 ours(const ignition::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }
core::Pose ours(const ignition::math::Pose3d& pose) {
  return {ours(pose.Pos()), core::Quat(pose.Rot().W(), pose.Rot().X(), pose.Rot().Y(), pose.Rot().Z())};
}

/// sdformat's own way through a file: it resolves names through models in models.
class BesideSdformat : public ::testing::TestWithParam<std::string> {
 protected:
  /// Each file is read once in a run of the tests.
  static const sdf::Root& root_of(const std::string& name) {
    static std::map<std::string, sdf::Root> roots;
    if (const auto found = roots.find(name); found != roots.end()) return found->second;
    sdf::Console::Instance()->SetQuiet(true);
    sdf::ParserConfig config;
    config.SetFindCallback([](const std::string& uri) { return (kModels / uri.substr(uri.find("//") + 2)).string(); });
    sdf::Root& root = roots[name];
    const sdf::Errors errors = root.Load((kModels / name).string(), config);
    EXPECT_TRUE(errors.empty()) << errors.front().Message();
    return root;
  }

  /// The outermost model and the rest of a name.
  std::pair<const sdf::Model*, std::string> split(const std::string& name) const {
    if (root_.Model() != nullptr) return {root_.Model(), name};
    const std::size_t at = name.find("::");
    return {root_.WorldByIndex(0)->ModelByName(name.substr(0, at)), name.substr(at + 2)};
  }

  core::Pose pose_of_model(const sdf::Model& model) const {
    if (root_.Model() != nullptr) return ours(model.RawPose());
    ignition::math::Pose3d pose;
    EXPECT_TRUE(model.SemanticPose().Resolve(pose).empty());
    return ours(pose);
  }

  /// In the world, by way of the first link of the outermost model.
  core::Pose pose_of_link(const std::string& name) const {
    const auto [model, rest] = split(name);
    ignition::math::Pose3d X_MF, X_LF;
    const sdf::SemanticPose first = model->LinkByIndex(0)->SemanticPose();
    EXPECT_TRUE(first.Resolve(X_MF, "__model__").empty());
    EXPECT_TRUE(first.Resolve(X_LF, rest).empty());
    return pose_of_model(*model) * ours(X_MF) * inverse(ours(X_LF));
  }

  const sdf::Root& root_ = root_of(GetParam());
  const Model& model_ = model_of(GetParam());
};

TEST_P(BesideSdformat, LinksAreWhereSdformatHasThem) {
  for (const Link& link : model_.links) {
    const core::Pose expected = pose_of_link(link.name);
    EXPECT_LT(distance(link.X_WL.p_WB, expected.p_WB), kAsTheLibrary) << link.name;
    EXPECT_LT(link.X_WL.q_WB.angularDistance(expected.q_WB), 1e-8) << link.name;
    EXPECT_LT(distance(link.X_WL.q_WB.toRotationMatrix(), expected.q_WB.toRotationMatrix()), kAsTheLibrary);
  }
}

TEST_P(BesideSdformat, MassesAndMomentsAreThoseOfSdformat) {
  for (const Link& link : model_.links) {
    if (link.is_static) continue;
    const auto [model, rest] = split(link.name);
    const ignition::math::Inertiald& expected = model->LinkByName(rest)->Inertial();
    EXPECT_EQ(link.mass_kg, expected.MassMatrix().Mass());
    core::Vec3 moments = principal_inertia(link.I_BL).moments, theirs = ours(expected.MassMatrix().PrincipalMoments());
    std::ranges::sort(moments);
    std::ranges::sort(theirs);
    EXPECT_LT(distance(moments, theirs), kAsTheLibrary) << link.name;

    const core::Pose X_WI = pose_of_link(link.name) * ours(expected.Pose());
    EXPECT_LT(distance(body_pose(link).p_WB, X_WI.p_WB), kAsTheLibrary) << link.name;
    const ignition::math::Matrix3d in_link = expected.Moi();
    core::Mat3 tensor;
    for (int i = 0; i < 9; ++i) tensor(i / 3, i % 3) = in_link(i / 3, i % 3);
    const core::Mat3 R_WL = pose_of_link(link.name).q_WB.toRotationMatrix();
    EXPECT_LT(distance(tensor_in_world(link), core::Mat3(R_WL * tensor * R_WL.transpose())), kAsTheLibrary)
        << link.name;
  }
}

TEST_P(BesideSdformat, JointsAreWhereSdformatHasThem) {
  for (const Joint& joint : model_.joints) {
    const auto [model, rest] = split(joint.name);
    const sdf::Joint* expected = model->JointByName(rest);
    ASSERT_NE(expected, nullptr) << joint.name;
    ignition::math::Pose3d X_CJ;
    ASSERT_TRUE(expected->SemanticPose().Resolve(X_CJ).empty());
    const core::Pose X_WC = pose_of_link(model_.links[joint.child].name);
    EXPECT_LT(distance(joint.X_WJ.p_WB, (X_WC * ours(X_CJ)).p_WB), kAsTheLibrary) << joint.name;
    if (expected->Axis(0) == nullptr || expected->Axis(1) != nullptr) continue;
    ignition::math::Vector3d axis_C;
    ASSERT_TRUE(expected->Axis(0)->ResolveXyz(axis_C, expected->ChildLinkName()).empty());
    const core::Vec3 axis_W = (X_WC.q_WB * ours(axis_C)).normalized();
    EXPECT_LT(distance(core::Vec3(joint.X_WJ.q_WB * core::Vec3::UnitZ()), axis_W), kAsTheLibrary) << joint.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, BesideSdformat,
                         ::testing::Values("arm.urdf", "bracket.urdf", "gripper.urdf", "quadruped.urdf", "trolley.urdf",
                                           "car.sdf", "nested.sdf", "pendulum.sdf", "room.sdf", "screw.sdf",
                                           "shapes.sdf", "universal.sdf"),
                         [](const auto& info) { return info.param.substr(0, info.param.find('.')); });

TEST(Sdf, AFixedJointOfUrdfMakesOneLinkOfTwo) {
  const Model trolley = model_of("trolley.urdf");
  ASSERT_EQ(trolley.links.size(), 2u);
  EXPECT_NEAR(link_named(trolley, "deck").mass_kg, 9.7, 1e-12);
  EXPECT_EQ(link_named(trolley, "deck").collisions.size(), 4u);
}

TEST(Sdf, AFixedJointOfSdfIsKept) {
  const Joint anchor = joint_named(model_of("nested.sdf"), "anchor");
  EXPECT_TRUE(std::holds_alternative<core::FixedJoint>(anchor.kind));
  EXPECT_FALSE(anchor.parent);
}

TEST(Sdf, DampingAndSpringAreThoseOfASlider) {
  const auto slider = std::get<core::SliderJoint>(joint_named(model_of("car.sdf"), "slide_fl").kind);
  EXPECT_EQ(slider.resistance.stiffness, 25000);
  EXPECT_EQ(slider.resistance.damping, 1500);
  EXPECT_EQ(slider.limits->low, -0.1);
  EXPECT_EQ(slider.limits->high, 0.12);
}

TEST(Sdf, FrictionAndLimitsOfNearlyATurnAreThoseOfAHinge) {
  const auto hinge = std::get<core::HingeJoint>(joint_named(model_of("pendulum.sdf"), "swivel").kind);
  EXPECT_EQ(hinge.resistance.friction, 0.1);
  EXPECT_EQ(hinge.limits->high, 6.28);
}

TEST(Sdf, WithoutSelfCollideNoTwoLinksOfAModelTouch) {
  const Model quadruped = model_of("quadruped.urdf");
  EXPECT_EQ(quadruped.apart.size() + quadruped.joints.size(), 13u * 12 / 2);
  EXPECT_TRUE(model_of("shapes.sdf").apart.empty()) << "each is a model of its own";
  EXPECT_TRUE(model_of("pendulum.sdf").apart.empty()) << "self_collide";
}

TEST(Sdf, AUniversalJointTurnsAboutTwoAxes) {
  const Joint cardan = joint_named(model_of("universal.sdf"), "cardan");
  const auto spring = std::get<core::SpringJoint>(cardan.kind);
  EXPECT_EQ(spring.axes[3].limits->high, 0.9);
  EXPECT_EQ(spring.axes[3].damping, 0.2);
  EXPECT_EQ(spring.axes[4].limits->high, 0);
  EXPECT_EQ(spring.axes[5].limits->low, -0.7);
}

TEST(Sdf, AMimicFollowsItsJointNoStrongerThanItsLimitSays) {
  const Model model = model_of("gripper.urdf");
  const core::JointKind& kind = joint_named(model, "right_slide").kind;
  const auto coupling = core::coupling_of(kind);
  ASSERT_TRUE(coupling);
  EXPECT_EQ(model.joints.at(core::value_of(coupling->leader)).name, "left_slide");
  EXPECT_EQ(coupling->ratio, 1);
  EXPECT_EQ(core::drive_of(kind)->max_effort, 20);
  EXPECT_GT(core::drive_of(kind)->stiffness, 1e4);
  EXPECT_THAT(model.notes, ::testing::Contains(::testing::Field(&Finding::element, "joint 'right_slide'/mimic")));
}

std::vector<std::string> lost_elements(const std::string& name) {
  std::vector<std::string> elements;
  for (const Finding& finding : model_of(name).lost) elements.push_back(finding.element);
  return elements;
}

TEST(Sdf, WhatASceneCannotSayIsNamed) {
  using ::testing::Contains;
  using ::testing::IsEmpty;
  EXPECT_THAT(lost_elements("gripper.urdf"), IsEmpty());
  EXPECT_THAT(lost_elements("screw.sdf"), Contains("joint 'thread'"));
  EXPECT_THAT(lost_elements("shapes.sdf"), Contains("link 'ellipsoid::link'/collision 'c'"));
  EXPECT_THAT(lost_elements("arm.urdf"), IsEmpty());
}

}  // namespace
}  // namespace aurasim::importing
