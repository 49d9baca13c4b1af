#include "import/sdf_writer.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "import/mesh_shapes.h"
#include "physics/inertia.h"

namespace aurasim::importing {
namespace {

namespace fs = std::filesystem;
using core::Vec3;

/// Makes a name valid in SDF, where "::" separates names of models from those of links.
std::string sdf_name(std::string name) {
  for (auto at = name.find("::"); at != std::string::npos; at = name.find("::")) {
    name.erase(at, 1);
    name[at] = '/';
  }
  return name;
}

std::string triple(const Vec3& v) { return fmt::format("{} {} {}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0); }

bool is_locked(const core::SpringAxis& axis) { return axis.limits && axis.limits->low == 0 && axis.limits->high == 0; }

bool is_free_in_all_ways(const core::JointKind& kind) {
  const auto* spring = std::get_if<core::SpringJoint>(&kind);
  return spring != nullptr && std::ranges::all_of(spring->axes, [](const core::SpringAxis& axis) {
           return !axis.limits && axis.stiffness == 0 && axis.damping == 0;
         });
}

struct SdfAxis {
  Vec3 axis_J;
  std::optional<core::JointLimits> limits;
  core::JointResistance resistance;
  double max_effort = core::JointDrive{}.max_effort;
};

/// A joint as SDF has it: its type and one or two axes of J.
struct SdfKind {
  const char* type = nullptr;
  std::vector<SdfAxis> axes;
};

template <class Joint>
SdfAxis own_axis(const Joint& joint) {
  return {Vec3::UnitZ(), joint.limits, joint.resistance, joint.drive.value_or(core::JointDrive{}).max_effort};
}

/// Converts a joint; nothing if SDF has no such joint.
std::optional<SdfKind> sdf_kind(const core::SpringJoint& spring) {
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < 6; ++i) {
    if (!is_locked(spring.axes[i])) open.push_back(i);
  }
  const auto axis = [&](std::size_t i) {
    const core::SpringAxis& of = spring.axes[i];
    return SdfAxis{Vec3::Unit(i % 3), of.limits, {of.stiffness, of.rest, of.damping, 0}};
  };
  if (open.empty()) return SdfKind{"fixed", {}};
  if (open.size() == 1) return SdfKind{open[0] < 3 ? "prismatic" : "revolute", {axis(open[0])}};
  if (open.size() == 2 && open[0] >= 3) return SdfKind{"universal", {axis(open[0]), axis(open[1])}};
  return std::nullopt;
}

std::optional<SdfKind> sdf_kind(const core::JointKind& kind) {
  if (std::holds_alternative<core::BallJoint>(kind)) return SdfKind{"ball", {}};
  if (std::holds_alternative<core::FixedJoint>(kind)) return SdfKind{"fixed", {}};
  if (const auto* hinge = std::get_if<core::HingeJoint>(&kind)) return SdfKind{"revolute", {own_axis(*hinge)}};
  if (const auto* slider = std::get_if<core::SliderJoint>(&kind)) return SdfKind{"prismatic", {own_axis(*slider)}};
  return sdf_kind(std::get<core::SpringJoint>(kind));
}

class SdfWriter {
 public:
  SdfWriter(const core::Scene& scene, const std::vector<std::string>& names, const fs::path& file,
            const TrianglesAround& triangles_around)
      : scene_(scene), file_(file), triangles_around_(triangles_around) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      const core::BodyId id = scene.bodies[i].id;
      place_[id] = i;
      names_.push_back(names[i].empty() ? fmt::format("body {}", core::value_of(id)) : sdf_name(names[i]));
    }
  }

  SdfText write() {
    xml_.PushHeader(false, true);
    open("sdf", {{"version", "1.9"}});
    open("world", {{"name", scene_.name}});
    text("gravity", triple(scene_.gravity));
    for (const core::StaticBody& body : scene_.statics) write_static(body);
    for (const std::vector<std::size_t>& model : models()) write_model(model);
    close(), close();
    for (const core::Injector& injector : scene_.injectors) lose("injector", injector.name, "bodies that come later");
    tell_of_materials();
    text_.xml = xml_.CStr();
    return std::move(text_);
  }

 private:
  using Attributes = std::vector<std::pair<const char*, std::string>>;

  void open(const char* name, const Attributes& attributes = {}) {
    xml_.OpenElement(name);
    for (const auto& [key, value] : attributes) xml_.PushAttribute(key, value.c_str());
  }
  void close() { xml_.CloseElement(); }
  void text(const char* name, const std::string& value, const Attributes& attributes = {}) {
    open(name, attributes);
    xml_.PushText(value.c_str());
    close();
  }
  void number(const char* name, double value) { text(name, fmt::format("{}", value)); }
  void lose(const char* kind, const std::string& name, std::string what) {
    text_.lost.push_back({element_name(kind, name), std::move(what)});
  }

  void write_pose(const core::Pose& pose, const char* relative_to = nullptr) {
    Attributes attributes = {{"rotation_format", "quat_xyzw"}};
    if (relative_to != nullptr) attributes.emplace_back("relative_to", relative_to);
    const core::Quat& q = pose.q_WB;
    text("pose", fmt::format("{} {} {} {} {}", triple(pose.p_WB), q.x(), q.y(), q.z(), q.w()), attributes);
  }

  /// Groups of bodies (places in scene_.bodies) that joints connect or keep apart.
  std::vector<std::vector<std::size_t>> models() const {
    std::vector<std::size_t> root(scene_.bodies.size());
    std::iota(root.begin(), root.end(), std::size_t{0});
    const auto find = [&root](std::size_t i) {
      while (root[i] != i) i = root[i] = root[root[i]];
      return i;
    };
    for (const core::JointSpec& joint : scene_.joints) {
      if (!joint.b) continue;
      const auto [low, high] = std::minmax({find(place_.at(joint.a)), find(place_.at(*joint.b))});
      root[high] = low;
    }
    std::map<std::size_t, std::vector<std::size_t>> of_root;
    for (std::size_t i = 0; i < root.size(); ++i) of_root[find(i)].push_back(i);
    std::vector<std::vector<std::size_t>> all;
    for (auto& [first, places] : of_root) all.push_back(std::move(places));
    return all;
  }

  void write_static(const core::StaticBody& body) {
    open("model", {{"name", sdf_name(body.name)}});
    text("static", "true");
    write_pose(body.pose);
    open("link", {{"name", "link"}});
    write_collisions(scene_.shapes[body.shape].shape, scene_.materials[body.material], sdf_name(body.name));
    close(), close();
    if (body.path) lose("static", body.name, "its path");
    if (!body.belt_S.isZero()) lose("static", body.name, "its belt");
  }

  void write_model(const std::vector<std::size_t>& places) {
    const std::string& name = names_[places.front()];
    const std::vector<const core::JointSpec*> joints = joints_of(places);
    std::set<std::pair<core::BodyId, core::BodyId>> apart;
    for (const core::JointSpec* joint : joints) {
      if (joint->b && !joint->collide) apart.insert(std::minmax(joint->a, *joint->b));
    }
    const bool self_collide = apart.size() < places.size() * (places.size() - 1) / 2;
    open("model", {{"name", name}});
    if (self_collide) text("self_collide", "true");
    for (const std::size_t i : places) write_body(scene_.bodies[i], names_[i]);
    for (const core::JointSpec* joint : joints) {
      if (!is_free_in_all_ways(joint->kind)) {
        write_sdf_joint(*joint);
      } else if (self_collide) {
        lose("joint", joint->name, "two bodies that do not collide, where others of the model do");
      }
    }
    close();
  }

  std::vector<const core::JointSpec*> joints_of(const std::vector<std::size_t>& places) const {
    std::vector<const core::JointSpec*> found;
    for (const core::JointSpec& joint : scene_.joints) {
      if (std::ranges::binary_search(places, place_.at(joint.a))) found.push_back(&joint);
    }
    return found;
  }

  void write_body(const core::InitialBody& body, const std::string& name) {
    const core::Prototype& prototype = scene_.prototypes[core::value_of(body.prototype)];
    const core::Shape& shape = scene_.shapes[prototype.shape].shape;
    const Vec3 moments = physics::inertia_of(prototype, scene_);
    open("link", {{"name", name}});
    write_pose(body.pose);
    open("inertial");
    number("mass", prototype.mass_kg);
    open("inertia");
    number("ixx", moments.x()), number("iyy", moments.y()), number("izz", moments.z());
    close(), close();
    if (prototype.collides) write_collisions(shape, scene_.materials[prototype.material], name);
    close();
    if (!body.v_WB.isZero(0) || !body.w_WB.isZero(0)) lose("body", name, "its velocity at the start");
  }

  void write_collisions(const core::Shape& shape, const core::Material& material, const std::string& name) {
    if (const auto* compound = std::get_if<core::Compound>(&shape)) {
      for (std::size_t i = 0; i < compound->parts.size(); ++i) {
        const core::CompoundPart& own = compound->parts[i];
        const auto part = std::visit([](const auto& of) { return core::Shape(of); }, own.shape);
        write_collision(part, own.pose, own.material ? scene_.materials[*own.material] : material,
                        fmt::format("{} {}", name, i));
      }
      return;
    }
    core::Pose pose;
    if (const auto* plane = std::get_if<core::Plane>(&shape)) pose.p_WB = plane->offset * plane->normal.normalized();
    write_collision(shape, pose, material, name);
  }

  void write_collision(const core::Shape& shape, const core::Pose& pose, const core::Material& material,
                       const std::string& name) {
    open("collision", {{"name", name}});
    write_pose(pose);
    open("geometry");
    std::visit([&](const auto& of) { write_geometry(of, name); }, shape);
    close();
    open("surface");
    open("friction"), open("ode");  // a scene's contacts have the product of both bodies' values
    number("mu", material.friction * material.friction), number("mu2", material.friction * material.friction);
    close(), close();
    open("bounce");
    number("restitution_coefficient", material.restitution * material.restitution);
    close(), close(), close();
  }

  void write_geometry(const core::Sphere& s, const std::string&) {
    open("sphere"), number("radius", s.radius), close();
  }
  void write_geometry(const core::Box& s, const std::string&) {
    open("box"), text("size", triple(2 * s.half_extents)), close();
  }
  void write_geometry(const core::Capsule& s, const std::string&) {
    open("capsule"), number("radius", s.radius), number("length", s.height), close();
  }
  void write_geometry(const core::Cylinder& s, const std::string&) {
    open("cylinder"), number("radius", s.radius), number("length", s.height), close();
  }
  void write_geometry(const core::Plane& s, const std::string&) {
    open("plane"), text("normal", triple(s.normal)), close();
  }
  void write_geometry(const core::ConvexHull& s, const std::string& name) {
    write_geometry(core::TriangleMesh{s.points, triangles_around_(s.points)}, name);
  }
  void write_geometry(const core::TriangleMesh& s, const std::string& name) {
    std::string plain = name;
    std::ranges::replace_if(
        plain, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    const fs::path mesh =
        fs::path(file_.stem().string() + "_meshes") / fmt::format("{}_{}.obj", text_.meshes.size(), plain);
    text_.meshes.emplace_back(mesh, obj_text(s));
    open("mesh"), text("uri", mesh.string()), close();
  }
  void write_geometry(const core::Compound&, const std::string&) {}  // the parts of a compound are written one by one

  void write_sdf_joint(const core::JointSpec& joint) {
    const std::optional<SdfKind> kind = sdf_kind(joint.kind);
    if (!kind) return lose("joint", joint.name, "axes that no joint of SDF has: it is left out");
    const auto* hinge = std::get_if<core::HingeJoint>(&joint.kind);
    if (hinge != nullptr && hinge->motor) lose("joint", joint.name, "its motor");
    // SDF leaves drives and gears to plugins.
    if (core::coupling_of(joint.kind)) lose("joint", joint.name, "that it follows another joint");
    if (const auto drive = core::drive_of(joint.kind);
        drive && *drive != core::JointDrive{.max_effort = drive->max_effort})
      lose("joint", joint.name, "its drive");
    if (const auto* ball = std::get_if<core::BallJoint>(&joint.kind); ball != nullptr && ball->damping != 0)
      lose("joint", joint.name, "its damping");
    if (std::isfinite(joint.break_impulse)) lose("joint", joint.name, "that it breaks");
    if (joint.collide) lose("joint", joint.name, "that its bodies collide");
    open("joint", {{"name", sdf_name(joint.name)}, {"type", kind->type}});
    write_pose({joint.X_WJ.p_WB, core::Quat::Identity()}, "__model__");
    text("parent", joint.b ? names_[place_.at(*joint.b)] : "world");
    text("child", names_[place_.at(joint.a)]);
    for (std::size_t i = 0; i < kind->axes.size(); ++i) {
      write_axis(i == 0 ? "axis" : "axis2", joint.X_WJ.q_WB * kind->axes[i].axis_J, kind->axes[i]);
    }
    close();
  }

  void write_axis(const char* name, const Vec3& axis_W, const SdfAxis& rule) {
    open(name);
    text("xyz", triple(axis_W), {{"expressed_in", "__model__"}});
    open("limit");  // SDF requires this element, even without limits
    if (rule.limits && std::isfinite(rule.limits->low)) number("lower", rule.limits->low);
    if (rule.limits && std::isfinite(rule.limits->high)) number("upper", rule.limits->high);
    if (std::isfinite(rule.max_effort)) number("effort", rule.max_effort);
    close();
    if (const core::JointResistance& own = rule.resistance; own != core::JointResistance{}) {
      open("dynamics");
      number("damping", own.damping), number("friction", own.friction);
      number("spring_stiffness", own.stiffness), number("spring_reference", own.rest);
      close();
    }
    close();
  }

  void tell_of_materials() {
    for (const core::Material& material : scene_.materials) {
      if (material.rolling_friction != 0 || material.spinning_friction != 0)
        lose("material", material.name, "rolling and spinning friction");
      if (material.linear_damping != 0 || material.angular_damping != 0) lose("material", material.name, "damping");
    }
  }

  const core::Scene& scene_;
  fs::path file_;
  const TrianglesAround& triangles_around_;
  std::map<core::BodyId, std::size_t> place_;  ///< place in scene_.bodies
  std::vector<std::string> names_;             ///< in the order of scene_.bodies
  tinyxml2::XMLPrinter xml_;
  SdfText text_;
};

}  // namespace

SdfText sdf_text(const core::Scene& scene, const std::vector<std::string>& names, const fs::path& file,
                 const TrianglesAround& triangles_around) {
  return SdfWriter(scene, names, file, triangles_around).write();
}

}  // namespace aurasim::importing
