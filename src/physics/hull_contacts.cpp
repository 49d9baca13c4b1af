#include "physics/hull_contacts.h"

#include <array>
#include <new>
#include <optional>
#include <span>
#include <tuple>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include "physics/hull_axes.h"
#include "physics/hull_clip.h"
#include "physics/hull_faces.h"
#include "physics/whole_manifold.h"

namespace aurasim::physics {
namespace {

const HullFaces& faces_of(const btCollisionObjectWrapper& object) {
  return *hull_faces_of(*object.getCollisionShape());
}

class HullContacts final : public WholeContacts {
 public:
  using WholeContacts::WholeContacts;

  void processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, const btDispatcherInfo&,
                        btManifoldResult* result) override {
    const btTransform X_AB = a->getWorldTransform().inverseTimes(b->getWorldTransform());
    const std::optional<HullGap> closest = closest_axis(faces_of(*a), faces_of(*b), X_AB, manifold().margin_m(), last_);
    if (give_manifold(*a, *b, closest.has_value(), *result)) {
      put_points(*a, *b, X_AB, *closest, dynamic_cast<CorrectedResult*>(result));
    }
  }

 private:
  void put_points(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, const btTransform& X_AB,
                  const HullGap& closest, CorrectedResult* inner_edges) {
    WholeManifold::FeatureSpace before;
    const HullPoints found =
        contact_points(faces_of(a), faces_of(b), X_AB, closest, manifold().margin_m(), manifold().features(before));
    std::array<NamedPoint, std::tuple_size_v<decltype(found.points)>> points;
    const btTransform& X_A = a.getWorldTransform();
    const btVector3 normal = -(X_A.getBasis() * found.normal);
    const auto count = static_cast<std::size_t>(found.count);
    for (std::size_t i = 0; i < count; ++i) {
      const HullPoint& point = found.points[i];
      points[i] = {{normal, X_A(point.on_b), point.gap}, point.features};
    }
    manifold().put(a, b, std::span(points).first(count), inner_edges);
  }

  HullAxis last_;  ///< of this world only: it changes no bit
};

// Bullet's pool has room for its own algorithms.
static_assert(sizeof(HullContacts) <= sizeof(btConvexConvexAlgorithm));

}  // namespace

btCollisionAlgorithm* HullContactsMaker::CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                                  const btCollisionObjectWrapper* a,
                                                                  const btCollisionObjectWrapper* b) {
  if (hull_faces_of(*a->getCollisionShape()) == nullptr || hull_faces_of(*b->getCollisionShape()) == nullptr) {
    return others_.CreateCollisionAlgorithm(info, a, b);
  }
  void* const memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(HullContacts));
  return new (memory) HullContacts(info, *this, *a, *b);
}

}  // namespace aurasim::physics
