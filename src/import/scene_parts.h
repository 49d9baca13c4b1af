// Writes poses, shapes and joints as YAML. Only for the scene writer.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "import/model.h"

namespace aurasim::importing {
namespace {

using core::Vec3;

constexpr double kDegreesOfRadian = 180 / std::numbers::pi;

/// Writes a number with as few digits as give the same bits back.
std::string digits(double number) { return fmt::format("{}", number + 0.0); }

/// Writes a vector on one line.
YAML::Emitter& operator<<(YAML::Emitter& out, const Vec3& v) {
  return out << YAML::Flow << YAML::BeginSeq << digits(v.x()) << digits(v.y()) << digits(v.z()) << YAML::EndSeq;
}

YAML::Emitter& operator<<(YAML::Emitter& out, const core::Quat& q) {
  return out << YAML::Flow << YAML::BeginSeq << digits(q.w()) << digits(q.x()) << digits(q.y()) << digits(q.z())
             << YAML::EndSeq;
}

void write_orientation(YAML::Emitter& out, const core::Quat& q) {
  if (q.vec().isZero(0)) return;
  out << YAML::Key << "orientation" << YAML::Value << YAML::Flow << YAML::BeginMap << YAML::Key << "quaternion"
      << YAML::Value << q << YAML::EndMap;
}

void write_pose(YAML::Emitter& out, const core::Pose& pose) {
  if (!pose.p_WB.isZero(0)) out << YAML::Key << "position" << YAML::Value << pose.p_WB;
  write_orientation(out, pose.q_WB);
}

/// Writes key and value of one shape within a map.
class ShapeWriter {
 public:
  explicit ShapeWriter(YAML::Emitter& out) : out_(out) {}
  /// `materials`: names of materials, by the indices that parts use.
  ShapeWriter(YAML::Emitter& out, std::vector<std::string> materials) : out_(out), materials_(std::move(materials)) {}

  void operator()(const core::Sphere& s) { begin("sphere").number("radius", s.radius).end(); }
  void operator()(const core::Box& s) {
    begin("box");
    out_ << YAML::Key << "size" << YAML::Value << Vec3(2 * s.half_extents);
    end();
  }
  void operator()(const core::Capsule& s) {
    begin("capsule").number("radius", s.radius).number("height", s.height).end();
  }
  void operator()(const core::Cylinder& s) {
    begin("cylinder").number("radius", s.radius).number("height", s.height).end();
  }
  void operator()(const core::ConvexHull& s) {
    begin("convex_hull");
    out_ << YAML::Key << "points" << YAML::Value << YAML::Flow << YAML::BeginSeq;
    for (const Vec3& p : s.points) out_ << p;
    out_ << YAML::EndSeq;
    end();
  }
  void operator()(const core::Plane& s) {
    begin("plane");
    out_ << YAML::Key << "normal" << YAML::Value << s.normal;
    number("offset", s.offset).end();
  }
  void operator()(const core::Compound& s) {
    out_ << YAML::Key << "compound" << YAML::Value << YAML::BeginMap << YAML::Key << "parts" << YAML::Value
         << YAML::BeginSeq;
    for (const core::CompoundPart& part : s.parts) {
      out_ << YAML::Flow << YAML::BeginMap;
      std::visit(*this, part.shape);
      write_pose(out_, part.pose);
      if (part.material) out_ << YAML::Key << "material" << YAML::Value << materials_.at(*part.material);
      out_ << YAML::EndMap;
    }
    out_ << YAML::EndSeq << YAML::EndMap;
  }
  void mesh(const std::string& file, const Vec3& scale) {
    begin("mesh");
    out_ << YAML::Key << "file" << YAML::Value << file;
    if (scale != Vec3::Ones()) out_ << YAML::Key << "scale" << YAML::Value << scale;
    end();
  }
  void operator()(const core::TriangleMesh&) {}  // triangle meshes are written as files

 private:
  ShapeWriter& begin(const char* kind) {
    out_ << YAML::Key << kind << YAML::Value << YAML::Flow << YAML::BeginMap;
    return *this;
  }
  ShapeWriter& number(const char* key, double value) {
    out_ << YAML::Key << key << YAML::Value << digits(value);
    return *this;
  }
  void end() { out_ << YAML::EndMap; }

  YAML::Emitter& out_;
  std::vector<std::string> materials_;
};

/// Writes the axes of a joint within its map.
class JointWriter {
 public:
  /// `leader`: the name of the joint that this one follows; empty: none.
  JointWriter(YAML::Emitter& out, const core::Quat& q_WJ, std::string leader)
      : out_(out), q_WJ_(q_WJ), leader_(std::move(leader)) {}

  void operator()(const core::BallJoint& joint) {
    out_ << YAML::Key << "ball" << YAML::Value << YAML::Flow << YAML::BeginMap;
    number("damping", joint.damping);
    out_ << YAML::EndMap;
  }
  void operator()(const core::FixedJoint&) { empty("fixed"); }
  void operator()(const core::HingeJoint& joint) {
    begin_along("hinge");
    write_limits("limits_deg", joint.limits, kDegreesOfRadian);
    write_own(joint, kDegreesOfRadian, "_deg");
    out_ << YAML::EndMap;
  }
  void operator()(const core::SliderJoint& joint) {
    begin_along("slider");
    write_limits("limits", joint.limits, 1);
    write_own(joint, 1, "");
    out_ << YAML::EndMap;
  }
  void operator()(const core::SpringJoint& joint) {
    out_ << YAML::Key << "spring" << YAML::Value << YAML::Flow << YAML::BeginMap;
    write_orientation(out_, q_WJ_);
    constexpr const char* kAxes[] = {"x", "y", "z", "rx", "ry", "rz"};
    for (std::size_t i = 0; i < 6; ++i) {
      const core::SpringAxis& axis = joint.axes[i];
      const bool is_locked = axis.limits && axis.limits->low == 0 && axis.limits->high == 0;
      if (is_locked) continue;
      out_ << YAML::Key << kAxes[i] << YAML::Value << YAML::Flow << YAML::BeginMap;
      i < 3 ? write_limits("limits", axis.limits, 1) : write_limits("limits_deg", axis.limits, kDegreesOfRadian, 180);
      number("stiffness", axis.stiffness);
      number(i < 3 ? "rest" : "rest_deg", (i < 3 ? 1 : kDegreesOfRadian) * axis.rest);
      number("damping", axis.damping);
      out_ << YAML::EndMap;
    }
    out_ << YAML::EndMap;
  }

 private:
  void empty(const char* kind) {
    out_ << YAML::Key << kind << YAML::Value << YAML::Flow << YAML::BeginMap << YAML::EndMap;
  }
  void begin_along(const char* kind) {
    out_ << YAML::Key << kind << YAML::Value << YAML::Flow << YAML::BeginMap << YAML::Key << "axis" << YAML::Value
         << Vec3(q_WJ_ * Vec3::UnitZ());
  }
  /// Writes limits, cut at `most`, because rounding may put half a turn beyond it.
  void write_limits(const char* key, const std::optional<core::JointLimits>& limits, double unit,
                    double most = std::numeric_limits<double>::infinity()) {
    if (!limits) return;
    const auto side = [&](double x) {
      return std::isinf(x) ? std::string("none") : digits(std::clamp(x * unit, -most, most));
    };
    out_ << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginSeq << side(limits->low) << side(limits->high)
         << YAML::EndSeq;
  }
  /// Writes a number unless it has its default value.
  void number(const std::string& key, double value, double usual = 0) {
    if (value != usual) out_ << YAML::Key << key << YAML::Value << digits(value);
  }
  template <class Joint>
  void write_own(const Joint& joint, double unit, const std::string& suffix) {
    number("stiffness", joint.resistance.stiffness);
    if (joint.resistance.stiffness != 0) number("rest" + suffix, unit * joint.resistance.rest);
    number("damping", joint.resistance.damping);
    number("friction", joint.resistance.friction);
    if (!joint.drive) return;
    const core::JointDrive usual;
    out_ << YAML::Key << "drive" << YAML::Value << YAML::Flow << YAML::BeginMap;
    number("position" + suffix, unit * joint.drive->position);
    number("speed", joint.drive->speed);
    number("stiffness", joint.drive->stiffness);
    number("damping", joint.drive->damping);
    number("effort", joint.drive->effort);
    number("max_effort", joint.drive->max_effort, usual.max_effort);
    out_ << YAML::EndMap;
    if (!joint.follows) return;
    out_ << YAML::Key << "follows" << YAML::Value << YAML::Flow << YAML::BeginMap;
    out_ << YAML::Key << "joint" << YAML::Value << leader_;
    number("ratio", joint.follows->ratio, 1);
    out_ << YAML::EndMap;
  }

  YAML::Emitter& out_;
  core::Quat q_WJ_;
  std::string leader_;
};

}  // namespace
}  // namespace aurasim::importing
