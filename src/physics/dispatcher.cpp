#include "physics/dispatcher.h"

#include <algorithm>
#include <new>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <LinearMath/btAabbUtil2.h>

#include "physics/corrected_result.h"
#include "physics/inner_edges.h"
#include "physics/soft/threads.h"

namespace aurasim::physics {
namespace {

/// Lies before an algorithm in memory. Bullet does not tell the size of an algorithm that it frees.
struct alignas(BlockPool::kAlignment) AlgorithmHead {
  BlockPool* pool;  ///< null: too large for any
};

bool bounds_overlap(const btBroadphaseProxy& a, const btBroadphaseProxy& b) {
  return TestAabbAgainstAabb2(a.m_aabbMin, a.m_aabbMax, b.m_aabbMin, b.m_aabbMax);
}

bool is_plane(const btCollisionObject& object) {
  return object.getCollisionShape()->getShapeType() == STATIC_PLANE_PROXYTYPE;
}

/// Drops points that Bullet has found and that have slid away. It looks for more corners on a plane only while a
/// manifold has fewer than four points, and it would count these. Points with names are all found anew each time.
void drop_stale_points(btCollisionAlgorithm& algorithm) {
  thread_local btManifoldArray manifolds;  // keeps its memory
  manifolds.resizeNoInitialize(0);
  algorithm.getAllContactManifolds(manifolds);
  for (int i = 0; i < manifolds.size(); ++i) {
    if (manifolds[i]->getNumContacts() == 0 || manifolds[i]->getContactPoint(0).m_partId0 >= 0) continue;
    manifolds[i]->refreshContactPoints(manifolds[i]->getBody0()->getWorldTransform(),
                                       manifolds[i]->getBody1()->getWorldTransform());
  }
}

bool has_inner_edges(const btCollisionObject& object, const InnerEdges& inner_edges) {
  return object.isStaticOrKinematicObject() && inner_edges.concerns(object);
}

void near_callback(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info) {
  static_cast<Dispatcher&>(dispatcher).find_contacts(pair, info);
}

}  // namespace

/// Two compounds are treated as a compound of compounds: Bullet's algorithm for two needs the trees that shapes.cpp
/// leaves out, and hides which manifold belongs to which parts.
Dispatcher::Dispatcher(btCollisionConfiguration& configuration, const InnerEdges& inner_edges)
    : btCollisionDispatcher(&configuration),
      inner_edges_(inner_edges),
      hull_contacts_(
          *configuration.getCollisionAlgorithmCreateFunc(CONVEX_HULL_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE),
          kContactMargin),
      cylinder_contacts_(
          *configuration.getCollisionAlgorithmCreateFunc(CONVEX_HULL_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE),
          kContactMargin) {
  setNearCallback(near_callback);
  registerCollisionCreateFunc(
      COMPOUND_SHAPE_PROXYTYPE, COMPOUND_SHAPE_PROXYTYPE,
      configuration.getCollisionAlgorithmCreateFunc(COMPOUND_SHAPE_PROXYTYPE, SPHERE_SHAPE_PROXYTYPE));
  for (const int other : {CUSTOM_POLYHEDRAL_SHAPE_TYPE, BOX_SHAPE_PROXYTYPE}) {
    registerCollisionCreateFunc(CUSTOM_POLYHEDRAL_SHAPE_TYPE, other, &hull_contacts_);
    registerCollisionCreateFunc(other, CUSTOM_POLYHEDRAL_SHAPE_TYPE, &hull_contacts_);
  }
  for (const int other : {CUSTOM_POLYHEDRAL_SHAPE_TYPE, BOX_SHAPE_PROXYTYPE, STATIC_PLANE_PROXYTYPE,
                          TRIANGLE_SHAPE_PROXYTYPE, CYLINDER_SHAPE_PROXYTYPE}) {
    registerCollisionCreateFunc(CYLINDER_SHAPE_PROXYTYPE, other, &cylinder_contacts_);
    registerCollisionCreateFunc(other, CYLINDER_SHAPE_PROXYTYPE, &cylinder_contacts_);
  }
  const auto use_primitive = [this](int one, int other) {
    registerCollisionCreateFunc(one, other, &primitive_contacts_);
    registerCollisionCreateFunc(other, one, &primitive_contacts_);
  };
  use_primitive(SPHERE_SHAPE_PROXYTYPE, CAPSULE_SHAPE_PROXYTYPE);
  use_primitive(CAPSULE_SHAPE_PROXYTYPE, CAPSULE_SHAPE_PROXYTYPE);
  for (const int round : {SPHERE_SHAPE_PROXYTYPE, CAPSULE_SHAPE_PROXYTYPE}) {
    use_primitive(round, BOX_SHAPE_PROXYTYPE);
    use_primitive(round, STATIC_PLANE_PROXYTYPE);
  }
}

bool Dispatcher::find_contacts(btBroadphasePair& pair, const btDispatcherInfo& info) {
  if (!bounds_overlap(*pair.m_pProxy0, *pair.m_pProxy1)) {
    if (pair.m_algorithm == nullptr) return false;
    pair.m_algorithm->~btCollisionAlgorithm();
    freeCollisionAlgorithm(pair.m_algorithm);
    pair.m_algorithm = nullptr;
    return false;
  }
  const auto& a = *static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
  const auto& b = *static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
  return needsCollision(&a, &b) && find_contacts_of_overlapping(pair, info);
}

bool Dispatcher::find_contacts_of_overlapping(btBroadphasePair& pair, const btDispatcherInfo& info) {
  const auto& a = *static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
  const auto& b = *static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
  const btCollisionObjectWrapper wrap_a(nullptr, a.getCollisionShape(), &a, a.getWorldTransform(), -1, -1);
  const btCollisionObjectWrapper wrap_b(nullptr, b.getCollisionShape(), &b, b.getWorldTransform(), -1, -1);
  if (pair.m_algorithm == nullptr) {
    pair.m_algorithm = findAlgorithm(&wrap_a, &wrap_b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    if (pair.m_algorithm == nullptr) return false;
  } else if (is_plane(a) || is_plane(b)) {
    drop_stale_points(*pair.m_algorithm);
  }
  if (has_inner_edges(a, inner_edges_) || has_inner_edges(b, inner_edges_)) {
    CorrectedResult result(wrap_a, wrap_b, inner_edges_);
    pair.m_algorithm->processCollision(&wrap_a, &wrap_b, info, &result);
    return result.has_left_out();
  }
  btManifoldResult result(&wrap_a, &wrap_b);
  pair.m_algorithm->processCollision(&wrap_a, &wrap_b, info, &result);
  return false;
}

/// Others hold the pools for much less time than it takes to sleep and to be woken.
std::unique_lock<std::mutex> Dispatcher::hold_pools() {
  constexpr int kTries = 200;
  for (int i = 0; i < kTries; ++i) {
    std::unique_lock<std::mutex> lock(pools_mutex_, std::try_to_lock);
    if (lock.owns_lock()) return lock;
    soft::pause();
  }
  return std::unique_lock<std::mutex>(pools_mutex_);
}

btPersistentManifold* Dispatcher::getNewManifold(const btCollisionObject* body0, const btCollisionObject* body1) {
  const auto threshold_of = [](const btCollisionObject& body) {
    return body.getCollisionShape()->getContactBreakingThreshold(gContactBreakingThreshold);
  };
  const btScalar breaking =
      std::min({threshold_of(*body0), threshold_of(*body1), static_cast<btScalar>(kContactMargin)});
  const btScalar processing = std::min(body0->getContactProcessingThreshold(), body1->getContactProcessingThreshold());
  const std::unique_lock<std::mutex> lock = hold_pools();
  auto* const manifold = new (manifolds_.take()) btPersistentManifold(body0, body1, 0, breaking, processing);
  manifold->m_index1a = m_manifoldsPtr.size();
  m_manifoldsPtr.push_back(manifold);
  return manifold;
}

void Dispatcher::releaseManifold(btPersistentManifold* manifold) {
  const std::unique_lock<std::mutex> lock = hold_pools();
  clearManifold(manifold);
  const int place = manifold->m_index1a;
  m_manifoldsPtr.swap(place, m_manifoldsPtr.size() - 1);
  m_manifoldsPtr[place]->m_index1a = place;
  m_manifoldsPtr.pop_back();
  manifold->~btPersistentManifold();
  manifolds_.give_back(manifold);
}

void* Dispatcher::allocateCollisionAlgorithm(int bytes) {
  const std::size_t with_head = sizeof(AlgorithmHead) + static_cast<std::size_t>(bytes);
  const std::unique_lock<std::mutex> lock = hold_pools();
  const auto pool = std::ranges::find_if(algorithms_, [&](const BlockPool& of) { return of.bytes() >= with_head; });
  AlgorithmHead* head = nullptr;
  if (pool == algorithms_.end()) {
    head = new (::operator new(with_head)) AlgorithmHead{nullptr};
  } else {
    head = new (pool->take()) AlgorithmHead{&*pool};
  }
  return head + 1;
}

void Dispatcher::freeCollisionAlgorithm(void* memory) {
  const std::unique_lock<std::mutex> lock = hold_pools();
  AlgorithmHead* const head = static_cast<AlgorithmHead*>(memory) - 1;
  if (head->pool != nullptr) return head->pool->give_back(head);
  ::operator delete(head);
}

}  // namespace aurasim::physics
