#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "lab/speed/scene_text.h"

namespace aurasim::lab {
namespace {

using core::Quat;
using core::Vec3;

/// fmt writes as many digits as a number needs to come back as it was.
std::string words(const Vec3& v) { return fmt::format("{} {} {}", v.x(), v.y(), v.z()); }
std::string words(const Quat& q) { return fmt::format("{} {} {} {}", q.w(), q.x(), q.y(), q.z()); }
std::string words(const core::Pose& pose) { return fmt::format("{} {}", words(pose.p_WB), words(pose.q_WB)); }

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("a scene for other engines cannot have " + what);
}

struct ShapeWords {
  std::string operator()(const core::Sphere& s) const { return fmt::format("sphere {}", s.radius); }
  std::string operator()(const core::Box& s) const { return "box " + words(s.half_extents); }
  std::string operator()(const core::Capsule& s) const { return fmt::format("capsule {} {}", s.radius, s.height); }
  std::string operator()(const core::Plane& s) const { return fmt::format("plane {} {}", words(s.normal), s.offset); }
  std::string operator()(const core::ConvexHull& s) const {
    std::string text = fmt::format("hull {}", s.points.size());
    for (const Vec3& point : s.points) text += fmt::format(" {}", words(point));
    return text;
  }
  std::string operator()(const core::Cylinder&) const { refuse("cylinders"); }
  std::string operator()(const core::Compound&) const { refuse("compounds"); }
  std::string operator()(const core::TriangleMesh&) const { refuse("meshes"); }
};

struct JointWords {
  const core::JointSpec& joint;

  std::string operator()(const core::BallJoint&) const { return "ball " + ends() + words(joint.X_WJ.p_WB); }
  std::string operator()(const core::HingeJoint& hinge) const {
    if (!hinge.limits || hinge.motor) refuse("hinges without limits or with motors");
    return fmt::format("hinge {}{} {} {}", ends(), words(joint.X_WJ), hinge.limits->low, hinge.limits->high);
  }
  template <class Other>
  std::string operator()(const Other&) const {
    refuse("other joints than balls and hinges");
  }

  std::string ends() const {
    if (!joint.b || joint.collide) refuse("joints to the world, or bodies that are joined and collide");
    return fmt::format("{} {} ", core::value_of(joint.a), core::value_of(*joint.b));
  }
};

std::string material_words(const core::Material& m) {
  if (m.rolling_friction != 0 || m.spinning_friction != 0 || m.linear_damping != 0 || m.angular_damping != 0) {
    refuse("damping, rolling or spinning friction");
  }
  return fmt::format("material {} {}\n", m.friction, m.restitution);
}

bool may_sleep(const core::Scene& scene) {
  if (scene.prototypes.empty()) return true;
  const bool first = scene.prototypes.front().can_sleep;
  for (const core::Prototype& prototype : scene.prototypes) {
    if (prototype.can_sleep != first) refuse("some bodies that may sleep and some that may not");
  }
  return first;
}

}  // namespace

std::string scene_text(const SpeedScene& all) {
  const core::Scene& scene = all.scene;
  if (!scene.injectors.empty()) refuse("injectors");
  std::string text = fmt::format(
      "name {}\nstep_hz {}\nsteps {}\nstates_every {}\nfallen_m {}\nsleeping {}\ngravity {}\n", all.name, all.step_hz,
      all.steps, all.states_every, all.fallen_m, may_sleep(scene) ? 1 : 0, words(scene.gravity));
  for (const core::NamedShape& shape : scene.shapes)
    text += fmt::format("shape {}\n", std::visit(ShapeWords{}, shape.shape));
  for (const core::Material& material : scene.materials) text += material_words(material);
  for (const core::Prototype& kind : scene.prototypes) {
    text += fmt::format("kind {} {} {}\n", kind.shape, kind.material, kind.mass_kg);
  }
  for (const core::StaticBody& body : scene.statics) {
    text += fmt::format("static {} {} {}\n", body.shape, body.material, words(body.pose));
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const core::InitialBody& body = scene.bodies[i];
    if (core::value_of(body.id) != i) refuse("bodies whose ids are not 0, 1, 2 ...");
    if (i > 0 && all.births[i] < all.births[i - 1]) refuse("bodies that are not in order of birth");
    text += fmt::format("body {} {} {} {} {}\n", all.births[i], core::value_of(body.prototype), words(body.pose),
                        words(body.v_WB), words(body.w_WB));
  }
  for (const core::JointSpec& joint : scene.joints)
    text += fmt::format("joint {}\n", std::visit(JointWords{joint}, joint.kind));
  return text;
}

void write_scene_text(const SpeedScene& scene, const std::filesystem::path& file) {
  const std::string text = scene_text(scene);
  std::filesystem::create_directories(file.parent_path());
  std::ofstream out(file);
  out << text;
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

std::filesystem::path scene_file(const std::filesystem::path& directory, const std::string& name) {
  return directory / "scenes" / (name + ".txt");
}

SpeedScene scene_written_in(const std::filesystem::path& directory, const std::string& name) {
  const std::filesystem::path file = scene_file(directory, name);
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  std::stringstream found;
  found << in.rdbuf();
  for (const SceneSize size : {SceneSize::kQuick, SceneSize::kWhole}) {
    SpeedScene scene = speed_scene(name, size);
    if (scene_text(scene) == found.str()) return scene;
  }
  throw std::runtime_error(
      fmt::format("{}: another version of this program wrote this scene. Run the speed experiment "
                  "again, in another folder",
                  file.string()));
}

}  // namespace aurasim::lab
