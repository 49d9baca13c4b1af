// What a scene's text says (src/lab/speed/scene_text.h explains the words), for the drivers of other engines.
#pragma once

#include <cstddef>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace peers {

struct Vec3 {
  double x = 0, y = 0, z = 0;
};
struct Quat {
  double w = 1, x = 0, y = 0, z = 0;
};

enum class ShapeKind { kSphere, kBox, kCapsule, kPlane, kHull };

struct Shape {
  ShapeKind kind = ShapeKind::kSphere;
  double radius = 0;
  double height = 0;         ///< of a capsule, between the centres of its caps, along z
  Vec3 half_extents;         ///< of a box
  Vec3 normal;               ///< of a plane: solid below normal . x = offset
  double offset = 0;         ///< of a plane
  std::vector<Vec3> points;  ///< of a hull
};

/// Of a pair of bodies: the products of those of the two.
struct Material {
  double friction = 0, restitution = 0;
};

struct Kind {
  std::size_t shape = 0, material = 0;
  double mass = 1;
};

struct Static {
  std::size_t shape = 0, material = 0;
  Vec3 p;
  Quat q;
};

struct Body {
  long birth = 0;  ///< the first state in which it is there
  std::size_t kind = 0;
  Vec3 p;
  Quat q;
  Vec3 v, w;
};

/// Joined bodies do not collide with each other.
struct Joint {
  bool is_hinge = false;  ///< else a ball joint
  std::size_t a = 0, b = 0;
  Vec3 p;
  Quat q;                    ///< of a hinge, which turns about z of this frame
  double low = 0, high = 0;  ///< of a hinge: angle of a relative to b
};

struct Scene {
  std::string name;
  double step_s = 1.0 / 60;
  long steps = 0, states_every = 0;
  bool sleeping = false;
  Vec3 gravity;
  std::vector<Shape> shapes;
  std::vector<Material> materials;
  std::vector<Kind> kinds;
  std::vector<Static> statics;
  std::vector<Body> bodies;  ///< in order of birth
  std::vector<Joint> joints;
};

inline std::istream& operator>>(std::istream& in, Vec3& v) { return in >> v.x >> v.y >> v.z; }
inline std::istream& operator>>(std::istream& in, Quat& q) { return in >> q.w >> q.x >> q.y >> q.z; }

inline std::istream& operator>>(std::istream& in, Shape& shape) {
  std::string kind;
  in >> kind;
  if (kind == "sphere") return in >> shape.radius;
  if (kind == "box") {
    shape.kind = ShapeKind::kBox;
    return in >> shape.half_extents;
  }
  if (kind == "capsule") {
    shape.kind = ShapeKind::kCapsule;
    return in >> shape.radius >> shape.height;
  }
  if (kind == "plane") {
    shape.kind = ShapeKind::kPlane;
    return in >> shape.normal >> shape.offset;
  }
  shape.kind = ShapeKind::kHull;
  std::size_t count = 0;
  in >> count;
  shape.points.resize(count);
  for (Vec3& point : shape.points) in >> point;
  return in;
}

inline std::istream& operator>>(std::istream& in, Joint& joint) {
  std::string kind;
  in >> kind >> joint.a >> joint.b >> joint.p;
  joint.is_hinge = kind == "hinge";
  return joint.is_hinge ? in >> joint.q >> joint.low >> joint.high : in;
}

inline void read_item(std::istream& in, const std::string& what, Scene& scene) {
  if (what == "name") {
    in >> scene.name;
  } else if (what == "step_hz") {
    double hz = 0;
    in >> hz;
    scene.step_s = 1 / hz;
  } else if (what == "steps") {
    in >> scene.steps;
  } else if (what == "states_every") {
    in >> scene.states_every;
  } else if (what == "fallen_m") {
    in.ignore(80);  // whoever tells the errors needs it
  } else if (what == "sleeping") {
    in >> scene.sleeping;
  } else if (what == "gravity") {
    in >> scene.gravity;
  } else if (what == "shape") {
    in >> scene.shapes.emplace_back();
  } else if (what == "material") {
    Material& m = scene.materials.emplace_back();
    in >> m.friction >> m.restitution;
  } else if (what == "kind") {
    Kind& k = scene.kinds.emplace_back();
    in >> k.shape >> k.material >> k.mass;
  } else if (what == "static") {
    Static& s = scene.statics.emplace_back();
    in >> s.shape >> s.material >> s.p >> s.q;
  } else if (what == "body") {
    Body& b = scene.bodies.emplace_back();
    in >> b.birth >> b.kind >> b.p >> b.q >> b.v >> b.w;
  } else if (what == "joint") {
    in >> scene.joints.emplace_back();
  } else {
    throw std::runtime_error("a scene with the word \"" + what + "\", which is not known here");
  }
}

inline Scene read_scene(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file);
  Scene scene;
  for (std::string text, what; std::getline(in, text);) {
    std::istringstream words(text);
    if (!(words >> what)) continue;
    read_item(words, what, scene);
    if (words.fail()) throw std::runtime_error(file + ": what is \"" + text + "\"?");
  }
  return scene;
}

}  // namespace peers
