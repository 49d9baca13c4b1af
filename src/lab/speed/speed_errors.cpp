#include "lab/speed/speed_errors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "lab/speed/overlap.h"
#include "lab/speed/scene_text.h"
#include "lab/stability/scene_builder.h"

namespace aurasim::lab {
namespace {

using core::Vec3;

bool is_somewhere(const core::BodyRecord& body) {
  return body.p_WB.allFinite() && body.R_WB.allFinite() && body.v_WB.allFinite() && body.w_WB.allFinite();
}

std::vector<core::BodyRecord> somewhere(const std::vector<core::BodyRecord>& bodies) {
  std::vector<core::BodyRecord> good;
  std::copy_if(bodies.begin(), bodies.end(), std::back_inserter(good), is_somewhere);
  return good;
}

const core::BodyRecord* record_of(std::span<const core::BodyRecord> bodies, core::BodyId id) {
  const auto at = std::lower_bound(bodies.begin(), bodies.end(), id,
                                   [](const core::BodyRecord& body, core::BodyId wanted) { return body.id < wanted; });
  return at != bodies.end() && at->id == id ? &*at : nullptr;
}

core::BodyRecord at_first(const SpeedScene& all, core::BodyId id) {
  return core::initial_record(all.scene.bodies[core::value_of(id)]);
}

/// The joint's frame, as one of its bodies has carried it along.
core::Pose carried_frame(const core::JointSpec& joint, const core::BodyRecord& first, const core::BodyRecord& now) {
  const core::Mat3 turn = now.R_WB * first.R_WB.transpose();
  return {now.p_WB + turn * (joint.X_WJ.p_WB - first.p_WB), core::Quat(turn) * joint.X_WJ.q_WB};
}

/// Error of a hinge in radians: the angle between its two axes, or the angle beyond its limits.
double wrong_turn(const core::HingeJoint& hinge, const core::Pose& of_a, const core::Pose& of_b) {
  const core::Mat3 R_BA = (of_b.q_WB.conjugate() * of_a.q_WB).toRotationMatrix();
  const double off_axis = std::acos(std::clamp(R_BA(2, 2), -1.0, 1.0));
  if (!hinge.limits) return off_axis;
  const double angle = std::atan2(R_BA(1, 0) - R_BA(0, 1), R_BA(0, 0) + R_BA(1, 1));
  const auto apart = [](double from, double to) { return std::abs(std::remainder(to - from, 2 * std::numbers::pi)); };
  if (angle >= hinge.limits->low && angle <= hinge.limits->high) return off_axis;
  return std::max(off_axis, std::min(apart(angle, hinge.limits->low), apart(angle, hinge.limits->high)));
}

void see_joints(const SpeedScene& all, std::span<const core::BodyRecord> bodies, SpeedErrors& errors) {
  for (const core::JointSpec& joint : all.scene.joints) {
    const core::BodyRecord* a = record_of(bodies, joint.a);
    const core::BodyRecord* b = joint.b ? record_of(bodies, *joint.b) : nullptr;
    if (!a || !b) continue;
    const core::Pose of_a = carried_frame(joint, at_first(all, joint.a), *a);
    const core::Pose of_b = carried_frame(joint, at_first(all, *joint.b), *b);
    errors.joint_gap_m = std::max(errors.joint_gap_m, (of_a.p_WB - of_b.p_WB).norm());
    if (const auto* hinge = std::get_if<core::HingeJoint>(&joint.kind)) {
      errors.hinge_turn_rad = std::max(errors.hinge_turn_rad, wrong_turn(*hinge, of_a, of_b));
    }
  }
}

void see_last(const SpeedScene& all, const Overlaps& overlaps, const SeenState& last, SpeedErrors& errors) {
  const std::vector<core::BodyRecord> bodies = somewhere(last.bodies);
  const auto expected =
      std::count_if(all.births.begin(), all.births.end(), [&](core::Step birth) { return birth < last.step; });
  errors.lost = static_cast<double>(expected) - static_cast<double>(bodies.size());
  std::vector<core::BodyRecord> firsts;
  for (const core::BodyRecord& body : bodies) {
    const core::BodyRecord& first = firsts.emplace_back(at_first(all, body.id));
    const double lower = first.p_WB.z() - body.p_WB.z();
    errors.drift_m = std::max(errors.drift_m, (body.p_WB - first.p_WB).norm());
    errors.sunk_m = std::max(errors.sunk_m, lower);
    if (lower > all.fallen_m) ++errors.fallen;
    if (overlaps.is_inside_a_static(body)) ++errors.lost;
  }
  const double before = energy(all.scene, firsts);
  errors.energy = before != 0 ? (energy(all.scene, bodies) - before) / before : 0;
}

/// SCENE.ENGINE.PRECISION.THREADS of a file of states.
std::vector<std::string> parts_of_name(const std::filesystem::path& file) {
  std::vector<std::string> parts(1);
  for (const char c : file.stem().string()) {
    if (c == '.') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  if (parts.size() != 4) throw std::runtime_error("which run is " + file.string() + " of?");
  return parts;
}

}  // namespace

SpeedErrors errors_of(const SpeedScene& scene, const std::vector<SeenState>& states) {
  SpeedErrors errors;
  const Overlaps overlaps(scene.scene);
  for (const SeenState& state : states) {
    const std::vector<core::BodyRecord> bodies = somewhere(state.bodies);
    errors.overlap_m = std::max(errors.overlap_m, overlaps.between_bodies(bodies));
    errors.in_static_m = std::max(errors.in_static_m, overlaps.with_statics(bodies));
    see_joints(scene, bodies, errors);
  }
  if (!states.empty()) see_last(scene, overlaps, states.back(), errors);
  return errors;
}

std::vector<StateErrors> errors_of_states(const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(directory / "states")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<StateErrors> all;
  for (const std::filesystem::path& file : files) {
    const std::vector<std::string> run = parts_of_name(file);
    const SpeedScene scene = scene_written_in(directory, run[0]);
    all.push_back({run[0], run[1], run[2], run[3], errors_of(scene, read_states(file, scene))});
  }
  return all;
}

}  // namespace aurasim::lab
