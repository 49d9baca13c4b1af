#include <array>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "lab/speed/scene_text.h"

namespace aurasim::lab {
namespace {

using core::Quat;
using core::Vec3;

class TextReader {
 public:
  explicit TextReader(const std::filesystem::path& file) : file_(file), in_(file) {
    if (!in_) throw std::runtime_error("cannot read " + file.string());
  }

  SpeedScene read() {
    for (std::string text; std::getline(in_, text);) {
      ++line_;
      words_ = std::istringstream(text);
      std::string what;
      if (!(words_ >> what)) continue;
      read_item(what);
      if (std::string more; words_ >> more) complain(fmt::format("found \"{}\" after the end of {}", more, what));
    }
    if (all_.steps < 1 || all_.states_every < 1) complain("found no steps or no states_every");
    for (core::Prototype& kind : all_.scene.prototypes) kind.can_sleep = sleeping_;
    return std::move(all_);
  }

 private:
  [[noreturn]] void complain(const std::string& what) const {
    throw std::runtime_error(fmt::format("{}:{}: {}", file_.string(), line_, what));
  }

  template <class Value>
  Value next(const char* what) {
    Value value{};
    if (!(words_ >> value)) complain(fmt::format("found no {}", what));
    return value;
  }
  double number() { return next<double>("number"); }
  Vec3 vec3() {
    const double x = number(), y = number();
    return {x, y, number()};
  }
  Quat quat() {
    const double w = number(), x = number(), y = number();
    return {w, x, y, number()};
  }
  core::Pose pose() {
    const Vec3 p_WB = vec3();
    return {p_WB, quat()};
  }
  /// Reads the index of an item that stands further up.
  std::uint32_t index(const char* of, std::size_t count) {
    const auto value = next<std::uint32_t>(of);
    if (value >= count) complain(fmt::format("found {} {}, allowed: 0 to {}", of, value, static_cast<long>(count) - 1));
    return value;
  }

  void read_item(const std::string& what) {
    using Read = void (TextReader::*)();
    static constexpr std::pair<const char*, Read> kItems[] = {
        {"shape", &TextReader::read_shape}, {"material", &TextReader::read_material},
        {"kind", &TextReader::read_kind},   {"static", &TextReader::read_static},
        {"body", &TextReader::read_body},   {"joint", &TextReader::read_joint},
    };
    for (const auto& [name, read] : kItems) {
      if (what == name) return (this->*read)();
    }
    read_setting(what);
  }

  void read_setting(const std::string& what) {
    if (what == "name") {
      all_.name = all_.scene.name = next<std::string>("name");
    } else if (what == "step_hz") {
      all_.step_hz = next<int>("number");
    } else if (what == "steps") {
      all_.steps = next<core::Step>("number");
    } else if (what == "states_every") {
      all_.states_every = next<core::Step>("number");
    } else if (what == "fallen_m") {
      all_.fallen_m = number();
    } else if (what == "sleeping") {
      sleeping_ = next<bool>("0 or 1");
    } else if (what == "gravity") {
      all_.scene.gravity = vec3();
    } else {
      complain(fmt::format("found \"{}\", allowed: the words of lab/speed/scene_text.h", what));
    }
  }

  core::Shape shape_named(const std::string& name) {
    if (name == "sphere") return core::Sphere{number()};
    if (name == "box") return core::Box{vec3()};
    if (name == "capsule") {
      const double radius = number();
      return core::Capsule{radius, number()};
    }
    if (name == "plane") {
      const Vec3 normal = vec3();
      return core::Plane{normal, number()};
    }
    if (name != "hull") complain(fmt::format("found \"{}\", allowed: sphere, box, capsule, plane, hull", name));
    core::ConvexHull hull;
    const int points = next<int>("number of points");
    for (int i = 0; i < points; ++i) hull.points.push_back(vec3());
    return hull;
  }

  void read_shape() {
    core::Shape shape = shape_named(next<std::string>("kind of shape"));
    all_.scene.shapes.push_back({fmt::format("shape {}", all_.scene.shapes.size()), std::move(shape)});
  }

  void read_material() {
    core::Material material;
    material.friction = number();
    material.restitution = number();
    all_.scene.materials.push_back(material);
  }

  void read_kind() {
    core::Prototype kind;
    kind.shape = index("shape", all_.scene.shapes.size());
    kind.material = index("material", all_.scene.materials.size());
    kind.mass_kg = number();
    all_.scene.prototypes.push_back(kind);
  }

  void read_static() {
    core::StaticBody body;
    body.shape = index("shape", all_.scene.shapes.size());
    body.material = index("material", all_.scene.materials.size());
    body.pose = pose();
    all_.scene.statics.push_back(body);
  }

  void read_body() {
    all_.births.push_back(next<core::Step>("birth"));
    core::InitialBody body;
    body.id = core::BodyId{all_.scene.bodies.size()};
    body.prototype = core::PrototypeId{index("kind", all_.scene.prototypes.size())};
    body.pose = pose();
    body.v_WB = vec3();
    body.w_WB = vec3();
    all_.scene.bodies.push_back(body);
  }

  void read_joint() {
    const auto name = next<std::string>("kind of joint");
    if (name != "ball" && name != "hinge") complain(fmt::format("found \"{}\", allowed: ball, hinge", name));
    core::JointSpec joint;
    joint.name = fmt::format("joint {}", all_.scene.joints.size());
    joint.a = core::BodyId{index("body", all_.scene.bodies.size())};
    joint.b = core::BodyId{index("body", all_.scene.bodies.size())};
    joint.X_WJ.p_WB = vec3();
    joint.kind = core::BallJoint{};
    if (name == "hinge") {
      joint.X_WJ.q_WB = quat();
      core::HingeJoint hinge;
      const double low = number();
      hinge.limits = core::JointLimits{low, number()};
      joint.kind = hinge;
    }
    all_.scene.joints.push_back(joint);
  }

  std::filesystem::path file_;
  std::ifstream in_;
  std::istringstream words_;
  int line_ = 0;
  bool sleeping_ = true;
  SpeedScene all_;
};

}  // namespace

SpeedScene read_scene_text(const std::filesystem::path& file) { return TextReader(file).read(); }

}  // namespace aurasim::lab
