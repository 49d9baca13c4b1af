// From a scene to SDF, and back again.
#include <cmath>

#include "import/imported.h"
#include "import/sdf_writer.h"
#include "physics/hull_triangles.h"

namespace aurasim::importing {
namespace {

class ThereAndBack : public ::testing::TestWithParam<std::string> {
 protected:
  ThereAndBack() {
    std::vector<std::string> names;
    for (const Link& link : model_of(GetParam()).links) {
      if (!link.is_static) names.push_back(link.name);
    }
    written_ = sdf_text(scene_, names, "world.sdf", physics::hull_triangles);
    for (const auto& [file, obj] : written_.meshes) workspace_.write(file.string(), obj);
    back_ = scene_of(read_model(workspace_.write("world.sdf", written_.xml), {}));
  }

  static double mass(const core::Scene& scene, const core::InitialBody& of) {
    return scene.prototypes[core::value_of(of.prototype)].mass_kg;
  }

  /// Bodies come back in the order of the models; some share their centre.
  const core::InitialBody* at(const core::Vec3& p_W, double mass_kg) const {
    for (const core::InitialBody& body : back_.bodies) {
      if (distance(body.pose.p_WB, p_W) < kAsTheLibrary && mass(back_, body) == mass_kg) return &body;
    }
    return nullptr;
  }

  config::Workspace workspace_;
  core::Scene scene_ = scene_of(model_of(GetParam()));
  SdfText written_;
  core::Scene back_;
};

TEST_P(ThereAndBack, BodiesAreTheSame) {
  ASSERT_EQ(back_.bodies.size(), scene_.bodies.size());
  for (const core::InitialBody& body : scene_.bodies) {
    const core::InitialBody* const same = at(body.pose.p_WB, mass(scene_, body));
    ASSERT_NE(same, nullptr) << core::value_of(body.id);
    EXPECT_LT(distance(same->pose.q_WB.toRotationMatrix(), body.pose.q_WB.toRotationMatrix()), kAsTheLibrary);
    const core::Prototype& before = scene_.prototypes[core::value_of(body.prototype)];
    const core::Prototype& after = back_.prototypes[core::value_of(same->prototype)];
    EXPECT_LT(distance(*after.inertia, *before.inertia), kAsTheLibrary);
    EXPECT_EQ(after.collides, before.collides);
  }
  EXPECT_EQ(back_.gravity, scene_.gravity);
  EXPECT_EQ(back_.statics.size(), scene_.statics.size());
}

TEST_P(ThereAndBack, JointsAreTheSame) {
  ASSERT_EQ(back_.joints.size(), scene_.joints.size());
  for (const core::JointSpec& joint : scene_.joints) {
    const auto is_same = [&joint](const core::JointSpec& other) {
      return other.kind.index() == joint.kind.index() && other.b.has_value() == joint.b.has_value() &&
             distance(other.X_WJ.p_WB, joint.X_WJ.p_WB) < kAsTheLibrary &&
             distance(other.X_WJ.q_WB * core::Vec3::UnitZ(), joint.X_WJ.q_WB * core::Vec3::UnitZ()) < kAsTheLibrary;
    };
    EXPECT_TRUE(std::ranges::any_of(back_.joints, is_same)) << joint.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, ThereAndBack,
                         ::testing::Values("arm.urdf", "quadruped.urdf", "car.sdf", "gripper.urdf", "nested.sdf",
                                           "shapes.sdf", "bracket.urdf", "trolley.urdf"),
                         [](const auto& info) { return info.param.substr(0, info.param.find('.')); });

TEST(Export, WhatSdfCannotSayIsNamed) {
  core::Scene scene = scene_of(model_of("hips.xml"));
  scene.shapes.push_back({"gate", core::Sphere{}});
  core::StaticBody gate;
  gate.name = "gate";
  gate.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
  gate.belt_S = {1, 0, 0};
  gate.path = {{{1, {}}}, false, true};
  scene.statics.push_back(gate);
  const SdfText text = sdf_text(scene, std::vector<std::string>(scene.bodies.size()), "x.sdf", physics::hull_triangles);
  std::vector<std::string> elements;
  for (const Finding& finding : text.lost) elements.push_back(finding.element);
  EXPECT_THAT(elements, ::testing::UnorderedElementsAre("joint 'hip_z'", "joint 'strut'", "joint 'puck_x'",
                                                        "static 'gate'", "static 'gate'"));
}

}  // namespace
}  // namespace aurasim::importing
