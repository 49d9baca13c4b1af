#include "physics/soft/seam_parcels.h"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "physics/moving_body.h"
#include "physics/soft/convert.h"
#include "physics/soft/patches.h"

namespace aurasim::physics {

using soft::Mover;
using soft::Real;

void write_row(const Mover& mover, ParcelWriter& parcel) {
  parcel.put_some(mover.v, 3), parcel.put_some(mover.w, 3);
  parcel.put_some(mover.dp, 3), parcel.put_some(mover.dq, 4);
}

void read_row(Mover& mover, ParcelReader& parcel) {
  parcel.take_some(mover.v, 3), parcel.take_some(mover.w, 3);
  parcel.take_some(mover.dp, 3), parcel.take_some(mover.dq, 4);
}

void write_patch(const SoftPatch& patch, ParcelWriter& parcel) {
  parcel.put_some(patch.normal, 3), parcel.put_some(patch.belt, 3);
  for (const Real value :
       {patch.friction, patch.restitution, patch.spinning_m, patch.rolling_m, patch.rub_1, patch.rub_2, patch.twist}) {
    parcel.put(value);
  }
  parcel.put(static_cast<std::uint8_t>(patch.count));
  for (int i = 0; i < patch.count; ++i) {
    const SoftPatch::Point& point = patch.points[static_cast<std::size_t>(i)];
    parcel.put_some(point.r_a, 3), parcel.put_some(point.r_b, 3);
    parcel.put(point.gap), parcel.put(point.impulse);
  }
}

SoftPatch read_patch(ParcelReader& parcel) {
  SoftPatch patch;
  patch.is_foreign = true;
  parcel.take_some(patch.normal, 3), parcel.take_some(patch.belt, 3);
  for (Real* const value : {&patch.friction, &patch.restitution, &patch.spinning_m, &patch.rolling_m, &patch.rub_1,
                            &patch.rub_2, &patch.twist}) {
    *value = parcel.take<Real>();
  }
  const auto count = parcel.take<std::uint8_t>();
  if (count == 0 || count > soft::kMostPoints) throw BadParcel("a contact of another region has no points");
  patch.count = static_cast<std::int8_t>(count);
  for (int i = 0; i < count; ++i) {
    SoftPatch::Point& point = patch.points[static_cast<std::size_t>(i)];
    parcel.take_some(point.r_a, 3), parcel.take_some(point.r_b, 3);
    point.gap = parcel.take<Real>(), point.impulse = parcel.take<Real>();
  }
  return patch;
}

void write_body(const btRigidBody& body, bool moves, std::uint8_t elsewhere, ParcelWriter& parcel) {
  parcel.put(core::value_of(place_of(body).id));
  parcel.put(static_cast<std::uint8_t>(moves));
  parcel.put(elsewhere);
  const SoftInertia inertia = inertia_of(body);
  parcel.put(inertia.inv_mass);
  parcel.put_some(inertia.inv_inertia, 6);
  Real v[3], w[3];
  soft::from_bullet(body.getLinearVelocity(), v), soft::from_bullet(body.getAngularVelocity(), w);
  parcel.put_some(v, 3), parcel.put_some(w, 3);
}

void write_impulses(const SoftTouch& touch, ParcelWriter& parcel) {
  const int count = touch.manifold != nullptr ? touch.manifold->getNumContacts() : 0;
  parcel.put(static_cast<std::uint8_t>(count));
  for (int i = 0; i < count; ++i) {
    const btManifoldPoint& point = touch.manifold->getContactPoint(i);
    parcel.put(point.m_appliedImpulse), parcel.put(point.m_appliedImpulseLateral1);
    parcel.put(point.m_appliedImpulseLateral2), parcel.put(point.m_prevRHS);
  }
}

void read_impulses(ParcelReader& parcel, const SoftTouch& touch) {
  const int count = touch.manifold != nullptr ? touch.manifold->getNumContacts() : 0;
  if (parcel.take<std::uint8_t>() != count) throw BadParcel("another region has other points of a common contact");
  for (int i = 0; i < count; ++i) {
    btManifoldPoint& point = touch.manifold->getContactPoint(i);
    point.m_appliedImpulse = parcel.take<btScalar>();
    point.m_appliedImpulseLateral1 = parcel.take<btScalar>();
    point.m_appliedImpulseLateral2 = parcel.take<btScalar>();
    point.m_prevRHS = parcel.take<btScalar>();
  }
}

}  // namespace aurasim::physics
