// Contacts with inner edges: edges of a static that lie inside a surface which it makes up with other statics, or with
// other triangles of a mesh. Bullet sees each piece alone, so a body that slides or rolls over the joint of two tiles
// would trip over the edge of the next one. Here a contact whose normal no exposed face or edge has is turned into one
// with the nearest exposed face, or left out where another piece has that contact.
//
// The outcome follows from the body's shape and pose and from the statics near the contact, and from nothing else.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <LinearMath/btTransform.h>

#include "physics/flat_piece.h"
#include "physics/lowest_point.h"

class btCollisionObject;

namespace aurasim::physics {

/// A contact point of a body with a static.
struct StaticContact {
  btVector3 normal;    ///< from the static to the body
  btVector3 on_body;   ///< m
  btScalar gap_m = 0;  ///< negative: overlap

  bool operator==(const StaticContact&) const = default;
  btVector3 on_static() const { return on_body - normal * gap_m; }
};

class InnerEdges {
 public:
  InnerEdges();
  ~InnerEdges();
  InnerEdges(const InnerEdges&) = delete;
  InnerEdges& operator=(const InnerEdges&) = delete;

  /// `start`: pose of the static at the start of the run. A static that moves takes part while it stands there.
  void insert(const btCollisionObject& fixed, const btTransform& start);
  void remove(const btCollisionObject& fixed);

  /// False if corrected() returns what it is given for each contact with this static, because no other piece is beside
  /// it. Several threads may ask this and corrected() while nothing is inserted or removed.
  bool concerns(const btCollisionObject& fixed) const;

  /// The contact that should be used instead of one that Bullet has found; nothing: none. `index`: of the child of a
  /// compound, or of the triangle of a mesh; -1 for other statics.
  std::optional<StaticContact> corrected(const StaticContact& found, const btCollisionObject& fixed, int index,
                                         const PlacedShape& of_static, const PlacedShape& of_body) const;

  /// corrected() uses statics whose bounds are at most so far from the body, m. Others need not be here.
  static constexpr btScalar kReach_m = 2;

 private:
  struct Fixed;
  struct Piece;
  /// Pieces around a point.
  struct Near;

  const Fixed* find(const btCollisionObject& fixed) const;
  void add_piece(Fixed& fixed, const btCollisionShape& shape, const btTransform& pose, int index);
  void add_plane(Fixed& plane);
  void gather(const btVector3& p, btScalar around_m, Near& near) const;
  bool is_exposed(const FlatPiece& piece, const FlatFace& face, const btVector3& p, const Near& near) const;
  bool is_inner(const StaticContact& found, const FlatPiece& own, const btVector3& p, const btVector3& along,
                const Near& near) const;
  std::optional<StaticContact> moved(const StaticContact& found, const FlatPiece& own, const btVector3& p,
                                     const PlacedShape& body, const Near& near) const;

  std::vector<std::unique_ptr<Fixed>> fixed_;  ///< by number of the static; null where it is not in the world
  std::vector<Fixed*> planes_;                 ///< ascending by number
  btDbvt tree_;                                ///< of the pieces of all others, at their starts
};

}  // namespace aurasim::physics
