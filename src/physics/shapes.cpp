#include "physics/shapes.h"

#include <algorithm>
#include <stdexcept>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <LinearMath/btConvexHullComputer.h>

#include "physics/bullet_convert.h"
#include "physics/hull_shape.h"
#include "physics/inertia.h"
#include "physics/part_surfaces.h"

namespace aurasim::physics {
namespace {

std::unique_ptr<HullShape> exact_hull(const core::ConvexHull& shape, double margin_m) {
  if (shape.points.empty()) throw std::invalid_argument("a convex hull without points");
  std::vector<btVector3> points;
  for (const core::Vec3& p : shape.points) points.push_back(to_bullet(p));
  auto hull = std::make_unique<HullShape>(points.data(), static_cast<int>(points.size()));
  hull->setMargin(scalar(margin_m));
  return hull;
}

/// Makes a hull with its margin inside. Bullet puts the margin outside, so the faces are first moved inwards by as
/// much.
std::unique_ptr<HullShape> shrunken_hull(const core::ConvexHull& shape) {
  constexpr double kMargin = 0.04;             // m, Bullet's default
  constexpr double kShareOfInnerRadius = 0.1;  // as Bullet's safe margin of boxes
  constexpr double kMarginOfFlatHull = 0.001;  // share of the bounding radius
  if (shape.points.size() >= 4) {
    btConvexHullComputer computer;
    const btScalar moved =
        computer.compute(shape.points.front().data(), sizeof(core::Vec3), static_cast<int>(shape.points.size()),
                         scalar(kMargin), scalar(kShareOfInnerRadius));
    if (moved > 0 && computer.vertices.size() >= 4) {
      auto hull = std::make_unique<HullShape>(&computer.vertices[0], computer.vertices.size());
      hull->setMargin(moved);
      return hull;
    }
  }
  return exact_hull(shape, kMarginOfFlatHull * core::bounding_radius(shape));
}

template <class Rounded>
std::unique_ptr<btConvexShape> with_margin(std::unique_ptr<Rounded> shape, Margin margin) {
  if (margin == Margin::kNone) shape->setMargin(0);
  return shape;
}

/// Makes convex shapes. Bullet's spheres and capsules are a point and a segment with a margin, so they are exact with
/// either Margin.
struct MakeConvex {
  Margin margin;

  std::unique_ptr<btConvexShape> operator()(const core::Sphere& s) const {
    return std::make_unique<btSphereShape>(scalar(s.radius));
  }
  std::unique_ptr<btConvexShape> operator()(const core::Capsule& s) const {
    return std::make_unique<btCapsuleShapeZ>(scalar(s.radius), scalar(s.height));
  }
  std::unique_ptr<btConvexShape> operator()(const core::Box& s) const {
    return with_margin(std::make_unique<BoxShape>(s.half_extents), margin);
  }
  std::unique_ptr<btConvexShape> operator()(const core::Cylinder& s) const {
    const core::Vec3 half_extents(s.radius, s.radius, s.height / 2);
    return with_margin(std::make_unique<btCylinderShapeZ>(to_bullet(half_extents)), margin);
  }
  std::unique_ptr<btConvexShape> operator()(const core::ConvexHull& s) const {
    if (margin == Margin::kNone) return exact_hull(s, 0);
    std::unique_ptr<HullShape> hull = shrunken_hull(s);
    hull->set_faces(hull_faces(s.points));
    return hull;
  }
};

std::unique_ptr<btTriangleMesh> triangles_of(const core::TriangleMesh& s) {
  auto mesh = std::make_unique<btTriangleMesh>(/*use32bitIndices=*/true, /*use4componentVertices=*/false);
  for (const auto& corners : s.triangles) {
    mesh->addTriangle(to_bullet(s.points.at(corners[0])), to_bullet(s.points.at(corners[1])),
                      to_bullet(s.points.at(corners[2])));
  }
  return mesh;
}

}  // namespace

std::unique_ptr<btConvexShape> make_convex(const core::ConvexShape& shape, Margin margin) {
  return std::visit(MakeConvex{margin}, shape);
}

/// A shape and what it points at. The shape is the last member, so that it is destroyed first.
struct ShapeSet::Built {
  std::unique_ptr<btStridingMeshInterface> mesh;
  std::vector<std::unique_ptr<btConvexShape>> parts;
  std::unique_ptr<const PartSurfaces> surfaces;
  std::unique_ptr<btCollisionShape> shape;

  struct Make;
};

struct ShapeSet::Built::Make {
  const core::Scene& scene;

  template <class Convex>
  Built operator()(const Convex& s) const {
    Built built;
    built.shape = make_convex(s, Margin::kInside);
    return built;
  }

  /// Built without Bullet's tree over the parts. The tree culls by other boxes than those by which Bullet drops a
  /// part's contacts, so contacts would depend on when the pair met, and so on hand-offs.
  Built operator()(const core::Compound& s) const {
    Built built;
    auto compound =
        std::make_unique<btCompoundShape>(/*enableDynamicAabbTree=*/false, static_cast<int>(s.parts.size()));
    for (const core::CompoundPart& part : s.parts) {
      built.parts.push_back(make_convex(part.shape, Margin::kInside));
      compound->addChildShape(to_bullet(part.pose), built.parts.back().get());
    }
    built.surfaces = part_surfaces_of(s, scene);
    set_part_surfaces(*compound, built.surfaces.get());
    built.shape = std::move(compound);
    return built;
  }

  /// Built without margin: a mesh has no inside, so the margin would lie on top and bodies would hover.
  Built operator()(const core::TriangleMesh& s) const {
    if (s.triangles.empty()) throw std::invalid_argument("a triangle mesh without triangles");
    Built built;
    built.mesh = triangles_of(s);
    auto mesh = std::make_unique<btBvhTriangleMeshShape>(built.mesh.get(), /*useQuantizedAabbCompression=*/true);
    mesh->setMargin(0);
    built.shape = std::move(mesh);
    return built;
  }

  Built operator()(const core::Plane& s) const {
    Built built;
    const double length = s.normal.norm();
    built.shape =
        std::make_unique<btStaticPlaneShape>(to_bullet(core::Vec3(s.normal / length)), scalar(s.offset / length));
    return built;
  }
};

ShapeSet::ShapeSet(const core::Scene& scene) { extend(scene); }

void ShapeSet::extend(const core::Scene& scene) {
  std::vector<core::Vec3> inertias;
  std::vector<Built> built;
  for (std::size_t i = inertias_.size(); i < scene.prototypes.size(); ++i) {
    inertias.push_back(inertia_of(scene.prototypes[i], scene));
  }
  for (std::size_t i = shapes_.size(); i < scene.shapes.size(); ++i) {
    built.push_back(std::visit(Built::Make{scene}, scene.shapes[i].shape));
  }
  inertias_.insert(inertias_.end(), inertias.begin(), inertias.end());
  std::move(built.begin(), built.end(), std::back_inserter(shapes_));
}

ShapeSet::~ShapeSet() = default;

btCollisionShape* ShapeSet::shape(std::uint32_t index) const { return shapes_.at(index).shape.get(); }

const core::Vec3& ShapeSet::inertia(core::PrototypeId prototype) const {
  return inertias_.at(core::value_of(prototype));
}

}  // namespace aurasim::physics
