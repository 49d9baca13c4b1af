#include "physics/made_manifolds.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "physics/dispatcher.h"

namespace aurasim::physics {
namespace {

/// Keeps a body awake during its own lifetime, because Bullet skips pairs of sleepers.
class Awake {
 public:
  explicit Awake(btCollisionObject& body) : body_(body), state_(body.getActivationState()) {
    body_.forceActivationState(ACTIVE_TAG);
  }
  ~Awake() { body_.forceActivationState(state_); }
  Awake(const Awake&) = delete;
  Awake& operator=(const Awake&) = delete;

 private:
  btCollisionObject& body_;
  int state_;
};

/// Gives a new pair the algorithm that computes its contacts. For boxes and spheres the algorithm has a manifold from
/// the beginning.
void make_algorithm(btBroadphasePair& pair, btDispatcher& dispatcher) {
  auto& object0 = *static_cast<btCollisionObject*>(pair.m_pProxy0->m_clientObject);
  auto& object1 = *static_cast<btCollisionObject*>(pair.m_pProxy1->m_clientObject);
  if (!dispatcher.needsCollision(&object0, &object1)) return;
  const auto wrap = [](const btCollisionObject& object) {
    return btCollisionObjectWrapper(nullptr, object.getCollisionShape(), &object, object.getWorldTransform(), -1, -1);
  };
  const btCollisionObjectWrapper wrap0 = wrap(object0);
  const btCollisionObjectWrapper wrap1 = wrap(object1);
  pair.m_algorithm = dispatcher.findAlgorithm(&wrap0, &wrap1, nullptr, BT_CONTACT_POINT_ALGORITHMS);
}

}  // namespace

void make_manifolds(btBroadphasePair& pair, Dispatcher& dispatcher, const btDispatcherInfo& info,
                    std::vector<PartManifold>& result) {
  auto& object0 = *static_cast<btCollisionObject*>(pair.m_pProxy0->m_clientObject);
  auto& object1 = *static_cast<btCollisionObject*>(pair.m_pProxy1->m_clientObject);
  const Awake awake(object0.isStaticObject() ? object1 : object0);
  if (pair.m_algorithm == nullptr) make_algorithm(pair, dispatcher);
  collect_manifolds(pair, result);
  // Only compounds and hulls need a collision test, because not all of their parts have manifolds. For other pairs it
  // would be most of the work of a hand-off.
  if (result.empty() || result.front().parts != Parts{}) {
    dispatcher.make_all_manifolds(true);
    btCollisionDispatcher::defaultNearCallback(pair, dispatcher, info);
    dispatcher.make_all_manifolds(false);
    collect_manifolds(pair, result);
  }
  for (const PartManifold& made : result) made.manifold->clearManifold();
}

}  // namespace aurasim::physics
