// A contact of two objects with at least one point, wherever it is kept: in a manifold of Bullet's, or packed.
#pragma once

#include <cstddef>
#include <cstdint>

#include "physics/parts.h"

class btCollisionObject;
class btPersistentManifold;

namespace aurasim::physics {

/// Valid until the contact changes.
class ContactView {
 public:
  explicit ContactView(const btPersistentManifold& manifold);
  /// `points`: as in packed_contacts.h.
  ContactView(const btCollisionObject& body0, const btCollisionObject& body1, std::size_t count,
              const std::uint8_t* points)
      : body0_(&body0), body1_(&body1), count_(count), points_(points) {}

  const btCollisionObject& body0() const { return *body0_; }
  const btCollisionObject& body1() const { return *body1_; }
  std::size_t count() const { return count_; }
  Parts parts() const;
  /// Writes count() rows.
  void write(double* rows) const;
  /// Asks for what write() is about to read.
  void prefetch() const;

 private:
  const btCollisionObject *body0_, *body1_;
  std::size_t count_;
  const btPersistentManifold* manifold_ = nullptr;
  const std::uint8_t* points_ = nullptr;  ///< if there is no manifold
};

}  // namespace aurasim::physics
