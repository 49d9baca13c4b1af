#include "import/scene_writer.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "import/inertia.h"
#include "import/mesh_shapes.h"
#include "import/stand_ins.h"

namespace aurasim::importing {
namespace {

namespace fs = std::filesystem;
using core::Vec3;

constexpr double kDegreesOfRadian = 180 / std::numbers::pi;
constexpr double kMostFriction = 100;  ///< of a scene's material

/// In as few digits as give the same bits back.
std::string digits(double number) { return fmt::format("{}", number + 0.0); }

/// Many things of one kind on one line.
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

/// Key and value of one shape within a map.
class ShapeWriter {
 public:
  explicit ShapeWriter(YAML::Emitter& out) : out_(out) {}

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
  void operator()(const core::TriangleMesh&) {}  // written as files

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
};

/// Ways and turns of a joint, within its map.
class JointWriter {
 public:
  JointWriter(YAML::Emitter& out, const core::Quat& q_WJ) : out_(out), q_WJ_(q_WJ) {}

  void operator()(const core::BallJoint&) { empty("ball"); }
  void operator()(const core::FixedJoint&) { empty("fixed"); }
  void operator()(const core::HingeJoint& joint) {
    begin_along("hinge");
    write_limits("limits_deg", joint.limits, kDegreesOfRadian);
    out_ << YAML::EndMap;
  }
  void operator()(const core::SliderJoint& joint) {
    begin_along("slider");
    write_limits("limits", joint.limits, 1);
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
      write_limits(i < 3 ? "limits" : "limits_deg", axis.limits, i < 3 ? 1 : kDegreesOfRadian);
      if (axis.stiffness != 0) out_ << YAML::Key << "stiffness" << YAML::Value << digits(axis.stiffness);
      if (axis.damping != 0) out_ << YAML::Key << "damping" << YAML::Value << digits(axis.damping);
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
  void write_limits(const char* key, const std::optional<core::JointLimits>& limits, double unit) {
    if (!limits) return;
    const auto bounded = [unit](double x) { return unit == 1 ? x : std::clamp(x * unit, -180.0, 180.0); };
    out_ << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginSeq << digits(bounded(limits->low))
         << digits(bounded(limits->high)) << YAML::EndSeq;
  }

  YAML::Emitter& out_;
  core::Quat q_WJ_;
};

class SceneWriter {
 public:
  SceneWriter(const Model& model, const std::vector<Instance>& instances, fs::path file)
      : model_(model), instances_(instances), file_(std::move(file)) {}

  SceneText write() {
    collect_surfaces();
    out_ << YAML::BeginMap;
    out_ << YAML::Key << "name" << YAML::Value << model_.name;
    if (model_.gravity) out_ << YAML::Key << "gravity" << YAML::Value << *model_.gravity;
    write_materials();
    write_prototypes();
    write_statics();
    write_bodies();
    write_joints();
    out_ << YAML::EndMap;
    text_.yaml = fmt::format("{}{}\n", what_is_lost(), out_.c_str());
    return std::move(text_);
  }

 private:
  bool has(bool is_static) const {
    return std::ranges::any_of(
        model_.links, [&](const Link& link) { return link.is_static == is_static && !link.collisions.empty(); });
  }

  std::string what_is_lost() const {
    std::string text;
    for (const Finding& finding : model_.lost) {
      std::string line = fmt::format("{}: {}", finding.element, finding.what);
      std::ranges::replace_if(
          line, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
      text += fmt::format("# not as in the file: {}\n", line);
    }
    return text;
  }

  void collect_surfaces() {
    for (const Link& link : model_.links) {
      for (const Collision& collision : link.collisions) {
        if (std::ranges::find(surfaces_, collision.surface) == surfaces_.end()) surfaces_.push_back(collision.surface);
      }
    }
  }

  std::string material_of(const Collision& collision) const {
    return fmt::format("surface {}", std::ranges::find(surfaces_, collision.surface) - surfaces_.begin());
  }

  /// Friction and restitution of a contact are products, so each body has the root; resistance to rolling and spinning
  /// is each body's times the friction of the other, added.
  void write_materials() {
    out_ << YAML::Key << "materials" << YAML::Value << YAML::BeginMap;
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      const Surface& s = surfaces_[i];
      const double friction = std::min(std::sqrt(s.friction), kMostFriction);
      const double share = friction > 0 ? 2 * friction : 1;
      out_ << YAML::Key << fmt::format("surface {}", i) << YAML::Value << YAML::Flow << YAML::BeginMap << YAML::Key
           << "friction" << YAML::Value << digits(friction);
      if (s.rolling_friction_m != 0)
        out_ << YAML::Key << "rolling_friction" << YAML::Value << digits(s.rolling_friction_m / share);
      if (s.spinning_friction_m != 0)
        out_ << YAML::Key << "spinning_friction" << YAML::Value << digits(s.spinning_friction_m / share);
      if (s.restitution != 0)
        out_ << YAML::Key << "restitution" << YAML::Value << digits(std::sqrt(std::clamp(s.restitution, 0.0, 1.0)));
      out_ << YAML::EndMap;
    }
    out_ << YAML::EndMap;
  }

  void write_prototypes() {
    if (!has(false)) return;
    out_ << YAML::Key << "prototypes" << YAML::Value << YAML::BeginMap;
    for (const Link& link : model_.links) {
      if (link.is_static) continue;
      out_ << YAML::Key << link.name << YAML::Value << YAML::BeginMap;
      out_ << YAML::Key << "mass" << YAML::Value << digits(link.mass_kg);
      out_ << YAML::Key << "material" << YAML::Value << material_of(link.collisions.front());
      out_ << YAML::Key << "shape" << YAML::Value << YAML::BeginMap;
      ShapeWriter writer(out_);
      std::visit(writer, body_shape(link));
      out_ << YAML::EndMap << YAML::EndMap;
    }
    out_ << YAML::EndMap;
  }

  static std::string name_in(const Instance& instance, const std::string& name) {
    return instance.prefix.empty() ? name : instance.prefix + "/" + name;
  }

  std::string file_of_mesh(const core::TriangleMesh& mesh, const std::string& name) {
    std::string plain = name;
    std::ranges::replace_if(
        plain, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    const fs::path file = fs::path(file_.stem().string() + "_meshes") / fmt::format("{}.obj", plain);
    const auto is_there = [&file](const auto& written) { return written.first == file; };
    if (std::ranges::none_of(text_.meshes, is_there)) text_.meshes.emplace_back(file, obj_text(mesh));
    return file.string();
  }

  void write_static_shape(const Collision& collision, const std::string& name) {
    ShapeWriter writer(out_);
    if (const auto* mesh = std::get_if<MeshFile>(&collision.geometry)) {
      const fs::path folder = fs::absolute(file_).parent_path();
      return writer.mesh(fs::relative(fs::absolute(mesh->file), folder).string(), mesh->scale);
    }
    if (const auto* mesh = std::get_if<core::TriangleMesh>(&collision.geometry))
      return writer.mesh(file_of_mesh(*mesh, name), Vec3::Ones());
    std::visit(
        [&writer](const auto& shape) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(shape)>, MeshFile>) writer(shape);
        },
        collision.geometry);
  }

  void write_statics() {
    if (!has(true)) return;
    out_ << YAML::Key << "statics" << YAML::Value << YAML::BeginSeq;
    for (const Instance& instance : instances_) {
      for (const Link& link : model_.links) {
        if (!link.is_static) continue;
        for (const Collision& collision : link.collisions) {
          const bool is_alone = link.collisions.size() == 1;
          const std::string name = is_alone ? link.name : link.name + "/" + collision.name;
          out_ << YAML::Flow << YAML::BeginMap << YAML::Key << "name" << YAML::Value << name_in(instance, name);
          out_ << YAML::Key << "material" << YAML::Value << material_of(collision);
          out_ << YAML::Key << "shape" << YAML::Value << YAML::Flow << YAML::BeginMap;
          write_static_shape(collision, name);
          out_ << YAML::EndMap;
          write_pose(out_, instance.X_WM * link.X_WL * collision.X_LC);
          out_ << YAML::EndMap;
        }
      }
    }
    out_ << YAML::EndSeq;
  }

  void write_bodies() {
    if (!has(false)) return;
    out_ << YAML::Key << "bodies" << YAML::Value << YAML::BeginSeq;
    for (const Instance& instance : instances_) {
      for (const Link& link : model_.links) {
        if (link.is_static) continue;
        out_ << YAML::Flow << YAML::BeginMap << YAML::Key << "name" << YAML::Value << name_in(instance, link.name);
        out_ << YAML::Key << "prototype" << YAML::Value << link.name;
        write_pose(out_, instance.X_WM * body_pose(link));
        out_ << YAML::EndMap;
      }
    }
    out_ << YAML::EndSeq;
  }

  void write_ends(const Instance& instance, std::size_t a, std::optional<std::size_t> b) {
    out_ << YAML::Key << "bodies" << YAML::Value << YAML::Flow << YAML::BeginSeq
         << name_in(instance, model_.links[a].name);
    if (b) out_ << name_in(instance, model_.links[*b].name);
    out_ << YAML::EndSeq;
  }

  void write_joint(const Instance& instance, const Joint& joint) {
    const core::Pose X_WJ = instance.X_WM * joint.X_WJ;
    out_ << YAML::Flow << YAML::BeginMap << YAML::Key << "name" << YAML::Value << name_in(instance, joint.name);
    write_ends(instance, joint.child, joint.parent);
    std::visit(JointWriter(out_, X_WJ.q_WB), joint.kind);
    out_ << YAML::Key << "position" << YAML::Value << X_WJ.p_WB;
    if (joint.collide) out_ << YAML::Key << "collide" << YAML::Value << true;
    out_ << YAML::EndMap;
  }

  /// What keeps two bodies from colliding is a joint that is free in all ways.
  void write_apart(const Instance& instance, std::size_t a, std::size_t b) {
    const std::string name = fmt::format("{} apart from {}", model_.links[a].name, model_.links[b].name);
    out_ << YAML::Flow << YAML::BeginMap << YAML::Key << "name" << YAML::Value << name_in(instance, name);
    write_ends(instance, a, b);
    std::visit(JointWriter(out_, core::Quat::Identity()), core::JointKind(core::SpringJoint{}));
    out_ << YAML::EndMap;
  }

  void write_joints() {
    if (model_.joints.empty() && model_.apart.empty()) return;
    out_ << YAML::Key << "joints" << YAML::Value << YAML::BeginSeq;
    for (const Instance& instance : instances_) {
      for (const Joint& joint : model_.joints) write_joint(instance, joint);
      for (const auto& [a, b] : model_.apart) write_apart(instance, a, b);
    }
    out_ << YAML::EndSeq;
  }

  const Model& model_;
  const std::vector<Instance>& instances_;
  fs::path file_;
  std::vector<Surface> surfaces_;
  YAML::Emitter out_;
  SceneText text_;
};

}  // namespace

SceneText scene_text(const Model& model, const std::vector<Instance>& instances, const fs::path& file) {
  return SceneWriter(model, instances, file).write();
}

}  // namespace aurasim::importing
