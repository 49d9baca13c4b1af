#include "agent/setpoints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>

#include <fmt/format.h>

#include "agent/problem.h"
#include "core/limits.h"
#include "core/order.h"
#include "steering/json_fields.h"

namespace aurasim::agent {
namespace {

using nlohmann::json;

constexpr std::array<const char*, core::kQuantities> kLists = {"forces", "torques", "velocities", "spins", "drivings"};
constexpr std::size_t kDriveNumbers = core::JointDrive::kNumbers;

[[noreturn]] void refuse(const std::string& why) { throw Problem(Kind::kRefused, why); }

/// Takes arrays from the front of what is left.
class Arrays {
 public:
  explicit Arrays(const std::string& bytes) : bytes_(bytes) {}

  template <class T>
  std::vector<T> take(std::size_t count) {
    if (count > (bytes_.size() - at_) / sizeof(T)) refuse("the setpoint message is shorter than its head states");
    std::vector<T> values(count);
    std::memcpy(values.data(), bytes_.data() + at_, count * sizeof(T));
    at_ += count * sizeof(T);
    return values;
  }

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

/// One list of setpoints: the number of rows, and whether they have values. Without values they end earlier setpoints.
struct Count {
  std::size_t rows = 0;
  bool has_values = false;
};

Count count_of(const json& head, const char* list) {
  const json& found = head.contains(list) ? head[list] : json();
  if (!found.is_array() || found.size() != 2) return {};
  const Count count{found[0].get<std::size_t>(), found[1].get<bool>()};
  if (count.rows > core::limits::kMostSetpoints) {
    refuse(fmt::format("{}: found {} of them, allowed: {}", list, count.rows, core::limits::kMostSetpoints));
  }
  return count;
}

/// True if the body may exist. Bodies that clients made are not checked, because they may be very new.
bool is_known(core::BodyId id, const core::Scene& scene) {
  if (core::value_of(id) >= core::kFirstClientBody || core::find_body(scene, id) != nullptr) return true;
  return std::ranges::any_of(scene.injectors, [id](const core::Injector& injector) {
    return id >= injector.first_id &&
           (injector.max_bodies == 0 || core::value_of(id) - core::value_of(injector.first_id) < injector.max_bodies);
  });
}

void check(double number, const char* list, double most = core::limits::kHardestPush) {
  if (!(std::abs(number) <= most)) {
    refuse(fmt::format("{}: found {}, allowed: at most {:g} either way", list, number, most));
  }
}

void take_bodies(const json& head, core::Quantity quantity, const core::Scene& scene, Arrays& arrays,
                 core::Setpoints& to) {
  const char* const list = kLists.at(static_cast<std::size_t>(quantity));
  const Count count = count_of(head, list);
  const auto ids = arrays.take<std::uint64_t>(count.rows);
  const auto values = arrays.take<double>(count.has_values ? 3 * count.rows : 0);
  for (const double value : values) check(value, list);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    core::BodySetpoint& body = to.bodies.emplace_back();
    body.id = core::BodyId{ids[i]}, body.quantity = quantity;
    if (!is_known(body.id, scene)) refuse(fmt::format("{}: there is no body {}", list, ids[i]));
    if (count.has_values) body.value = core::Vec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
  }
}

core::JointDrive checked(const core::JointDrive& drive, const std::string& joint) {
  for (const double number : {drive.position, drive.speed, drive.effort}) check(number, joint.c_str());
  for (const double gain : {drive.stiffness, drive.damping}) {
    check(gain, joint.c_str());
    if (gain < 0) refuse(fmt::format("{}: found a gain of {}, allowed: 0 or more", joint, gain));
  }
  if (!(drive.max_effort >= 0)) refuse(fmt::format("{}: found a largest effort of {}", joint, drive.max_effort));
  return drive;
}

void take_joints(const json& head, const core::Scene& scene, Arrays& arrays, core::Setpoints& to) {
  const Count count = count_of(head, "drives");
  const auto ids = arrays.take<std::uint32_t>(count.rows);
  const auto numbers = arrays.take<double>(count.has_values ? kDriveNumbers * count.rows : 0);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] >= scene.joints.size()) refuse(fmt::format("drives: there is no joint {}", ids[i]));
    const core::JointSpec& joint = scene.joints[ids[i]];
    const bool turns = std::holds_alternative<core::HingeJoint>(joint.kind);
    if (!turns && !std::holds_alternative<core::SliderJoint>(joint.kind)) {
      refuse(fmt::format("drives: joint \"{}\" is neither a hinge nor a slider", joint.name));
    }
    core::JointSetpoint& setpoint = to.joints.emplace_back();
    setpoint.id = core::JointId{ids[i]};
    if (!count.has_values) continue;
    const auto of_joint = std::span(numbers).subspan(kDriveNumbers * i).first<kDriveNumbers>();
    setpoint.drive = checked(core::JointDrive::of(of_joint), "drives of \"" + joint.name + '"');
  }
}

void take_statics(const json& head, const config::Launch& launch, core::Setpoints& to) {
  const json& list = head.contains("statics") ? head["statics"] : json();
  if (list.size() > core::limits::kMostStaticSetpoints) {
    refuse(fmt::format("statics: found {} of them, allowed: {}", list.size(), core::limits::kMostStaticSetpoints));
  }
  for (const json& of : list) {
    if (!launch.physics.looks_once()) {
      refuse(fmt::format("the solver {} cannot move statics", launch.physics.solver));
    }
    core::StaticSetpoint& wanted = to.statics.emplace_back();
    wanted.id = steering::static_of(steering::member(of, "static"), launch.scene, "static");
    wanted.to = {steering::vector_of(of, "p"), steering::rotation_of(of, "q")};
    wanted.states = of.value("states", core::Step{1});
    if (!(wanted.to.p_WB.cwiseAbs().maxCoeff() <= core::limits::kFarthestPlace_m)) {
      refuse(fmt::format("statics: found a position too far out, allowed: {:g} m along each axis",
                         core::limits::kFarthestPlace_m));
    }
    if (wanted.states < 1 || wanted.states > core::limits::kMostStepsAhead) {
      refuse(fmt::format("statics: found {} states, allowed: 1 to {}", wanted.states, core::limits::kMostStepsAhead));
    }
    const std::uint32_t index = core::value_of(wanted.id);
    if (index >= launch.scene.statics.size()) continue;  // added by a client: nodes check it
    const core::StaticBody& fixed = launch.scene.statics[index];
    if (std::holds_alternative<core::Plane>(launch.scene.shapes[fixed.shape].shape)) refuse("a plane cannot move");
  }
}

}  // namespace

core::Setpoints setpoints_of(const client::Message& message, const config::Launch& launch) {
  const core::Scene& scene = launch.scene;
  core::Setpoints setpoints;
  Arrays arrays(message.body);
  for (int i = 0; i < core::kQuantities; ++i) {
    take_bodies(message.head, static_cast<core::Quantity>(i), scene, arrays, setpoints);
  }
  take_joints(message.head, scene, arrays, setpoints);
  take_statics(message.head, launch, setpoints);
  setpoints.at_step = message.head.value("at", core::Step{0});
  if (setpoints.at_step < 0) refuse(fmt::format("at: found {}, allowed: 0 or more", setpoints.at_step));
  return setpoints;
}

}  // namespace aurasim::agent
