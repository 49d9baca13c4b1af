#include "physics/inner_edges.h"

#include <algorithm>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/bullet_convert.h"
#include "physics/moving_static.h"

namespace aurasim::physics {
namespace {

/// Pieces whose surfaces are at most so far apart, or overlap by so much, along the surface make up one surface.
constexpr btScalar kJoint_m = btScalar(1.2e-3);
/// Surfaces that differ by less in height make up one surface.
constexpr btScalar kStep_m = btScalar(2e-4);
/// A face is looked at around a point, at this distance from it.
constexpr btScalar kAround_m = btScalar(4e-3);
constexpr btScalar kRounding_m = btScalar(1e-6);
/// Cosine of the angle between a contact's normal and that of the face that it is on: 0.15 degrees.
constexpr btScalar kAlong = btScalar(0.9999966);
/// A face whose normal has a smaller product with that of a contact does not take part in it.
constexpr btScalar kPart = btScalar(1e-3);
/// Faces whose normals have a larger product face the same way, so that `kStep_m` holds between them.
constexpr btScalar kFacing = btScalar(0.7);
constexpr int kProjections = 20;
/// After more changes at once, all statics are looked at again instead of those near the changes.
constexpr std::size_t kManyChanges = 32;

bool takes_part(const btCollisionObject& fixed, const btTransform& start) {
  if (!is_moving_static(fixed)) return true;
  const btRigidBody& body = *btRigidBody::upcast(&fixed);
  const btTransform& now = fixed.getWorldTransform();
  constexpr btScalar kMoved = btScalar(1e-9);
  if (!body.getLinearVelocity().isZero() || !body.getAngularVelocity().isZero()) return false;
  if ((now.getOrigin() - start.getOrigin()).length2() > kMoved * kMoved) return false;
  for (int i = 0; i < 3; ++i) {
    if ((now.getBasis()[i] - start.getBasis()[i]).length2() > kMoved * kMoved) return false;
  }
  return true;
}

std::size_t number_of(const btCollisionObject& fixed) { return static_cast<std::size_t>(-1 - fixed.getUserIndex()); }

core::BoxTree::Box box_around(const btVector3& low, const btVector3& high, btScalar more_m) {
  const core::Vec3 more = core::Vec3::Constant(static_cast<double>(more_m));
  return {from_bullet(low) - more, from_bullet(high) + more};
}

core::BoxTree::Box box_around(const btCollisionObject& object, const btTransform& pose, btScalar more_m) {
  btVector3 low, high;
  object.getCollisionShape()->getAabb(pose, low, high);
  return box_around(low, high, more_m);
}

/// A triangle near a contact.
struct MeshTriangle {
  std::array<FlatFace, 5> faces;
  FlatPiece piece;
};

/// Sets the piece of a triangle. Returns false if it has no area.
bool make(MeshTriangle& triangle, const btVector3* corners, const btTransform& pose, const btCollisionObject& mesh,
          int index) {
  const btVector3 in_world[3] = {pose(corners[0]), pose(corners[1]), pose(corners[2])};
  triangle.faces = faces_of_triangle(in_world);
  triangle.piece = {&mesh, index, 0, true, triangle.faces};
  return triangle.faces[0].is_surface;
}

/// The point where the faces of a piece meet that a contact's normal points away from, and the edge there.
struct Feature {
  btVector3 p;
  btVector3 along{0, 0, 0};  ///< direction of the edge; 0: a face or a corner
};

/// Bullet's contact is on the piece's rounded edge, so faces are compared without the margin.
std::optional<Feature> feature_of(const FlatPiece& piece, const StaticContact& contact) {
  std::array<const FlatFace*, 16> parts;
  std::size_t count = 0;
  Feature feature{contact.on_static() - contact.normal * piece.margin_m};
  btVector3& p = feature.p;
  const btScalar tolerance = kJoint_m + std::max(btScalar(0), -contact.gap_m);
  for (const FlatFace& face : piece.faces) {
    const bool is_part = face.normal.dot(contact.normal) > kPart && face.above(p) > -piece.margin_m - tolerance;
    if (is_part && count < parts.size()) parts[count++] = &face;
  }
  if (count == 0) return std::nullopt;
  for (int i = 0; i < (count == 1 ? 1 : kProjections); ++i) {
    for (std::size_t k = 0; k < count; ++k) p -= parts[k]->normal * parts[k]->above(p);
  }
  if (count == 2) feature.along = parts[0]->normal.cross(parts[1]->normal);
  if (!feature.along.fuzzyZero()) feature.along.normalize();
  return feature;
}

/// True if the point is on the surface of a piece that faces `up`, or beside it at a joint.
bool is_at_joint(const FlatPiece& piece, const btVector3& p, const btVector3& up) {
  return std::ranges::all_of(piece.faces, [&](const FlatFace& face) {
    return face.above(p) <= (face.normal.dot(up) > kFacing ? kStep_m : kJoint_m);
  });
}

}  // namespace

struct InnerEdges::Near {
  static constexpr std::size_t kMost = 24;
  std::array<const FlatPiece*, kMost> pieces;
  std::size_t count = 0;
  std::array<MeshTriangle, kMost> triangles;
  std::size_t triangle_count = 0;

  void add(const FlatPiece& piece) {
    if (count < kMost) pieces[count++] = &piece;
  }
  std::span<const FlatPiece* const> all() const { return std::span(pieces).first(count); }
};

const InnerEdges::Fixed* InnerEdges::find(const btCollisionObject& fixed) const {
  const std::size_t number = number_of(fixed);
  return number < fixed_.size() ? fixed_[number].get() : nullptr;
}

void InnerEdges::insert(const btCollisionObject& fixed, const btTransform& start) {
  auto owned = std::make_unique<Fixed>();
  Fixed& made = *owned;
  made.object = &fixed, made.start = start;
  const auto add = [&](const btCollisionShape& shape, const btTransform& pose, int index) {
    made.faces.push_back(faces_of(shape, pose));
    made.pieces.push_back({&fixed, index, shape.isConvex() ? shape.getMargin() : btScalar(0), false, {}});
  };
  const btCollisionShape& shape = *fixed.getCollisionShape();
  if (shape.isCompound()) {
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
      add(*compound.getChildShape(i), start * compound.getChildTransform(i), i);
    }
  } else if (shape.getShapeType() == TRIANGLE_MESH_SHAPE_PROXYTYPE) {
    made.is_mesh = true;
  } else {
    add(shape, start, -1);
  }
  for (std::size_t i = 0; i < made.pieces.size(); ++i) made.pieces[i].faces = made.faces[i];
  const std::size_t number = number_of(fixed);
  if (fixed_.size() <= number) fixed_.resize(number + 1);
  fixed_[number] = std::move(owned);
  changed_.push_back(box_around(fixed, start, 4 * kJoint_m));
}

void InnerEdges::remove(const btCollisionObject& fixed) {
  std::unique_ptr<Fixed>& leaving = fixed_[number_of(fixed)];
  changed_.push_back(box_around(fixed, leaving->start, 4 * kJoint_m));
  leaving.reset();
}

void InnerEdges::settle() {
  if (changed_.empty()) return;
  std::vector<core::BoxTree::Box> boxes;
  entries_.clear(), planes_.clear();
  const auto add = [&](Fixed& fixed, FlatPiece* piece, const btCollisionShape& shape, const btTransform& pose) {
    btVector3 low, high;
    shape.getAabb(pose, low, high);
    boxes.push_back(box_around(low, high, 0));
    entries_.push_back({&fixed, piece});
  };
  for (const std::unique_ptr<Fixed>& one : fixed_) {
    if (one == nullptr) continue;
    Fixed& fixed = *one;
    const btCollisionShape& shape = *fixed.object->getCollisionShape();
    if (fixed.is_mesh) add(fixed, nullptr, shape, fixed.start);
    for (FlatPiece& piece : fixed.pieces) {
      if (piece.faces.empty()) continue;
      if (shape.getShapeType() == STATIC_PLANE_PROXYTYPE) {
        planes_.push_back(&piece);
      } else if (shape.isCompound()) {
        const auto& compound = static_cast<const btCompoundShape&>(shape);
        add(fixed, &piece, *compound.getChildShape(piece.index), fixed.start * compound.getChildTransform(piece.index));
      } else {
        add(fixed, &piece, shape, fixed.start);
      }
    }
  }
  tree_.emplace(std::move(boxes));
  const auto has_changed = [&](const core::BoxTree::Box& box) {
    return changed_.size() > kManyChanges ||
           std::ranges::any_of(changed_, [&](const core::BoxTree::Box& there) { return there.meets(box); });
  };
  for (const std::unique_ptr<Fixed>& fixed : fixed_) {
    if (fixed != nullptr && has_changed(box_around(*fixed->object, fixed->start, 0))) {
      fixed->has_neighbours = has_neighbours(*fixed);
    }
  }
  for (std::uint32_t i = 0; i < entries_.size(); ++i) {
    if (has_changed((*tree_)[i])) note_covers(i);
  }
  changed_.clear();
}

/// Notes which faces of a piece no other piece can cover, by the pieces' bounds.
void InnerEdges::note_covers(std::uint32_t entry) {
  const FlatPiece* const piece = entries_[entry].piece;
  if (piece == nullptr) return;
  const core::BoxTree::Box own = (*tree_)[entry];
  const btVector3 low = to_bullet(own.low), high = to_bullet(own.high);
  const bool on_plane = meets_plane(low, high);
  const auto index = static_cast<std::size_t>(piece - entries_[entry].fixed->pieces.data());
  for (FlatFace& face : entries_[entry].fixed->faces[index]) {
    face.may_be_covered = on_plane || tree_->any(box_around(low, high, 2 * kJoint_m), [&](std::uint32_t i) {
      if (i == entry) return false;
      const btVector3 other_low = to_bullet((*tree_)[i].low), other_high = to_bullet((*tree_)[i].high);
      const btScalar reach = face.normal.absolute().dot((other_high - other_low) / 2);
      return face.above((other_low + other_high) / 2) + reach > kJoint_m - 2 * kStep_m;
    });
  }
}

bool InnerEdges::meets_plane(const btVector3& low, const btVector3& high) const {
  const btVector3 centre = (low + high) / 2, half = (high - low) / 2;
  return std::ranges::any_of(planes_, [&](const FlatPiece* plane) {
    const FlatFace& face = plane->faces[0];
    return face.above(centre) < face.normal.absolute().dot(half) + kJoint_m;
  });
}

bool InnerEdges::has_neighbours(const Fixed& fixed) const {
  const btCollisionShape& shape = *fixed.object->getCollisionShape();
  if (fixed.is_mesh) return true;
  if (shape.getShapeType() == STATIC_PLANE_PROXYTYPE) return false;
  btVector3 low, high;
  shape.getAabb(fixed.start, low, high);
  if (meets_plane(low, high)) return true;
  int met = 0;
  return tree_->any(box_around(low, high, kJoint_m), [&](std::uint32_t) { return ++met > 1; });
}

bool InnerEdges::concerns(const btCollisionObject& fixed) const {
  const Fixed* const known = find(fixed);
  return known != nullptr && known->has_neighbours;
}

void InnerEdges::gather(const btVector3& p, btScalar around_m, Near& near) const {
  struct AddTriangles : btTriangleCallback {
    AddTriangles(Near& to, const Fixed& of) : near(to), mesh(of) {}
    void processTriangle(btVector3* corners, int, int index) override {
      if (near.triangle_count == Near::kMost) return;
      MeshTriangle& triangle = near.triangles[near.triangle_count];
      if (!make(triangle, corners, mesh.start, *mesh.object, index)) return;
      ++near.triangle_count;
      near.add(triangle.piece);
    }
    Near& near;
    const Fixed& mesh;
  };
  for (const FlatPiece* plane : planes_) {
    if (plane->faces[0].above(p) < around_m && takes_part(*plane->object, find(*plane->object)->start))
      near.add(*plane);
  }
  tree_->any(box_around(p, p, around_m), [&](std::uint32_t i) {
    const Entry& entry = entries_[i];
    if (!takes_part(*entry.fixed->object, entry.fixed->start)) return false;
    if (entry.piece != nullptr) {
      near.add(*entry.piece);
    } else {
      AddTriangles add(near, *entry.fixed);
      const btVector3 centre = entry.fixed->start.invXform(p), half(around_m, around_m, around_m);
      static_cast<const btBvhTriangleMeshShape&>(*entry.fixed->object->getCollisionShape())
          .processAllTriangles(&add, centre - half, centre + half);
    }
    return false;
  });
}

/// True if other pieces leave a part of the face free around a point of it.
bool InnerEdges::is_exposed(const FlatPiece& piece, const FlatFace& face, const btVector3& p, const Near& near) const {
  btVector3 first, second;
  btPlaneSpace1(face.normal, first, second);
  const btVector3 on_face = p - face.normal * face.above(p);
  constexpr btScalar kHalf = btScalar(0.70710678);
  const btVector3 around[] = {{0, 0, 0},
                              first,
                              -first,
                              second,
                              -second,
                              (first + second) * kHalf,
                              (first - second) * kHalf,
                              (second - first) * kHalf,
                              (first + second) * -kHalf};
  return std::ranges::any_of(around, [&](const btVector3& aside) {
    const btVector3 there = on_face + aside * kAround_m;
    if (!piece.holds(there, kRounding_m, &face)) return false;
    return std::ranges::none_of(near.all(), [&](const FlatPiece* other) {
      return !other->is(piece) && other->covers(there + face.normal * kJoint_m, kStep_m);
    });
  });
}

/// True if no exposed face or edge of the statics has the normal of a contact at the point p of `own`. An edge counts
/// as exposed if it is so on one side of p: a post's edge meets the floor at a point, and is a real edge above it.
bool InnerEdges::is_inner(const StaticContact& found, const FlatPiece& own, const btVector3& p, const btVector3& along,
                          const Near& near) const {
  for (const FlatFace& face : own.faces) {
    const bool is_on = face.is_surface && face.normal.dot(found.normal) > kAlong;
    if (is_on) return !own.is_triangle && !is_exposed(own, face, p, near);
  }
  const auto is_covered = [&](const btVector3& there) {
    return std::ranges::any_of(near.all(), [&](const FlatPiece* other) {
      return !other->is(own) && is_at_joint(*other, there, found.normal) &&
             rises_above(*other, there, found.normal, kJoint_m);
    });
  };
  if (!is_covered(p)) return false;
  if (along.isZero()) return true;
  return std::ranges::none_of(std::array{p + along * kAround_m, p - along * kAround_m}, [&](const btVector3& there) {
    return own.holds(there, kRounding_m) && !is_covered(there);
  });
}

/// The contact with the exposed face at p whose normal is nearest to that of a contact with an inner edge.
std::optional<StaticContact> InnerEdges::moved(const StaticContact& found, const FlatPiece& own, const btVector3& p,
                                               const PlacedShape& body, const Near& near) const {
  const FlatFace* best = nullptr;
  const btScalar tolerance = kJoint_m + std::max(btScalar(0), -found.gap_m);
  const auto consider = [&](const FlatPiece& piece) {
    for (const FlatFace& face : piece.faces) {
      const btScalar along = face.normal.dot(found.normal), above = face.above(p);
      if (!face.is_surface || along < -10 * kPart || btFabs(above) > tolerance) continue;
      if (best != nullptr && along < best->normal.dot(found.normal) + kRounding_m) continue;
      if (!piece.holds(p - face.normal * above, kJoint_m, &face)) continue;
      const bool is_free = piece.is_triangle ? face.above(body.pose.getOrigin()) > 0 : is_exposed(piece, face, p, near);
      if (is_free) best = &face;
    }
  };
  consider(own);
  for (const FlatPiece* other : near.all()) {
    if (!other->is(own)) consider(*other);
  }
  if (best == nullptr) return std::nullopt;

  const auto contact_at = [&](const btVector3& on_body) {
    return StaticContact{best->normal, on_body, best->above(on_body)};
  };
  const StaticContact at_lowest = contact_at(lowest_point(body, best->normal, found.on_body, found.normal));
  const btVector3 below = at_lowest.on_static();
  if (own.holds(below, kStep_m)) return at_lowest;
  Near there;
  gather(below, kJoint_m, there);
  const auto any = [&](const auto& of) {
    return std::ranges::any_of(there.all(), [&](const FlatPiece* other) { return of(*other); });
  };
  if (any([&](const FlatPiece& other) {
        return other.holds(below, kStep_m);
      })) {  // other pieces have this contact; triangles of one mesh share their contacts
    const auto in_mesh = [&](const FlatPiece& other) {
      return other.object == own.object && other.holds(below, kStep_m);
    };
    if (own.is_triangle && any(in_mesh)) return at_lowest;
    return std::nullopt;
  }
  const bool at_joint = any([&](const FlatPiece& other) { return is_at_joint(other, below, best->normal); });
  return at_joint ? at_lowest : contact_at(found.on_body);
}

std::optional<StaticContact> InnerEdges::corrected(const StaticContact& found, const btCollisionObject& fixed,
                                                   int index, const PlacedShape& of_static,
                                                   const PlacedShape& of_body) const {
  const Fixed* const known = find(fixed);
  if (known == nullptr || !of_body.shape.isConvex() || !takes_part(fixed, known->start)) return found;
  MeshTriangle triangle;
  const FlatPiece* own = &triangle.piece;
  if (of_static.shape.getShapeType() == TRIANGLE_SHAPE_PROXYTYPE) {
    const btVector3* const corners = static_cast<const btTriangleShape&>(of_static.shape).m_vertices1;
    const btVector3 up = of_static.pose.getBasis() * (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const btScalar along = up.dot(found.normal);
    if (along * along > kAlong * kAlong * up.length2()) return found;
    if (!make(triangle, corners, of_static.pose, fixed, index)) return found;
  } else {
    const auto place = static_cast<std::size_t>(std::max(0, index));
    if (place >= known->pieces.size() || known->pieces[place].faces.empty()) return found;
    own = &known->pieces[place];
    const bool is_on_face = std::ranges::any_of(own->faces, [&](const FlatFace& face) {
      return !face.may_be_covered && face.normal.dot(found.normal) > kAlong;
    });
    if (is_on_face) return found;
  }
  const std::optional<Feature> at = feature_of(*own, found);
  if (!at) return found;
  Near near;
  gather(at->p, kAround_m + 2 * kJoint_m, near);
  const bool is_alone = std::ranges::all_of(near.all(), [&](const FlatPiece* other) { return other->is(*own); });
  if (is_alone || !is_inner(found, *own, at->p, at->along, near)) return found;
  return moved(found, *own, at->p, of_body, near);
}

}  // namespace aurasim::physics
