#include "physics/contact_cache.h"

#include <algorithm>
#include <cassert>
#include <type_traits>

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "physics/bullet_convert.h"

namespace aurasim::physics {
namespace {

constexpr int kIndexInA = 39;
constexpr int kIndexInB = 40;

/// Goes over a point's fields in the order of the columns. Point is btManifoldPoint or const btManifoldPoint.
template <class Point, class Visit>
void for_each_field(Point& p, Visit&& visit) {
  for (auto* v : {&p.m_localPointA, &p.m_localPointB, &p.m_positionWorldOnB, &p.m_positionWorldOnA, &p.m_normalWorldOnB,
                  &p.m_lateralFrictionDir1, &p.m_lateralFrictionDir2}) {
    for (int axis = 0; axis < 3; ++axis) visit((*v)[axis]);
  }
  visit(p.m_distance1);
  visit(p.m_combinedFriction);
  visit(p.m_combinedRollingFriction);
  visit(p.m_combinedSpinningFriction);
  visit(p.m_combinedRestitution);
  visit(p.m_contactPointFlags);
  visit(p.m_lifeTime);
  visit(p.m_appliedImpulse);
  visit(p.m_prevRHS);
  visit(p.m_appliedImpulseLateral1);
  visit(p.m_appliedImpulseLateral2);
  visit(p.m_contactMotion1);
  visit(p.m_contactMotion2);
  visit(p.m_contactCFM);
  visit(p.m_contactERP);
  visit(p.m_frictionCFM);
  visit(p.m_partId0);
  visit(p.m_partId1);
  visit(p.m_index0);
  visit(p.m_index1);
}

const btCompoundShape* compound_of(const btCollisionObject& object) {
  const btCollisionShape* const shape = object.getCollisionShape();
  return shape->isCompound() ? static_cast<const btCompoundShape*>(shape) : nullptr;
}

const btCollisionObject& object_of(const btBroadphaseProxy& proxy) {
  return *static_cast<const btCollisionObject*>(proxy.m_clientObject);
}

/// Appends the manifolds of an algorithm. `parts` are in the pair's order, those in `result` in the manifold's own.
void append(btCollisionAlgorithm* algorithm, const btCollisionObject& object0, Parts parts,
            std::vector<PartManifold>& result) {
  if (algorithm == nullptr) return;
  btManifoldArray manifolds;
  algorithm->getAllContactManifolds(manifolds);
  for (int i = 0; i < manifolds.size(); ++i) {
    const bool swapped = manifolds[i]->getBody0() != &object0;
    result.push_back({manifolds[i], swapped ? Parts{parts.part1, parts.part0} : parts});
  }
}

}  // namespace

void write_point(const btManifoldPoint& point, double* row) {
  double* column = row;
  for_each_field(point, [&column](auto value) { *column++ = static_cast<double>(value); });
  assert(column == row + core::kContactPointDoubles);
}

btManifoldPoint read_point(const double* row) {
  btManifoldPoint point(btVector3(0, 0, 0), btVector3(0, 0, 0), btVector3(0, 0, 0), 0);
  const double* column = row;
  for_each_field(point, [&](auto& value) { value = static_cast<std::remove_reference_t<decltype(value)>>(*column++); });
  return point;
}

Parts parts_of(const btPersistentManifold& manifold) {
  assert(manifold.getNumContacts() > 0);
  const btManifoldPoint& point = manifold.getContactPoint(0);
  return {compound_of(*manifold.getBody0()) != nullptr ? point.m_index0 : -1,
          compound_of(*manifold.getBody1()) != nullptr ? point.m_index1 : -1};
}

Parts parts_of(const double* row, bool compound0, bool compound1) {
  return {compound0 ? static_cast<int>(row[kIndexInA]) : -1, compound1 ? static_cast<int>(row[kIndexInB]) : -1};
}

btPersistentManifold* restore_points(std::span<const PartManifold> made, const btCollisionObject& body0, Parts parts,
                                     std::span<const double> rows) {
  const auto wanted = std::ranges::find_if(made, [&](const PartManifold& candidate) {
    return candidate.manifold->getBody0() == &body0 && candidate.parts == parts;
  });
  if (wanted == made.end()) return nullptr;
  for (std::size_t at = 0; at < rows.size(); at += core::kContactPointDoubles) {
    wanted->manifold->addManifoldPoint(read_point(&rows[at]));
  }
  return wanted->manifold;
}

void collect_manifolds(const btBroadphasePair& pair, std::vector<PartManifold>& result) {
  result.clear();
  if (pair.m_algorithm == nullptr) return;
  const btCollisionObject& object0 = object_of(*pair.m_pProxy0);
  const btCompoundShape* const compound0 = compound_of(object0);
  const btCompoundShape* const compound1 = compound_of(object_of(*pair.m_pProxy1));
  if (compound0 == nullptr && compound1 == nullptr) {
    append(pair.m_algorithm, object0, {}, result);
    return;
  }

  const auto child_of = [](btCollisionAlgorithm* algorithm, int child) {
    return static_cast<btCompoundCollisionAlgorithm*>(algorithm)->getChildAlgorithm(child);
  };
  const btCompoundShape* const outer = compound0 != nullptr ? compound0 : compound1;
  for (int i = 0; i < outer->getNumChildShapes(); ++i) {
    btCollisionAlgorithm* const of_child = child_of(pair.m_algorithm, i);
    if (of_child == nullptr) continue;
    if (compound0 == nullptr) {
      append(of_child, object0, {-1, i}, result);
    } else if (compound1 == nullptr) {
      append(of_child, object0, {i, -1}, result);
    } else {
      for (int j = 0; j < compound1->getNumChildShapes(); ++j) append(child_of(of_child, j), object0, {i, j}, result);
    }
  }
}

}  // namespace aurasim::physics
