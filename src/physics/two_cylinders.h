// Contact points of two cylinders that stand on each other or lie along or across each other, in closed form.
#pragma once

#include <optional>

#include "physics/cylinder_faces.h"
#include "physics/cylinder_points.h"

namespace aurasim::physics {

/// The contact of cylinder `a` with cylinder `b`, in the frame of both. The normal of HullPoints points from A to B.
/// Nothing if they touch with a rim, so that neither a cap nor two barrels give the normal.
std::optional<HullPoints> cylinder_contact(const Cylinder& a, const Cylinder& b, double margin_m);

/// The contact along a normal that was searched, with all points of the caps if it is nearly that of a cap.
HullPoints searched_contact(const Cylinder& a, const Cylinder& b, const SearchedPoint& found, double margin_m);

}  // namespace aurasim::physics
