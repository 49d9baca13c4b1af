// The models of tests/import/models, and the scenes that become of them.
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/workspace.h"
#include "import/inertia.h"
#include "import/read_model.h"
#include "import/scene_writer.h"

namespace aurasim::importing {

inline constexpr double kAsTheLibrary = 1e-9;

inline const std::filesystem::path kModels = std::filesystem::path(AURASIM_SOURCE_DIR) / "tests/import/models";

/// Each file is read once in a run of the tests.
inline const Model& model_of(const std::string& name) {
  static std::map<std::string, Model> models;
  const auto found = models.find(name);
  return found != models.end() ? found->second : models.emplace(name, read_model(kModels / name, {})).first->second;
}

inline const std::vector<std::string>& all_models() {
  static const std::vector<std::string> names = {
      "arm.urdf",          "bracket.urdf",  "gripper.urdf",     "quadruped.urdf",   "trolley.urdf",
      "car.sdf",           "nested.sdf",    "pendulum.sdf",     "room.sdf",         "screw.sdf",
      "shapes.sdf",        "universal.sdf", "defaults.xml",     "hips.xml",         "joints.xml",
      "servos.xml",        "statics.xml",   "meshes/angle.obj", "meshes/block.stl", "meshes/pyramid.dae",
      "meshes/corner.gltf"};
  return names;
}

/// As our own reader has it.
inline core::Scene scene_of(const Model& model, const std::vector<Instance>& instances = {{}}) {
  const config::Workspace workspace;
  const SceneText text = scene_text(model, instances, workspace.folder() / "scene.yaml");
  for (const auto& [file, obj] : text.meshes) workspace.write(file.string(), obj);
  return workspace.scene(text.yaml);
}

inline const Link& link_named(const Model& model, const std::string& name) {
  return *std::ranges::find(model.links, name, &Link::name);
}

inline const Joint& joint_named(const Model& model, const std::string& name) {
  return *std::ranges::find(model.joints, name, &Joint::name);
}

/// Of a link, in the axes of the world.
inline core::Mat3 tensor_in_world(const Link& link) {
  const PrincipalInertia inertia = principal_inertia(link.I_BL);
  const core::Mat3 R_WB = body_pose(link).q_WB.toRotationMatrix();
  return R_WB * inertia.moments.asDiagonal() * R_WB.transpose();
}

template <class A, class B>
double distance(const A& a, const B& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

}  // namespace aurasim::importing
