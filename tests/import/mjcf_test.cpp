// MJCF, beside what mj_forward says of the same file.
#include <memory>

#include <mujoco/mujoco.h>

#include "import/imported.h"

namespace aurasim::importing {
namespace {

core::Vec3 vec3(const mjtNum* p) { return {p[0], p[1], p[2]}; }

core::Mat3 mat3(const mjtNum* m) {
  core::Mat3 result;
  for (int i = 0; i < 9; ++i) result(i / 3, i % 3) = m[i];
  return result;
}

class BesideMujoco : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    char error[1000] = "";
    m_.reset(mj_loadXML((kModels / GetParam()).c_str(), nullptr, error, sizeof error));
    ASSERT_NE(m_, nullptr) << error;
    d_.reset(mj_makeData(m_.get()));
    mj_forward(m_.get(), d_.get());
  }

  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> m_{nullptr, mj_deleteModel};
  std::unique_ptr<mjData, decltype(&mj_deleteData)> d_{nullptr, mj_deleteData};
  const Model& model_ = model_of(GetParam());
};

TEST_P(BesideMujoco, BodiesAreWhereMujocoHasThem) {
  for (const Link& link : model_.links) {
    if (link.is_static) continue;
    const int body = mj_name2id(m_.get(), mjOBJ_BODY, link.name.c_str());
    ASSERT_GT(body, 0) << link.name;
    double mass = 0;
    core::Vec3 moment = core::Vec3::Zero();
    for (int i = 0; i < m_->nbody; ++i) {
      if (m_->body_weldid[i] != body) continue;
      mass += m_->body_mass[i];
      moment += m_->body_mass[i] * vec3(d_->xipos + 3 * i);
    }
    const core::Vec3 centre = moment / mass;
    core::Mat3 tensor = core::Mat3::Zero();
    for (int i = 0; i < m_->nbody; ++i) {
      if (m_->body_weldid[i] != body) continue;
      const core::Mat3 R = mat3(d_->ximat + 9 * i);
      const core::Vec3 away = vec3(d_->xipos + 3 * i) - centre;
      tensor += R * vec3(m_->body_inertia + 3 * i).asDiagonal() * R.transpose();
      tensor += m_->body_mass[i] * (away.squaredNorm() * core::Mat3::Identity() - away * away.transpose());
    }
    EXPECT_NEAR(link.mass_kg, mass, kAsTheLibrary * mass);
    EXPECT_LT(distance(body_pose(link).p_WB, centre), kAsTheLibrary) << link.name;
    EXPECT_LT(distance(tensor_in_world(link), tensor), kAsTheLibrary) << link.name;
  }
}

TEST_P(BesideMujoco, AnchorsAndAxesAreThoseOfMujoco) {
  for (const Joint& joint : model_.joints) {
    const int id = mj_name2id(m_.get(), mjOBJ_JOINT, joint.name.c_str());
    if (id < 0) continue;  // an equality constraint
    const int count = m_->body_jntnum[m_->jnt_bodyid[id]];
    const int last = id + count - 1;
    EXPECT_LT(distance(joint.X_WJ.p_WB, vec3(d_->xanchor + 3 * last)), kAsTheLibrary) << joint.name;
    if (count > 1 || m_->jnt_type[id] == mjJNT_BALL) continue;
    EXPECT_LT(distance(core::Vec3(joint.X_WJ.q_WB * core::Vec3::UnitZ()), vec3(d_->xaxis + 3 * id)), kAsTheLibrary)
        << joint.name;
  }
}

TEST_P(BesideMujoco, ShapesAreWhereMujocoHasThem) {
  for (const Link& link : model_.links) {
    for (const Collision& collision : link.collisions) {
      const int geom = mj_name2id(m_.get(), mjOBJ_GEOM, collision.name.c_str());
      if (geom < 0) continue;  // it has no name
      const core::Pose X_WC = link.X_WL * collision.X_LC;
      EXPECT_LT(distance(X_WC.p_WB, vec3(d_->geom_xpos + 3 * geom)), kAsTheLibrary) << collision.name;
      EXPECT_LT(distance(X_WC.q_WB.toRotationMatrix(), mat3(d_->geom_xmat + 9 * geom)), kAsTheLibrary);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, BesideMujoco,
                         ::testing::Values("defaults.xml", "hips.xml", "joints.xml", "servos.xml", "statics.xml"),
                         [](const auto& info) { return info.param.substr(0, info.param.find('.')); });

TEST(Mjcf, DefaultsOfClassesReachTheirElements) {
  const Model model = model_of("defaults.xml");
  const auto lift = std::get<core::HingeJoint>(joint_named(model, "lift").kind);
  EXPECT_NEAR(lift.limits->low, -80 * std::acos(-1) / 180, 1e-12);
  EXPECT_EQ(lift.resistance.damping, 0.2);
  EXPECT_EQ(link_named(model, "upper").collisions.front().surface.friction, 0.64);
  EXPECT_EQ(model.gravity->z(), -9.5);
}

TEST(Mjcf, ConnectAndWeldAreBallAndFixedJointsThatCollide) {
  const Model model = model_of("defaults.xml");
  EXPECT_TRUE(std::holds_alternative<core::BallJoint>(joint_named(model, "tie").kind));
  EXPECT_TRUE(joint_named(model, "tie").collide);
  EXPECT_TRUE(std::holds_alternative<core::FixedJoint>(joint_named(model, "glue").kind));
}

TEST(Mjcf, OneJointFollowsAnotherAsItsLineSays) {
  const Model model = model_of("defaults.xml");
  const auto coupling = core::coupling_of(joint_named(model, "bend").kind);
  ASSERT_TRUE(coupling);
  EXPECT_EQ(model.joints.at(core::value_of(coupling->leader)).name, "lift");
  EXPECT_EQ(coupling->ratio, 0.5);
}

TEST(Mjcf, LimitsAreThoseFromTheReference) {
  const auto knee = std::get<core::HingeJoint>(joint_named(model_of("joints.xml"), "knee").kind);
  EXPECT_NEAR(knee.limits->low, -0.7, 1e-12);
  EXPECT_NEAR(knee.limits->high, 0.9, 1e-12);
}

TEST(Mjcf, PositionAndVelocityServosAreDrives) {
  const Model model = model_of("servos.xml");
  EXPECT_EQ(std::get<core::HingeJoint>(joint_named(model, "lift").kind).drive->stiffness, 200) << "kp gear^2";
  EXPECT_EQ(std::get<core::HingeJoint>(joint_named(model, "spin").kind).drive->damping, 3);
  EXPECT_EQ(std::get<core::HingeJoint>(joint_named(model, "roll").kind).resistance.friction, 0.1);
}

TEST(Mjcf, BitsThatLetGeomsThroughKeepBodiesApart) {
  const Model model = model_of("servos.xml");
  EXPECT_EQ(model.apart.size(), 2u) << "the fan from arm and hand";
}

TEST(Mjcf, WhatASceneCannotSayIsNamed) {
  std::vector<std::string> elements;
  for (const char* name : {"defaults.xml", "servos.xml", "hips.xml"}) {
    for (const Finding& finding : model_of(name).lost) elements.push_back(finding.element);
  }
  for (const char* expected : {"equality 'gear'", "tendon 'cord'", "actuator 'pull'", "joint 'spin'", "body 'odd'"})
    EXPECT_THAT(elements, ::testing::Contains(expected));
}

}  // namespace
}  // namespace aurasim::importing
