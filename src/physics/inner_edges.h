// Contacts with inner edges: edges of a static that lie inside a surface which it makes up with other statics, or with
// other triangles of a mesh. Bullet sees each piece alone, so a body that slides or rolls over the joint of two tiles
// would trip over the edge of the next one. Here a contact whose normal no exposed face or edge has is turned into one
// with the nearest exposed face, or left out where another piece has that contact.
//
// The outcome follows from the body's shape and pose and from the statics near the contact, and from nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <LinearMath/btTransform.h>

#include "core/box_tree.h"
#include "physics/flat_piece.h"
#include "physics/lowest_point.h"

class btCollisionObject;

namespace aurasim::physics {

/// A contact point of a body with a static.
struct StaticContact {
  btVector3 normal;    ///< from the static to the body
  btVector3 on_body;   ///< m
  btScalar gap_m = 0;  ///< negative: overlap

  btVector3 on_static() const { return on_body - normal * gap_m; }
};

class InnerEdges {
 public:
  /// `start`: pose of the static at the start of the run. A static that moves takes part while it stands there.
  void insert(const btCollisionObject& fixed, const btTransform& start);
  void remove(const btCollisionObject& fixed);
  /// Call after changes, before the contacts of the next state are looked for. Then several threads may ask.
  void settle();

  /// False if contacts with this static are as Bullet finds them, because no other piece is beside it.
  bool concerns(const btCollisionObject& fixed) const;

  /// The contact that should be used instead of one that Bullet has found; nothing: none. `index`: of the child of a
  /// compound, or of the triangle of a mesh; -1 for other statics.
  std::optional<StaticContact> corrected(const StaticContact& found, const btCollisionObject& fixed, int index,
                                         const PlacedShape& of_static, const PlacedShape& of_body) const;

 private:
  struct Fixed {
    const btCollisionObject* object = nullptr;
    btTransform start = btTransform::getIdentity();
    bool is_mesh = false;
    bool has_neighbours = false;
    std::vector<FlatPiece> pieces;             ///< its own, or those of its children
    std::vector<std::vector<FlatFace>> faces;  ///< by piece
  };
  /// A piece in the tree, or a mesh.
  struct Entry {
    Fixed* fixed;
    FlatPiece* piece;  ///< null: the mesh
  };
  /// Pieces around a point.
  struct Near;

  const Fixed* find(const btCollisionObject& fixed) const;
  bool has_neighbours(const Fixed& fixed) const;
  void note_covers(std::uint32_t entry);
  bool meets_plane(const btVector3& low, const btVector3& high) const;
  void gather(const btVector3& p, btScalar around_m, Near& near) const;
  bool is_exposed(const FlatPiece& piece, const FlatFace& face, const btVector3& p, const Near& near) const;
  bool is_inner(const StaticContact& found, const FlatPiece& own, const btVector3& p, const btVector3& along,
                const Near& near) const;
  std::optional<StaticContact> moved(const StaticContact& found, const FlatPiece& own, const btVector3& p,
                                     const PlacedShape& body, const Near& near) const;

  std::vector<std::unique_ptr<Fixed>> fixed_;  ///< by number of the static; null where it is not in the world
  std::vector<Entry> entries_;
  std::vector<const FlatPiece*> planes_;
  std::optional<core::BoxTree> tree_;        ///< of entries_
  std::vector<core::BoxTree::Box> changed_;  ///< where statics came or went since settle()
};

}  // namespace aurasim::physics
