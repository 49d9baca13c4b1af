#include "config/shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "config/heightfield.h"
#include "config/meshes.h"
#include "config/scene_draft.h"
#include "config/shape_keys.h"
#include "core/limits.h"

namespace aurasim::config {
namespace {

using core::ConvexShape;
using core::Shape;
using core::Vec3;

std::optional<Shape> read_sphere(const Fields& fields) {
  const auto radius = fields["radius"].number();
  if (!radius) return std::nullopt;
  return core::Sphere{*radius};
}

std::optional<Shape> read_box(const Fields& fields) {
  const auto size = fields["size"].vec3();
  if (!size) return std::nullopt;
  return core::Box{*size / 2};
}

std::optional<Shape> read_capsule(const Fields& fields) {
  const auto radius = fields["radius"].number();
  if (fields.given_of(capsule_keys()).size() != 1) {
    fields.whole().refuse("one of height (between the cap centres), total_height");
    return std::nullopt;
  }
  if (const Field height_field = fields["height"]; height_field.given()) {
    const auto height = height_field.number();
    if (!radius || !height) return std::nullopt;
    return core::Capsule{*radius, *height};
  }
  const auto total = fields["total_height"].number(Range::above(2 * radius.value_or(0), kSize.high));
  if (!radius || !total) return std::nullopt;
  return core::Capsule{*radius, *total - 2 * *radius};
}

std::optional<Shape> read_cylinder(const Fields& fields) {
  const auto radius = fields["radius"].number();
  const auto height = fields["height"].number();
  if (!radius || !height) return std::nullopt;
  return core::Cylinder{*radius, *height};
}

std::optional<Shape> read_plane(const Fields& fields) {
  const Field normal_field = fields["normal"];
  const Field offset_field = fields["offset"];
  const auto normal = normal_field.given() ? normal_field.vec3() : Vec3::UnitZ();
  const auto offset = offset_field.given() ? offset_field.number() : 0;
  if (!normal || !offset) return std::nullopt;
  if (normal->norm() < 1e-6) {
    normal_field.complain("found a normal of length 0, allowed: [x, y, z] that can be normalised");
    return std::nullopt;
  }
  return core::Plane{normal->normalized(), *offset};
}

/// Reads the mesh file of a hull or a mesh: `mesh`/`file`, `scale` and `up`.
std::optional<core::TriangleMesh> read_mesh_file(const Field& file_field, const Fields& fields,
                                                 const std::filesystem::path& folder) {
  const auto name = file_field.text();
  MeshRequest request;
  bool good = name.has_value();
  if (name) request = {.file = (folder / *name).lexically_normal(), .up = usual_up_axis(*name)};
  if (const Field scale = fields["scale"]; scale.given()) {
    const auto each = scale.is_list() ? scale.vec3() : std::nullopt;
    const auto all = scale.is_list() ? std::nullopt : scale.number();
    good = good && (each || all);
    request.scale = each ? *each : Vec3::Constant(all.value_or(1));
  }
  if (const Field up = fields["up"]; up.given()) {
    const auto axis = up.choice<UpAxis>();
    good = good && axis;
    request.up = axis.value_or(request.up);
  }
  if (!good) return std::nullopt;
  auto loaded = load_mesh(request);
  if (auto* mesh = std::get_if<core::TriangleMesh>(&loaded)) return std::move(*mesh);
  file_field.refuse(fmt::format("a mesh file with triangles ({})", std::get<std::string>(loaded)));
  return std::nullopt;
}

/// True when the points enclose a volume that is no thinner than a millionth of their extent.
bool has_volume(const std::vector<Vec3>& points) {
  const auto farthest = [&](auto measure) {
    Vec3 best = Vec3::Zero();
    for (const Vec3& p : points) {
      if (measure(p - points[0]) > measure(best)) best = p - points[0];
    }
    return best;
  };
  const Vec3 a = farthest([](const Vec3& p) { return p.norm(); });
  const Vec3 b = farthest([&](const Vec3& p) { return p.cross(a).norm(); });
  const Vec3 c = farthest([&](const Vec3& p) { return std::abs(p.dot(a.cross(b))); });
  const double extent = a.norm();
  return std::abs(c.dot(a.cross(b))) > 1e-6 * extent * extent * extent;
}

std::optional<std::vector<Vec3>> read_points(const Field& field) {
  std::vector<Vec3> points;
  const std::vector<Field> items = field.items();
  for (const Field& item : items) {
    if (const auto p = item.vec3()) points.push_back(*p);
  }
  if (points.empty() || points.size() != items.size()) return std::nullopt;
  return points;
}

/// Returns the fields of a hull with the keys of its source (points or a mesh), or of both if the file does not say
/// which.
Fields fields_of_hull(const Field& field) {
  const bool of_points = field.is_map() && field.node()->find("points") != nullptr;
  const bool of_mesh = field.is_map() && field.node()->find("mesh") != nullptr;
  if (of_points == of_mesh) return Fields::of_any_table(field);
  return Fields(field, of_points ? hull_of_points_keys() : hull_of_mesh_keys());
}

std::optional<Shape> read_convex_hull(const Fields& fields, const std::filesystem::path& folder) {
  if (fields.has("points") == fields.has("mesh")) {
    fields.whole().refuse("one of points, mesh");
    return std::nullopt;
  }
  std::optional<std::vector<Vec3>> points;
  if (fields.has("points")) {
    points = read_points(fields["points"]);
  } else {
    const bool recentre = fields["recentre"].flag().value_or(false);
    const auto mesh = read_mesh_file(fields["mesh"], fields, folder);
    const Vec3 centre = mesh && recentre ? centre_of_mass(*mesh) : Vec3::Zero();
    if (mesh) points = hull_points(*mesh);
    for (std::size_t i = 0; points && i < points->size(); ++i) (*points)[i] -= centre;
  }
  if (!points) return std::nullopt;
  if (!has_volume(*points)) {
    fields.whole().refuse("at least 4 points that do not lie in one plane");
    return std::nullopt;
  }
  return core::ConvexHull{std::move(*points)};
}

std::optional<Shape> read_mesh(const Fields& fields, const std::filesystem::path& folder) {
  auto mesh = read_mesh_file(fields["file"], fields, folder);
  if (!mesh) return std::nullopt;
  return std::move(*mesh);
}

std::optional<Shape> read_shape_kind(const Field& field, const SceneDraft& draft);

std::optional<ConvexShape> as_convex(Shape&& shape) {
  return std::visit(
      [](auto&& s) -> std::optional<ConvexShape> {
        using S = std::decay_t<decltype(s)>;
        if constexpr (std::is_constructible_v<ConvexShape, S>) {
          return std::optional<ConvexShape>(std::in_place, std::in_place_type<S>, std::move(s));
        } else {
          return std::nullopt;
        }
      },
      std::move(shape));
}

std::optional<core::CompoundPart> read_part(const Field& field, const SceneDraft& draft) {
  const Fields fields(field);
  const std::vector<Field> kinds = fields.given_of(part_keys());
  std::optional<ConvexShape> shape;
  for (const Field& kind : kinds) {
    if (auto read = read_shape_kind(kind, draft)) shape = as_convex(std::move(*read));
  }
  const core::Pose pose = read_pose(fields);
  const Field material = fields["material"];
  const std::optional<std::uint32_t> own = material.given() ? draft.materials.find(material) : std::nullopt;
  fields.close();
  if (fields.given() && kinds.size() != 1) field.refuse("one of sphere, box, capsule, cylinder, convex_hull");
  if (!shape || kinds.size() != 1) return std::nullopt;
  return core::CompoundPart{std::move(*shape), pose, own};
}

std::optional<Shape> read_compound(const Fields& fields, const SceneDraft& draft) {
  core::Compound compound;
  const std::vector<Field> items = fields["parts"].items();
  for (const Field& item : items) {
    if (auto part = read_part(item, draft)) compound.parts.push_back(std::move(*part));
  }
  if (compound.parts.empty() || compound.parts.size() != items.size()) return std::nullopt;
  return compound;
}

/// Checks the extent that results from sizes, scales and places of parts.
void check_size(const Field& field, const Shape& shape) {
  using namespace core::limits;
  constexpr double kRounded = 1e-9;
  if (std::holds_alternative<core::Plane>(shape)) return;
  const double radius_m = core::bounding_radius(shape);
  if (!(radius_m <= kLargestSize_m)) {
    field.complain(
        fmt::format("found a shape that reaches {:.4g} m from its origin, allowed: {:g} m", radius_m, kLargestSize_m));
  } else if (!std::holds_alternative<core::Compound>(shape) &&  // the parts of a compound have been checked
             !(thickness_m(shape) >= kSmallestSize_m * (1 - kRounded))) {
    field.complain(fmt::format("found a shape that is {:.4g} m thin, allowed: {:g} m or more", thickness_m(shape),
                               kSmallestSize_m));
  }
}

/// `field` is the value of a key of shape_keys.
std::optional<Shape> read_shape_kind(const Field& field, const SceneDraft& draft) {
  const std::string kind = field.path().substr(field.path().rfind('.') + 1);
  const Fields fields = kind == "convex_hull" ? fields_of_hull(field) : Fields(field);
  std::optional<Shape> shape;
  if (!fields.given()) {
    field.refuse(fmt::format("a map, the sizes of the {}", kind));
    return std::nullopt;
  }
  if (kind == "sphere") shape = read_sphere(fields);
  if (kind == "box") shape = read_box(fields);
  if (kind == "capsule") shape = read_capsule(fields);
  if (kind == "cylinder") shape = read_cylinder(fields);
  if (kind == "convex_hull") shape = read_convex_hull(fields, draft.folder);
  if (kind == "compound") shape = read_compound(fields, draft);
  if (kind == "mesh") shape = read_mesh(fields, draft.folder);
  if (kind == "heightfield") shape = read_heightfield(fields);
  if (kind == "plane") shape = read_plane(fields);
  fields.close();
  if (shape) check_size(field, *shape);
  return shape;
}

Bounds hull_of(const std::vector<Vec3>& points) {
  Bounds bounds{points.front(), points.front()};
  for (const Vec3& p : points) bounds = {bounds.low.cwiseMin(p), bounds.high.cwiseMax(p)};
  return bounds;
}

Bounds around(const Vec3& half) { return {-half, half}; }

Bounds bounds_of_part(const core::CompoundPart& part);

struct BoundsOf {
  Bounds operator()(const core::Sphere& s) const { return around(Vec3::Constant(s.radius)); }
  Bounds operator()(const core::Box& s) const { return around(s.half_extents); }
  Bounds operator()(const core::Capsule& s) const { return around({s.radius, s.radius, s.height / 2 + s.radius}); }
  Bounds operator()(const core::Cylinder& s) const { return around({s.radius, s.radius, s.height / 2}); }
  Bounds operator()(const core::ConvexHull& s) const { return hull_of(s.points); }
  Bounds operator()(const core::Compound& s) const {
    Bounds bounds = bounds_of_part(s.parts.front());
    for (const core::CompoundPart& part : s.parts) {
      const Bounds other = bounds_of_part(part);
      bounds = {bounds.low.cwiseMin(other.low), bounds.high.cwiseMax(other.high)};
    }
    return bounds;
  }
  Bounds operator()(const core::TriangleMesh&) const { return {}; }
  Bounds operator()(const core::Plane&) const { return {}; }
};

/// Bounds of a part: a box around its rotated box, so never too small.
Bounds bounds_of_part(const core::CompoundPart& part) {
  const Bounds own = std::visit(BoundsOf(), part.shape);
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner((i & 1 ? own.high : own.low).x(), (i & 2 ? own.high : own.low).y(),
                      (i & 4 ? own.high : own.low).z());
    corners.push_back(part.pose.p_WB + part.pose.q_WB * corner);
  }
  return hull_of(corners);
}

/// How thick a shape is along its thinnest axis.
struct Thickness {
  double operator()(const core::Sphere& s) const { return 2 * s.radius; }
  double operator()(const core::Box& s) const { return 2 * s.half_extents.minCoeff(); }
  double operator()(const core::Capsule& s) const { return s.height > 0 ? 2 * s.radius : 0; }
  double operator()(const core::Cylinder& s) const { return std::min(2 * s.radius, s.height); }
  double operator()(const core::ConvexHull& s) const {
    if (s.points.empty()) return 0;
    core::Vec3 low = s.points.front(), high = low;
    for (const core::Vec3& p : s.points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    return (high - low).minCoeff();
  }
  double operator()(const core::Compound& s) const {
    double thinnest = std::numeric_limits<double>::infinity();
    for (const core::CompoundPart& part : s.parts) thinnest = std::min(thinnest, std::visit(*this, part.shape));
    return s.parts.empty() ? 0 : thinnest;
  }
  template <class Other>
  double operator()(const Other&) const {
    return std::numeric_limits<double>::infinity();
  }
};

}  // namespace

std::optional<Shape> read_shape(const Field& field, const SceneDraft& draft) {
  const Fields fields(field);
  const std::vector<Field> kinds = fields.given_of(shape_keys());
  std::optional<Shape> shape;
  for (const Field& kind : kinds) shape = read_shape_kind(kind, draft);
  fields.close();
  if (kinds.size() == 1) return shape;
  if (kinds.size() > 1) field.refuse("a shape of one kind");
  if (fields.given() && field.node()->children.empty()) field.refuse("a shape of one kind");
  return std::nullopt;
}

bool can_move(const Shape& shape) {
  return !std::holds_alternative<core::TriangleMesh>(shape) && !std::holds_alternative<core::Plane>(shape);
}

double thickness_m(const Shape& shape) { return std::visit(Thickness{}, shape); }

Bounds bounds_of(const Shape& shape) { return std::visit(BoundsOf(), shape); }

}  // namespace aurasim::config
