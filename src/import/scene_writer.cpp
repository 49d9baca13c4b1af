#include "import/scene_writer.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "import/inertia.h"
#include "import/mesh_shapes.h"
#include "import/scene_parts.h"
#include "import/stand_ins.h"

namespace aurasim::importing {
namespace {

namespace fs = std::filesystem;
using core::Vec3;

constexpr double kMostFriction = 100;  ///< largest friction of a scene's material

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
    return std::ranges::any_of(model_.links, [&](const Link& link) {
      return link.is_static == is_static && !(is_static && link.collisions.empty());
    });
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

  std::size_t surface_of(const Collision& collision) const {
    return static_cast<std::size_t>(std::ranges::find(surfaces_, collision.surface) - surfaces_.begin());
  }

  static std::string name_of(std::size_t surface) { return fmt::format("surface {}", surface); }

  std::string material_of(const Collision& collision) const { return name_of(surface_of(collision)); }

  std::vector<std::string> materials() const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < surfaces_.size(); ++i) names.push_back(name_of(i));
    return names;
  }

  /// Returns the link's shape with materials for its parts; the first part has the body's material.
  core::Shape shape_with_materials(const Link& link) const {
    core::Shape shape = body_shape(link);
    auto* const compound = std::get_if<core::Compound>(&shape);
    if (compound == nullptr) return shape;
    for (std::size_t i = 1; i < compound->parts.size(); ++i) {
      if (link.collisions[i].surface == link.collisions.front().surface) continue;
      compound->parts[i].material = static_cast<std::uint32_t>(surface_of(link.collisions[i]));
    }
    return shape;
  }

  /// Writes materials. Friction and restitution of a contact are products, so each body gets the square root. A
  /// contact's resistance to rolling and spinning is the sum of each body's value times the other's friction.
  void write_materials() {
    out_ << YAML::Key << "materials" << YAML::Value << YAML::BeginMap;
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      const Surface& s = surfaces_[i];
      const double friction = std::min(std::sqrt(s.friction), kMostFriction);
      const double share = friction > 0 ? 2 * friction : 1;
      out_ << YAML::Key << name_of(i) << YAML::Value << YAML::Flow << YAML::BeginMap << YAML::Key << "friction"
           << YAML::Value << digits(friction);
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
    ShapeWriter writer(out_, materials());
    out_ << YAML::Key << "prototypes" << YAML::Value << YAML::BeginMap;
    for (const Link& link : model_.links) {
      if (link.is_static) continue;
      out_ << YAML::Key << link.name << YAML::Value << YAML::BeginMap;
      out_ << YAML::Key << "mass" << YAML::Value << digits(link.mass_kg);
      out_ << YAML::Key << "inertia" << YAML::Value << principal_inertia(link.I_BL).moments;
      if (link.collisions.empty()) out_ << YAML::Key << "collides" << YAML::Value << false;
      if (!link.collisions.empty())
        out_ << YAML::Key << "material" << YAML::Value << material_of(link.collisions.front());
      out_ << YAML::Key << "shape" << YAML::Value << YAML::BeginMap;
      std::visit(writer, shape_with_materials(link));
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
    const auto coupling = core::coupling_of(joint.kind);
    const std::string leader = coupling ? model_.joints[core::value_of(coupling->leader)].name : "";
    std::visit(JointWriter(out_, X_WJ.q_WB, name_in(instance, leader)), joint.kind);
    out_ << YAML::Key << "position" << YAML::Value << X_WJ.p_WB;
    if (joint.collide) out_ << YAML::Key << "collide" << YAML::Value << true;
    out_ << YAML::EndMap;
  }

  /// Keeps two bodies from colliding by a joint that is free in all directions.
  void write_apart(const Instance& instance, std::size_t a, std::size_t b) {
    const std::string name = fmt::format("{} apart from {}", model_.links[a].name, model_.links[b].name);
    out_ << YAML::Flow << YAML::BeginMap << YAML::Key << "name" << YAML::Value << name_in(instance, name);
    write_ends(instance, a, b);
    std::visit(JointWriter(out_, core::Quat::Identity(), ""), core::JointKind(core::SpringJoint{}));
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
