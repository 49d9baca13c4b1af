#include "physics/soft/world.h"

#include <span>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/first_contacts.h"
#include "physics/prefetch.h"
#include "physics/settings.h"
#include "physics/soft/islands.h"
#include "physics/soft/kept_contacts.h"
#include "physics/soft/step.h"

namespace aurasim::physics {
namespace {

template <class T>
std::span<T* const> span_of(btAlignedObjectArray<T*>& array) {
  return {array.size() > 0 ? &array[0] : nullptr, static_cast<std::size_t>(array.size())};
}

class SoftWorld final : public btDiscreteDynamicsWorld {
 public:
  SoftWorld(const WorldParts& parts, const Settings& settings)
      : btDiscreteDynamicsWorld(&parts.dispatcher, &parts.broadphase, &parts.solver, &parts.configuration),
        first_contacts_(parts.first_contacts),
        step_(settings.step_s, settings.substeps) {}

  int stepSimulation(btScalar step_s, int, btScalar) override {
    damp(step_s);
    bound();
    m_broadphasePairCache->calculateOverlappingPairs(m_dispatcher1);
    kept_.look(*getPairCache(), static_cast<btCollisionDispatcher&>(*m_dispatcher1), getDispatchInfo());
    first_contacts_.look(*m_dispatcher1, *getPairCache());
    islands_.find(span_of(m_nonStaticRigidBodies), manifolds_of(*m_dispatcher1), span_of(m_constraints));
    step_.solve(islands_.awake(), islands_.manifolds(), islands_.joints(), getGravity());
    updateActivationState(step_s);
    return 1;
  }

 private:
  void damp(btScalar step_s) {
    for (btRigidBody* body : span_of(m_nonStaticRigidBodies)) {
      const bool slows = body->getLinearDamping() > 0 || body->getAngularDamping() > 0;
      if (slows && body->isActive()) body->applyDamping(step_s);
    }
  }

  /// Of what may have moved since the last time.
  void bound() {
    const btVector3 margin(gContactBreakingThreshold, gContactBreakingThreshold, gContactBreakingThreshold);
    for (btRigidBody* body : span_of(m_nonStaticRigidBodies)) {
      if (!body->isActive()) continue;
      btVector3 low, high;
      body->getAabb(low, high);
      m_broadphasePairCache->setAabb(body->getBroadphaseHandle(), low - margin, high + margin, m_dispatcher1);
    }
  }

  FirstContacts& first_contacts_;
  KeptContacts kept_;
  SoftIslands islands_;
  SoftStep step_;
};

}  // namespace

std::unique_ptr<btDiscreteDynamicsWorld> make_soft_world(const WorldParts& parts, const Settings& settings) {
  return std::make_unique<SoftWorld>(parts, settings);
}

}  // namespace aurasim::physics
