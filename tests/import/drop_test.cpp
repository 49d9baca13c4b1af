// What was imported can be simulated: joints hold, and nothing flies apart.
#include "import/imported.h"
#include "physics/region_world.h"

namespace aurasim::importing {
namespace {

constexpr double kLoosest_m = 0.02;  ///< at a blow
constexpr double kFastest_m_s = 15;

class Simulated : public ::testing::TestWithParam<std::string> {
 protected:
  core::Pose now(core::BodyId id) {
    for (const core::BodyRecord& record : world_.records()) {
      if (record.id == id) return {record.p_WB, core::Quat(record.R_WB)};
    }
    throw std::logic_error("the body is gone");
  }

  /// Where the joint's origin has gone with the body.
  core::Vec3 carried(const core::JointSpec& joint, core::BodyId id) {
    return (now(id) * inverse(core::find_body(scene_, id)->pose) * joint.X_WJ).p_WB;
  }

  bool holds_its_origin(const core::JointSpec& joint) const {
    if (const auto* spring = std::get_if<core::SpringJoint>(&joint.kind)) {
      return std::all_of(spring->axes.begin(), spring->axes.begin() + 3,
                         [](const core::SpringAxis& axis) { return axis.limits && axis.limits->high == 0; });
    }
    return !std::holds_alternative<core::SliderJoint>(joint.kind);
  }

  static physics::Settings as_launched() {
    physics::Settings settings;
    settings.solver = physics::Solver::kSoftStep;
    settings.substeps = 8;
    return settings;
  }

  core::Scene scene_ = scene_of(model_of(GetParam()));
  physics::RegionWorld world_{scene_, as_launched()};
};

TEST_P(Simulated, JointsHoldForTwoSeconds) {
  std::vector<core::BodyRecord> records;
  for (const core::InitialBody& body : scene_.bodies) records.push_back(core::initial_record(body));
  world_.add(records);
  for (int step = 0; step < 120; ++step) {
    world_.step();
    for (const core::JointSpec& joint : scene_.joints) {
      if (!holds_its_origin(joint)) continue;
      const core::Vec3 b = joint.b ? carried(joint, *joint.b) : joint.X_WJ.p_WB;
      ASSERT_LT(distance(carried(joint, joint.a), b), kLoosest_m) << joint.name << " in step " << step;
    }
    for (const core::BodyRecord& record : world_.records()) {
      const double fallen = 9.81 * (step + 1) / 60.0;
      ASSERT_LT(record.v_WB.norm(), fallen + kFastest_m_s) << "step " << step;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Simulated,
                         ::testing::Values("arm.urdf", "quadruped.urdf", "car.sdf", "gripper.urdf", "nested.sdf",
                                           "pendulum.sdf", "shapes.sdf", "universal.sdf", "defaults.xml", "joints.xml",
                                           "hips.xml", "statics.xml"),
                         [](const auto& info) { return info.param.substr(0, info.param.find('.')); });

}  // namespace
}  // namespace aurasim::importing
