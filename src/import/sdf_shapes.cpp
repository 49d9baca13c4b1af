#include "import/sdf_shapes.h"

#include <fmt/format.h>

#include "import/mesh_shapes.h"
#include "import/places.h"
#include "import/sdf_frames.h"

namespace aurasim::importing {
namespace {

/// Returns the element at the end of a path of names, or null.
sdf::ElementPtr element_at(sdf::ElementPtr element, const std::vector<const char*>& way) {
  for (const char* name : way) {
    if (!element || !element->HasElement(name)) return nullptr;
    element = element->GetElement(name);
  }
  return element;
}

double number_at(const sdf::ElementPtr& element, const char* name, double otherwise) {
  return element && element->HasElement(name) ? element->Get<double>(name) : otherwise;
}

Surface read_surface(const sdf::Collision& collision, const std::string& element, Model& model) {
  const sdf::ElementPtr surface = element_at(collision.Element(), {"surface"});
  Surface read;
  const sdf::ElementPtr ode = element_at(surface, {"friction", "ode"});
  read.friction = number_at(ode, "mu", 1);
  if (number_at(ode, "mu2", read.friction) != read.friction)
    model.lose(element, "a friction of its own in the second direction (mu2)");
  if (number_at(ode, "slip1", 0) != 0 || number_at(ode, "slip2", 0) != 0) model.lose(element, "slip");
  if (!ode) {
    const sdf::ElementPtr bullet = element_at(surface, {"friction", "bullet"});
    read.friction = number_at(bullet, "friction", 1);
    read.rolling_friction_m = number_at(bullet, "rolling_friction", 0);
  }
  if (element_at(surface, {"friction", "torsional"})) model.lose(element, "torsional friction");
  read.restitution = number_at(element_at(surface, {"bounce"}), "restitution_coefficient", 0);
  if (element_at(surface, {"soft_contact"})) model.lose(element, "a soft contact");
  if (number_at(element_at(surface, {"contact"}), "collide_without_contact", 0) != 0)
    model.lose(element, "collide_without_contact");
  const sdf::ElementPtr mask = element_at(surface, {"contact", "collide_bitmask"});
  if (mask && mask->Get<unsigned>() != 0xffff) model.lose(element, "collide_bitmask: in a scene it collides with all");
  return read;
}

void add_mesh_of(const sdf::Mesh& mesh, const std::filesystem::path& folder,
                 const std::vector<std::filesystem::path>& paths, const std::string& element, Collision collision,
                 Link& link, Model& model) {
  const auto found = find_named_file(mesh.Uri(), folder, paths);
  if (const auto* why = std::get_if<std::string>(&found)) throw BadModel({fmt::format("{}: {}", element, *why)});
  if (!mesh.Submesh().empty())
    model.lose(element, fmt::format("submesh '{}': the whole file stands for it", mesh.Submesh()));
  add_mesh(std::get<std::filesystem::path>(found), vec3_of(mesh.Scale()), std::move(collision), element, link, model);
}

/// Reads a shape that needs no file; nothing if a scene has no such shape.
std::optional<Geometry> simple_shape(const sdf::Geometry& geometry, const std::string& element, Model& model) {
  switch (geometry.Type()) {
    case sdf::GeometryType::BOX:
      return core::Box{vec3_of(geometry.BoxShape()->Size()) / 2};
    case sdf::GeometryType::SPHERE:
      return core::Sphere{geometry.SphereShape()->Radius()};
    case sdf::GeometryType::CYLINDER:
      return core::Cylinder{geometry.CylinderShape()->Radius(), geometry.CylinderShape()->Length()};
    case sdf::GeometryType::CAPSULE:
      return core::Capsule{geometry.CapsuleShape()->Radius(), geometry.CapsuleShape()->Length()};
    case sdf::GeometryType::ELLIPSOID: {
      core::ConvexHull hull = ellipsoid_hull(vec3_of(geometry.EllipsoidShape()->Radii()));
      model.lose(element, fmt::format("an ellipsoid: the hull of {} of its points stands for it", hull.points.size()));
      return hull;
    }
    case sdf::GeometryType::PLANE:
      return core::Plane{vec3_of(geometry.PlaneShape()->Normal()), 0};
    default:
      return std::nullopt;
  }
}

}  // namespace

void add_sdf_collision(const sdf::Collision& collision, const std::filesystem::path& folder,
                       const std::vector<std::filesystem::path>& paths, const std::string& link_element, Link& link,
                       Model& model) {
  const std::string element = link_element + "/" + element_name("collision", collision.Name());
  const sdf::Geometry& geometry = *collision.Geom();
  if (geometry.Type() == sdf::GeometryType::EMPTY) return model.note(element, "an empty shape");
  Collision added{.name = collision.Name(),
                  .geometry = {},
                  .X_LC = resolved(collision.SemanticPose(), "", element),
                  .surface = read_surface(collision, element, model)};
  if (geometry.Type() == sdf::GeometryType::MESH) {
    return add_mesh_of(*geometry.MeshShape(), folder, paths, element, std::move(added), link, model);
  }
  if (geometry.Type() == sdf::GeometryType::PLANE && !link.is_static)
    return model.lose(element, "a plane that moves: it is left out");
  const std::optional<Geometry> shape = simple_shape(geometry, element, model);
  if (!shape) {
    const sdf::ElementPtr first = geometry.Element() ? geometry.Element()->GetFirstElement() : nullptr;
    return model.lose(element, fmt::format("a {}: it is left out", first ? first->GetName() : "shape of another kind"));
  }
  added.geometry = *shape;
  link.collisions.push_back(std::move(added));
}

}  // namespace aurasim::importing
