// The points of a manifold of bodies that sleep, in few bytes. The bits are those of rows (contact_cache.h).
//
// Much in a row follows from the bodies or is as in the row before: points in the world frame, normal, materials. Only
// columns that differ from what is expected are kept, and of these only the octets that differ. Expectations look at
// the pose of the two bodies, which must not change in between; the pose of a static does not count.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/body_state.h"

class btCollisionObject;
class btPersistentManifold;

namespace aurasim::physics {

using PackedBytes = std::vector<std::uint8_t>;
using ContactRow = std::array<double, core::kContactPointDoubles>;

/// Appends the points of a manifold.
void pack_points(const btPersistentManifold& manifold, PackedBytes& to);

/// Reads the packed points of a manifold one after another.
class PackedPoints {
 public:
  /// `body0`, `body1`: bodies of the manifold. They have to outlive the reader, as `bytes` have to.
  PackedPoints(const std::uint8_t* bytes, const btCollisionObject& body0, const btCollisionObject& body1)
      : bytes_(bytes), body0_(body0), body1_(body1) {}

  const ContactRow& next();
  const std::uint8_t* end() const { return bytes_; }

 private:
  const std::uint8_t* bytes_;
  const btCollisionObject &body0_, &body1_;
  ContactRow row_{};
};

}  // namespace aurasim::physics
