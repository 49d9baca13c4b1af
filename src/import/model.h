// A model of another program's file, in the terms that all of their formats share: links with mass and collision
// shapes, joints between them, at rest. Lengths in metres, masses in kilograms, angles in radians. Frames: W the world
// of the file; L a link's own; B the link's principal axes of inertia at its centre of mass, which is the frame of a
// body in a scene; C a collision shape's.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/joint.h"
#include "core/scene.h"

namespace aurasim::importing {

/// Triangles of a file that the scene reader reads itself (OBJ, STL, glTF). Its points times `scale`.
struct MeshFile {
  std::filesystem::path file;
  core::Vec3 scale = core::Vec3::Ones();
};

using Geometry = std::variant<core::Sphere, core::Box, core::Capsule, core::Cylinder, core::ConvexHull, core::Plane,
                              core::TriangleMesh, MeshFile>;

/// Surface properties, defined so that two equal surfaces have these values in contact. A scene instead multiplies the
/// values of the two bodies.
struct Surface {
  double friction = 1;  ///< Coulomb coefficient
  double rolling_friction_m = 0;
  double spinning_friction_m = 0;
  double restitution = 0;

  bool operator==(const Surface&) const = default;
};

struct Collision {
  std::string name;
  Geometry geometry;
  core::Pose X_LC;
  Surface surface;
};

struct Link {
  std::string name;
  core::Pose X_WL;
  bool is_static = false;  ///< never moves; has no mass
  double mass_kg = 0;
  core::Vec3 p_LB = core::Vec3::Zero();  ///< centre of mass
  core::Mat3 I_BL = core::Mat3::Zero();  ///< inertia tensor about the centre of mass in the axes of L, kg m^2
  std::vector<Collision> collisions;
};

struct Joint {
  std::string name;
  core::JointKind kind;               ///< the leader of its coupling is an index in Model::joints
  std::size_t child = 0;              ///< index in Model::links of the link that the joint moves
  std::optional<std::size_t> parent;  ///< index in Model::links; nothing: the world
  core::Pose X_WJ;
  bool collide = false;  ///< whether child and parent collide with each other
};

/// Most pairs of links that are kept from colliding, because each costs a joint.
inline constexpr std::size_t kMostPairsApart = 50'000;

/// Something in the file that a scene cannot express.
struct Finding {
  std::string element;  ///< element of the file, e.g. "link 'arm'/collision 'tip'"
  std::string what;

  bool operator==(const Finding&) const = default;
};

struct Model {
  std::string name;
  std::optional<core::Vec3> gravity;  ///< m/s^2; nothing: not in the file
  std::vector<Link> links;
  std::vector<Joint> joints;
  /// Pairs of links, a < b, that never collide with each other.
  std::vector<std::pair<std::size_t, std::size_t>> apart;
  std::vector<Finding> lost;   ///< things that will move or touch otherwise than in the file
  std::vector<Finding> notes;  ///< things that a scene does not use: looks, sensors, controllers

  void lose(std::string element, std::string what) { lost.push_back({std::move(element), std::move(what)}); }
  void note(std::string element, std::string what) { notes.push_back({std::move(element), std::move(what)}); }
};

/// Thrown for a file that cannot be imported. what() gives the file, the line where the library knows it, the element,
/// and what is wrong.
class BadModel : public std::runtime_error {
 public:
  explicit BadModel(std::vector<std::string> errors);
  const std::vector<std::string>& errors() const { return errors_; }

 private:
  std::vector<std::string> errors_;
};

core::Pose inverse(const core::Pose& X_AB);

/// Returns "KIND 'NAME'".
std::string element_name(std::string_view kind, std::string_view name);

/// Sorts `apart` and removes repeated pairs, and pairs that a joint keeps apart anyway.
void tidy_apart(Model& model);

}  // namespace aurasim::importing
