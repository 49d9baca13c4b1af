// Finds the normal of a cylinder's contact with a polyhedron, a plane or a triangle, and the points along it.
#pragma once

#include <optional>
#include <span>

#include "physics/cylinder_points.h"
#include "physics/hull_faces.h"
#include "physics/plane_points.h"

namespace aurasim::physics {

/// A contact as Bullet's search finds it, in the frame of the other body.
struct SearchedPoint {
  btVector3 normal;  ///< of length 1, from the other body to the cylinder
  btVector3 on_other;
  btScalar gap;
};

/// The contact of a point alone.
HullPoints single_point(const SearchedPoint& found);

/// A search for the nearest points of the two bodies.
class NearestPoints {
 public:
  /// Nothing if they are too far apart for a contact.
  virtual std::optional<SearchedPoint> find() const = 0;

 protected:
  ~NearestPoints() = default;
};

/// The contact of a cylinder (A) with another body (B), in the frame of B. The normal of HullPoints points from A to B.
/// `before`: features of the last points, which are kept rather than others that are hardly better. `search` is asked
/// where neither a face of B nor a cap gives the normal.
HullPoints cylinder_contact(const Cylinder& cylinder, const HullFaces& hull, double margin_m,
                            std::span<const ContactFeatures> before, const NearestPoints& search);
HullPoints cylinder_contact(const Cylinder& cylinder, const HalfSpace& plane, double margin_m);
/// A triangle has no inside: the cylinder's centre is on its upper side.
HullPoints cylinder_contact(const Cylinder& cylinder, const btVector3 (&corners)[3], double margin_m,
                            const NearestPoints& search);

}  // namespace aurasim::physics
