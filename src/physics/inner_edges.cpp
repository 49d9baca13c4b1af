#include "physics/inner_edges.h"

#include <algorithm>
#include <array>
#include <span>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

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
/// Contacts that are deeper than this are not compared with other pieces, because those may be out of reach.
constexpr btScalar kDeepest_m = btScalar(1.5);
static_assert(kDeepest_m + 0.1 < InnerEdges::kReach_m);

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

btDbvtVolume volume_around(const btVector3& low, const btVector3& high, btScalar more_m) {
  const btVector3 more(more_m, more_m, more_m);
  return btDbvtVolume::FromMM(low - more, high + more);
}

/// Calls `found(leaf)` for the leaves that meet a volume, in the order of the tree.
template <class Found>
void for_each_leaf(const btDbvt& tree, const btDbvtVolume& where, Found&& found) {
  struct Policy : btDbvt::ICollide {
    explicit Policy(Found& to) : call(to) {}
    void Process(const btDbvtNode* leaf) { call(*leaf); }
    Found& call;
  } policy(found);
  tree.collideTV(tree.m_root, where, policy);
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

/// True if the half-space of a plane comes to a volume.
bool meets(const FlatPiece& plane, const btDbvtVolume& volume) {
  const FlatFace& face = plane.faces[0];
  return face.above(volume.Center()) < face.normal.absolute().dot(volume.Extents()) + kJoint_m;
}

}  // namespace

/// A piece in the tree, or a mesh.
struct InnerEdges::Piece {
  Fixed* fixed = nullptr;
  FlatPiece flat;               ///< no faces: a mesh
  std::vector<FlatFace> faces;  ///< of `flat`
  btDbvtNode* leaf = nullptr;

  void note_beside(const btDbvtVolume& other);
  void note_plane();
};

struct InnerEdges::Fixed {
  const btCollisionObject* object = nullptr;
  btTransform start = btTransform::getIdentity();
  bool is_mesh = false;
  bool has_neighbours = false;
  std::vector<Piece> pieces;  ///< its own, or those of its children
};

struct InnerEdges::Near {
  static constexpr std::size_t kMost = 24;
  std::array<const FlatPiece*, kMost> pieces;
  std::size_t count = 0;
  std::array<MeshTriangle, kMost> triangles;
  std::size_t triangle_count = 0;

  void add(const FlatPiece& piece) {
    if (count < kMost) pieces[count++] = &piece;
  }
  void add_triangles(const Fixed& mesh, const btVector3& p, btScalar around_m);
  std::span<const FlatPiece* const> all() const { return std::span(pieces).first(count); }
};

InnerEdges::InnerEdges() = default;
InnerEdges::~InnerEdges() = default;

const InnerEdges::Fixed* InnerEdges::find(const btCollisionObject& fixed) const {
  const std::size_t number = number_of(fixed);
  return number < fixed_.size() ? fixed_[number].get() : nullptr;
}

void InnerEdges::insert(const btCollisionObject& fixed, const btTransform& start) {
  const std::size_t number = number_of(fixed);
  if (fixed_.size() <= number) fixed_.resize(number + 1);
  fixed_[number] = std::make_unique<Fixed>();
  Fixed& made = *fixed_[number];
  made.object = &fixed, made.start = start;
  const btCollisionShape& shape = *fixed.getCollisionShape();
  made.is_mesh = made.has_neighbours = shape.getShapeType() == TRIANGLE_MESH_SHAPE_PROXYTYPE;
  if (shape.getShapeType() == STATIC_PLANE_PROXYTYPE) return add_plane(made);
  if (!shape.isCompound()) {
    made.pieces.reserve(1);
    return add_piece(made, shape, start, -1);
  }
  const auto& compound = static_cast<const btCompoundShape&>(shape);
  made.pieces.reserve(static_cast<std::size_t>(compound.getNumChildShapes()));
  for (int i = 0; i < compound.getNumChildShapes(); ++i) {
    add_piece(made, *compound.getChildShape(i), start * compound.getChildTransform(i), i);
  }
}

void InnerEdges::add_plane(Fixed& plane) {
  const btCollisionShape& shape = *plane.object->getCollisionShape();
  Piece& piece = plane.pieces.emplace_back();
  piece.fixed = &plane;
  piece.faces = faces_of(shape, plane.start);
  piece.flat = {plane.object, -1, shape.getMargin(), false, piece.faces};
  const auto place = std::ranges::lower_bound(planes_, number_of(*plane.object), {},
                                              [](const Fixed* other) { return number_of(*other->object); });
  planes_.insert(place, &plane);
  for (const std::unique_ptr<Fixed>& other : fixed_) {
    if (other == nullptr) continue;
    for (Piece& beside : other->pieces) {
      if (beside.leaf != nullptr && meets(piece.flat, beside.leaf->volume)) beside.note_plane();
    }
  }
}

/// Adds a piece of a static, and notes which pieces are beside each other. Pieces that leave are not noted, because a
/// static that seems to have neighbours only costs time.
void InnerEdges::add_piece(Fixed& fixed, const btCollisionShape& shape, const btTransform& pose, int index) {
  Piece& piece = fixed.pieces.emplace_back();
  piece.fixed = &fixed;
  piece.faces = faces_of(shape, pose);
  piece.flat = {fixed.object, index, shape.isConvex() ? shape.getMargin() : btScalar(0), false, piece.faces};
  if (piece.faces.empty() && !fixed.is_mesh) return;
  btVector3 low, high;
  shape.getAabb(pose, low, high);
  const btDbvtVolume own = volume_around(low, high, 0);
  for_each_leaf(tree_, volume_around(low, high, 2 * kJoint_m), [&](const btDbvtNode& leaf) {
    piece.note_beside(leaf.volume);
    static_cast<Piece*>(leaf.data)->note_beside(own);
  });
  const bool is_on_plane =
      std::ranges::any_of(planes_, [&](const Fixed* plane) { return meets(plane->pieces[0].flat, own); });
  if (is_on_plane) piece.note_plane();
  piece.leaf = tree_.insert(own, &piece);
}

/// Notes that another piece has these bounds, which come near.
void InnerEdges::Piece::note_beside(const btDbvtVolume& other) {
  fixed->has_neighbours = true;
  const btVector3 centre = other.Center(), half = other.Extents();
  for (FlatFace& face : faces) {
    const btScalar reach = face.normal.absolute().dot(half);
    if (face.above(centre) + reach > kJoint_m - 2 * kStep_m) face.may_be_covered = true;
  }
}

void InnerEdges::Piece::note_plane() {
  fixed->has_neighbours = true;
  for (FlatFace& face : faces) face.may_be_covered = true;
}

void InnerEdges::remove(const btCollisionObject& fixed) {
  std::unique_ptr<Fixed>& leaving = fixed_[number_of(fixed)];
  std::erase(planes_, leaving.get());
  for (const Piece& piece : leaving->pieces) {
    if (piece.leaf != nullptr) tree_.remove(piece.leaf);
  }
  leaving.reset();
}

bool InnerEdges::concerns(const btCollisionObject& fixed) const {
  const Fixed* const known = find(fixed);
  return known != nullptr && known->has_neighbours;
}

void InnerEdges::Near::add_triangles(const Fixed& mesh, const btVector3& p, btScalar around_m) {
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
  } add(*this, mesh);
  const btVector3 centre = mesh.start.invXform(p), half(around_m, around_m, around_m);
  static_cast<const btBvhTriangleMeshShape&>(*mesh.object->getCollisionShape())
      .processAllTriangles(&add, centre - half, centre + half);
}

/// Gathers planes first, then pieces in the order of statics, so that the tree's past does not matter.
void InnerEdges::gather(const btVector3& p, btScalar around_m, Near& near) const {
  for (const Fixed* plane : planes_) {
    if (plane->pieces[0].faces[0].above(p) < around_m && takes_part(*plane->object, plane->start)) {
      near.add(plane->pieces[0].flat);
    }
  }
  std::array<const Piece*, Near::kMost> found;
  std::size_t count = 0;
  const auto earlier = [](const Piece* a, const Piece* b) {
    const std::size_t of_a = number_of(*a->fixed->object), of_b = number_of(*b->fixed->object);
    return of_a != of_b ? of_a < of_b : a->flat.index < b->flat.index;
  };
  for_each_leaf(tree_, volume_around(p, p, around_m), [&](const btDbvtNode& leaf) {
    const auto* const piece = static_cast<const Piece*>(leaf.data);
    if (!takes_part(*piece->fixed->object, piece->fixed->start)) return;
    auto* const place = std::upper_bound(found.begin(), found.begin() + count, piece, earlier);
    if (place == found.end()) return;
    if (count < found.size()) ++count;
    std::copy_backward(place, found.begin() + count - 1, found.begin() + count);
    *place = piece;
  });
  for (const Piece* piece : std::span(found).first(count)) {
    if (piece->fixed->is_mesh) {
      near.add_triangles(*piece->fixed, p, around_m);
    } else {
      near.add(piece->flat);
    }
  }
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
  if (btFabs(at_lowest.gap_m) > kDeepest_m) return contact_at(found.on_body);
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
    own = &known->pieces[place].flat;
    const bool is_on_face = std::ranges::any_of(own->faces, [&](const FlatFace& face) {
      return !face.may_be_covered && face.normal.dot(found.normal) > kAlong;
    });
    if (is_on_face) return found;
  }
  const std::optional<Feature> at = feature_of(*own, found);
  if (!at || at->p.distance2(found.on_body) > kDeepest_m * kDeepest_m) return found;
  Near near;
  gather(at->p, kAround_m + 2 * kJoint_m, near);
  const bool is_alone = std::ranges::all_of(near.all(), [&](const FlatPiece* other) { return other->is(*own); });
  if (is_alone || !is_inner(found, *own, at->p, at->along, near)) return found;
  return moved(found, *own, at->p, of_body, near);
}

}  // namespace aurasim::physics
