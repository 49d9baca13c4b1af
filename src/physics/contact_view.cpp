#include "physics/contact_view.h"

#include <algorithm>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "physics/contact_cache.h"
#include "physics/packed_contacts.h"
#include "physics/prefetch.h"

namespace aurasim::physics {

ContactView::ContactView(const btPersistentManifold& manifold)
    : body0_(manifold.getBody0()),
      body1_(manifold.getBody1()),
      count_(static_cast<std::size_t>(manifold.getNumContacts())),
      manifold_(&manifold) {}

Parts ContactView::parts() const {
  if (manifold_ != nullptr) return parts_of(*manifold_);
  return parts_of(PackedPoints(points_, *body0_, *body1_).next().data(), body0_->getCollisionShape()->isCompound(),
                  body1_->getCollisionShape()->isCompound());
}

void ContactView::write(double* rows) const {
  PackedPoints packed(points_, *body0_, *body1_);
  for (std::size_t i = 0; i < count_; ++i, rows += core::kContactPointDoubles) {
    if (manifold_ != nullptr) {
      write_point(manifold_->getContactPoint(static_cast<int>(i)), rows);
    } else {
      std::ranges::copy(packed.next(), rows);
    }
  }
}

void ContactView::prefetch() const {
  if (manifold_ != nullptr) prefetch_points(*manifold_);
}

}  // namespace aurasim::physics
