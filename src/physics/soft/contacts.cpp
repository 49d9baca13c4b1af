#include "physics/soft/contacts.h"

#include <algorithm>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btAabbUtil2.h>

#include "core/progress.h"
#include "physics/contact_pairs.h"
#include "physics/dispatcher.h"
#include "physics/first_contacts.h"
#include "physics/moving_static.h"
#include "physics/part_surfaces.h"
#include "physics/prefetch.h"
#include "physics/soft/ahead.h"
#include "physics/soft/convert.h"
#include "physics/soft/islands.h"
#include "physics/soft/kept_contacts.h"
#include "physics/soft/pair_note.h"

namespace aurasim::physics {
namespace {

using soft::Real;

/// Normals whose angle has a larger cosine count as one.
constexpr btScalar kSameNormal = btScalar(0.999);
/// Bodies that approach by less in a step (m) get no contact ahead of time; they are found when they touch.
constexpr btScalar kLongWay_m = btScalar(0.005);
/// Contacts ahead of time are computed at a pose where the bodies overlap by this, m.
constexpr btScalar kOverlap_m = btScalar(0.002);

/// A thread takes so many pairs at once.
constexpr std::size_t kPairsAtOnce = 512;
/// Bounds are prefetched so many pairs ahead.
constexpr int kBoundsDistance = 24;

const btCollisionObject& body_of(const btBroadphaseProxy& proxy) {
  return *static_cast<const btCollisionObject*>(proxy.m_clientObject);
}

/// True if the body is clear of the plane. The plane's own bounds are infinite, so a test of bounds cannot decide it.
bool is_above(const btBroadphaseProxy& body, const btCollisionObject& plane) {
  const auto& shape = static_cast<const btStaticPlaneShape&>(*plane.getCollisionShape());
  const btVector3 normal = plane.getWorldTransform().getBasis() * shape.getPlaneNormal();
  const btVector3 on_plane = plane.getWorldTransform()(shape.getPlaneNormal() * shape.getPlaneConstant());
  const btVector3 centre = (body.m_aabbMin + body.m_aabbMax) / 2, half = (body.m_aabbMax - body.m_aabbMin) / 2;
  return normal.dot(centre - on_plane) > normal.absolute().dot(half);
}

/// Only planes have bounds that large. Other proxies are not followed to their bodies, which would miss the cache.
bool is_plane(const btBroadphaseProxy& proxy) {
  constexpr btScalar kEndless_m = btScalar(1e12);
  return proxy.m_aabbMax.x() > kEndless_m &&
         body_of(proxy).getCollisionShape()->getShapeType() == STATIC_PLANE_PROXYTYPE;
}

bool boxes_overlap(const btBroadphasePair& pair) {
  const btBroadphaseProxy &a = *pair.m_pProxy0, &b = *pair.m_pProxy1;
  return TestAabbAgainstAabb2(a.m_aabbMin, a.m_aabbMax, b.m_aabbMin, b.m_aabbMax);
}

bool bounds_overlap(const btBroadphasePair& pair) {
  const btBroadphaseProxy &a = *pair.m_pProxy0, &b = *pair.m_pProxy1;
  if (!boxes_overlap(pair)) return false;
  if (is_plane(a)) return !is_above(b, body_of(a));
  return !is_plane(b) || !is_above(a, body_of(b));
}

SoftTouch touch_of(btPersistentManifold& manifold) {
  const btCollisionObject &a = *manifold.getBody0(), &b = *manifold.getBody1();
  SoftTouch touch;
  touch.manifold = &manifold, touch.parts = parts_of(manifold);
  touch.a = a.getUserIndex(), touch.b = b.getUserIndex(), touch.slot_a = slot_of(a), touch.slot_b = slot_of(b);
  touch.acts = a.hasContactResponse() && b.hasContactResponse();
  return touch;
}

void set_belt(SoftPatch& patch, const btCollisionObject& a, const btCollisionObject& b) {
  if (is_moving_static(a) || is_moving_static(b)) soft::from_bullet(belt_of(b) - belt_of(a), patch.belt);
}

/// The manifolds of a pair. Valid until the next call.
btManifoldArray& manifolds_of(const btBroadphasePair& pair, btManifoldArray& space) {
  space.resizeNoInitialize(0);
  if (pair.m_algorithm != nullptr) pair.m_algorithm->getAllContactManifolds(space);
  return space;
}

/// Has the pair a contact point?
bool touch(const btBroadphasePair& pair, btManifoldArray& space) {
  const btManifoldArray& manifolds = manifolds_of(pair, space);
  for (int i = 0; i < manifolds.size(); ++i) {
    if (manifolds[i]->getNumContacts() > 0) return true;
  }
  return false;
}

}  // namespace

btVector3 SoftContacts::way(const btCollisionObject& object, const btVector3& gravity) const {
  if (is_moving_static(object)) return step_s_ * btRigidBody::upcast(&object)->getLinearVelocity();
  if (object.isStaticObject() || !object.isActive()) return {0, 0, 0};
  const btRigidBody& body = *btRigidBody::upcast(&object);
  btVector3 pull = gravity;
  if (!body.getTotalForce().isZero()) pull += body.getInvMass() * body.getTotalForce();
  return step_s_ * (body.getLinearVelocity() + pull * (step_s_ / 2));
}

void SoftContacts::look(btOverlappingPairCache& pairs, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info,
                        const btVector3& gravity) {
  gravity_ = gravity;
  for (List& list : lists_) {
    list.touches.clear(), list.touches_of_sleepers.clear(), list.patches.clear(), list.will_meet.clear();
    list.came.clear(), list.parted.clear();
  }
  const int count = islands_.are_at_rest() ? 0 : pairs.getNumOverlappingPairs();
  pieces_.begin(static_cast<std::size_t>(count), team_.employed(), kPairsAtOnce);
  team_.side_by_side([&](const soft::Worker& worker) {
    List& list = lists_[static_cast<std::size_t>(worker.number)];
    pieces_.work_off(worker, [&](std::size_t first, std::size_t last) {
      look(list, pairs, static_cast<int>(first), static_cast<int>(last), dispatcher, info);
    });
    worker.wait();
    gather(worker);
  });
  touches_of_sleepers_.clear();
  parted_.clear();
  ahead_.clear();
  came_.clear();
  for (const List& list : lists_) {
    touches_of_sleepers_.insert(touches_of_sleepers_.end(), list.touches_of_sleepers.begin(),
                                list.touches_of_sleepers.end());
    came_.insert(came_.end(), list.came.begin(), list.came.end());
    parted_.insert(parted_.end(), list.parted.begin(), list.parted.end());
  }
  const SleepingPairs& sleeping = static_cast<const ContactPairs&>(pairs).sleeping();
  for (const std::uint32_t slot : islands_.forgotten()) {
    if (!islands_.sleeps(slot)) continue;
    sleeping.for_each_touch(slot, [&](std::uint32_t other) {
      if (other < slot && islands_.is_forgotten(other)) return;  // it comes from there
      touches_of_sleepers_.push_back({slot, other});
    });
  }
  for (const List& list : lists_) {
    for (const WillMeet& two : list.will_meet) {
      core::Progress::mark();
      meet(two, dispatcher, info);
    }
  }
}

/// Gathers the touches of all threads. Each copies its own.
void SoftContacts::gather(const soft::Worker& worker) {
  std::size_t before = 0, all = 0;
  for (std::size_t i = 0; i < lists_.size(); ++i) {
    if (static_cast<int>(i) < worker.number) before += lists_[i].touches.size();
    all += lists_[i].touches.size();
  }
  if (worker.is_first()) touches_.resize(all);
  worker.wait();
  for (const SoftTouch& touch : lists_[static_cast<std::size_t>(worker.number)].touches) {
    touches_[before] = touch;
    touches_[before++].list = static_cast<std::uint32_t>(worker.number);
  }
}

/// Looks at pairs [first, last). First finds those about which something has to be done, which needs no memory but the
/// list of pairs and the bounds. So what is requested ahead is what comes next.
void SoftContacts::look(List& list, btOverlappingPairCache& pairs, int first, int last,
                        btCollisionDispatcher& dispatcher, const btDispatcherInfo& info) {
  btBroadphasePairArray& all = pairs.getOverlappingPairArray();
  list.wanted.clear();
  for (int i = first; i < last; ++i) {
    if (i + kBoundsDistance < last) {
      const PairNote later = noted(all[i + kBoundsDistance]);
      bounds_.prefetch(later.a), bounds_.prefetch(later.b());
    }
    const PairNote note = note_of(all[i]);
    if (!note.may_touch() || (both_sleep(note) && !is_forgotten(note))) continue;
    if (all[i].m_algorithm == nullptr && bounds_.are_apart(note.a, note.b())) continue;
    list.wanted.push_back(&all[i]);
  }
  const std::vector<btBroadphasePair*>& wanted = list.wanted;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    core::Progress::mark_now_and_then(i);
    if (i + kPrefetchDistance < wanted.size()) prefetch_pair(*wanted[i + kPrefetchDistance]);
    if (i + kPrefetchDistance / 2 < wanted.size() && boxes_overlap(*wanted[i + kPrefetchDistance / 2])) {
      prefetch_parts(*wanted[i + kPrefetchDistance / 2], list.manifolds);
    }
    if (i + kPrefetchDistance / 4 < wanted.size() && boxes_overlap(*wanted[i + kPrefetchDistance / 4])) {
      const btManifoldArray& manifolds = manifolds_of(*wanted[i + kPrefetchDistance / 4], list.manifolds);
      for (int k = 0; k < manifolds.size(); ++k) prefetch_points(*manifolds[k]);
    }
    look(list, pairs, *wanted[i], dispatcher, info);
  }
}

bool SoftContacts::both_sleep(const PairNote& of) const { return islands_.sleeps(of.a) && islands_.sleeps(of.b()); }
bool SoftContacts::is_forgotten(const PairNote& of) const {
  return islands_.is_forgotten(of.a) || islands_.is_forgotten(of.b());
}

/// Looks at a pair about which something has to be done.
void SoftContacts::look(List& list, btOverlappingPairCache& pairs, btBroadphasePair& pair,
                        btCollisionDispatcher& dispatcher, const btDispatcherInfo& info) {
  const PairNote note = noted(pair);
  if (both_sleep(note)) {  // touches of sleepers are unchanged
    if (touch(pair, list.manifolds)) list.touches_of_sleepers.push_back({note.a, note.b()});
    return;
  }
  if (islands_.slept(note.a) && islands_.slept(note.b())) know_touches(list, pair);
  const std::uint32_t sleeper = islands_.sleeps(note.a) ? note.a : islands_.sleeps(note.b()) ? note.b() : 0;
  const bool touched = sleeper != 0 && touch(pair, list.manifolds);
  if (bounds_overlap(pair)) {
    look(list, pair, dispatcher, info);
  } else {
    pairs.cleanOverlappingPair(pair, &dispatcher);
  }
  if (touched && !touch(pair, list.manifolds)) list.parted.push_back(sleeper);
}

void SoftContacts::add_woken(btOverlappingPairCache& pairs) {
  add_touches_of_sleepers(pairs,
                          [this](const PairNote& of) { return islands_.is_woken(of.a) || islands_.is_woken(of.b()); });
}

void SoftContacts::add_woken_guests(btOverlappingPairCache& pairs) {
  const auto is_woken_guest = [this](std::uint32_t slot) { return islands_.is_woken(slot) && islands_.is_guest(slot); };
  add_touches_of_sleepers(pairs, [this, is_woken_guest](const PairNote& of) {
    return (is_woken_guest(of.a) && !islands_.is_woken(of.b())) || (is_woken_guest(of.b()) && !islands_.is_woken(of.a));
  });
}

/// Adds the touches of pairs that slept at the start of the step, where wanted(note) is true.
template <class Wanted>
void SoftContacts::add_touches_of_sleepers(btOverlappingPairCache& pairs, Wanted&& wanted) {
  btBroadphasePairArray& all = pairs.getOverlappingPairArray();
  List& list = lists_[0];
  const std::size_t before = list.touches.size();
  for (int i = 0; i < all.size(); ++i) {
    const PairNote note = note_of(all[i]);
    if (islands_.sleeps(note.a) && islands_.sleeps(note.b()) && wanted(note)) collect(list, all[i]);
  }
  touches_.insert(touches_.end(), list.touches.begin() + static_cast<std::ptrdiff_t>(before), list.touches.end());
}

void SoftContacts::look(List& list, btBroadphasePair& pair, btCollisionDispatcher& dispatcher,
                        const btDispatcherInfo& info) {
  const btCollisionObject &a = body_of(*pair.m_pProxy0), &b = body_of(*pair.m_pProxy1);
  const bool whole = !a.getCollisionShape()->isCompound() && !b.getCollisionShape()->isCompound();
  const auto only = [&]() -> btPersistentManifold* {
    const btManifoldArray& manifolds = manifolds_of(pair, list.manifolds);
    return whole && manifolds.size() == 1 && manifolds[0]->getNumContacts() > 0 ? manifolds[0] : nullptr;
  };
  btPersistentManifold* const before = only();
  if (before == nullptr || !keep_contacts(*before)) {
    static_cast<Dispatcher&>(dispatcher).find_contacts_of_overlapping(pair, info);
    if (btPersistentManifold* const told = only()) note_contacts(*told);
  }
  const std::size_t touched = list.touches.size();
  collect(list, pair);
  for (std::size_t i = touched; i < list.touches.size(); ++i) {
    if (first_contacts_.note(*list.touches[i].manifold)) list.came.push_back(list.touches[i].manifold);
  }
  if (looks_ahead_ && list.touches.size() == touched) look_ahead(list, pair);
}

void SoftContacts::look_ahead(List& list, btBroadphasePair& pair) {
  const btCollisionObject &a = body_of(*pair.m_pProxy0), &b = body_of(*pair.m_pProxy1);
  const btVector3 way = this->way(a, gravity_) - this->way(b, gravity_);
  if (way.length2() < kLongWay_m * kLongWay_m || !a.hasContactResponse() || !b.hasContactResponse()) return;
  if (const std::optional<SoftMeeting> meeting = meeting_ahead(a, b, way)) list.will_meet.push_back({&pair, *meeting});
}

/// Computes contacts ahead of time: moves one of the two bodies to where they will touch, and back afterwards.
void SoftContacts::meet(const WillMeet& two, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info) {
  btBroadphasePair& pair = *two.pair;
  const btVector3 shift = two.meeting.until + two.meeting.normal * kOverlap_m;
  const bool first_moves = !body_of(*pair.m_pProxy0).isStaticObject();
  auto& moved = *static_cast<btCollisionObject*>((first_moves ? pair.m_pProxy0 : pair.m_pProxy1)->m_clientObject);
  const btTransform place = moved.getWorldTransform();
  moved.setWorldTransform(btTransform(place.getBasis(), place.getOrigin() + (first_moves ? shift : -shift)));
  const bool has_left_out = static_cast<Dispatcher&>(dispatcher).find_contacts(pair, info);
  collect_ahead(pair, two.meeting, shift, has_left_out);
  moved.setWorldTransform(place);
}

void SoftContacts::collect_ahead(const btBroadphasePair& pair, const SoftMeeting& meeting, const btVector3& shift,
                                 bool has_left_out) {
  const btCollisionObject &a = body_of(*pair.m_pProxy0), &b = body_of(*pair.m_pProxy1);
  List& list = lists_[0];
  const auto first = static_cast<std::uint32_t>(list.patches.size());
  const btManifoldArray& manifolds = manifolds_of(pair, list.manifolds);
  for (int i = 0; i < manifolds.size(); ++i) {
    if (manifolds[i]->getNumContacts() == 0) continue;
    SoftTouch& touch = touches_.emplace_back();
    touch = touch_of(*manifolds[i]);
    touch.ahead = true;
    read(list, touch, manifolds[i]->getBody0() == &a ? shift : -shift);
    manifolds[i]->clearManifold();
  }
  if (list.patches.size() == first && has_left_out) return;  // they only touch inner edges
  if (list.patches.size() == first) {                        // they touch so slightly that Bullet finds no point
    SoftTouch& touch = touches_.emplace_back();
    touch.ahead = true;
    touch.a = a.getUserIndex(), touch.b = b.getUserIndex(), touch.slot_a = slot_of(a), touch.slot_b = slot_of(b);
    touch.first_patch = first, touch.patches = 1;
    SoftPatch& patch = list.patches.emplace_back();
    patch.a = a.getUserIndex(), patch.b = b.getUserIndex();
    soft::from_bullet(meeting.normal, patch.normal);
    set_belt(patch, a, b);
    const Surface both = combined(surface_at(a, meeting.part_a), surface_at(b, meeting.part_b));
    patch.friction = static_cast<Real>(both.friction);
    patch.restitution = static_cast<Real>(both.restitution);
    patch.count = 1;
    soft::from_bullet(meeting.r_a, patch.points[0].r_a);
    soft::from_bullet(meeting.r_b, patch.points[0].r_b);
    patch.points[0].gap = static_cast<Real>(meeting.until.dot(meeting.normal));
  }
  for (std::size_t i = first; i < list.patches.size(); ++i) list.patches[i].ahead = true;
  if (a.isStaticObject() || b.isStaticObject()) return;
  const auto velocity = [](const btCollisionObject& object, const btVector3& r) {
    return btRigidBody::upcast(&object)->getVelocityInLocalPoint(r);
  };
  ahead_.push_back({pair.m_pProxy0, pair.m_pProxy1, first, static_cast<std::uint32_t>(list.patches.size()) - first,
                    b.getWorldTransform().getOrigin() + meeting.r_b,
                    velocity(a, meeting.r_a) - velocity(b, meeting.r_b)});
}

void SoftContacts::collect(List& list, const btBroadphasePair& pair) {
  const btManifoldArray& manifolds = manifolds_of(pair, list.manifolds);
  for (int i = 0; i < manifolds.size(); ++i) {
    if (manifolds[i]->getNumContacts() == 0) continue;
    SoftTouch& touch = list.touches.emplace_back(touch_of(*manifolds[i]));
    if (touch.acts) read(list, touch, {0, 0, 0});
  }
}

/// Marks the contacts of two bodies that slept until now as known (FirstContacts::know).
void SoftContacts::know_touches(List& list, const btBroadphasePair& pair) const {
  const btManifoldArray& manifolds = manifolds_of(pair, list.manifolds);
  for (int i = 0; i < manifolds.size(); ++i) {
    if (manifolds[i]->getNumContacts() > 0) first_contacts_.know(*manifolds[i]);
  }
}

/// Reads the patches of a touch. Impulses of friction belong to the patch, and are taken from its oldest point.
void SoftContacts::read(List& list, SoftTouch& touch, const btVector3& shift) {
  std::vector<SoftPatch>& patches = list.patches;
  const btPersistentManifold& manifold = *touch.manifold;
  const btVector3& centre_a = manifold.getBody0()->getWorldTransform().getOrigin();
  const btVector3& centre_b = manifold.getBody1()->getWorldTransform().getOrigin();
  touch.first_patch = static_cast<std::uint32_t>(patches.size());
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    const btManifoldPoint& point = manifold.getContactPoint(i);
    std::size_t k = touch.first_patch;
    while (k < patches.size() &&
           manifold.getContactPoint(patches[k].of[0]).m_normalWorldOnB.dot(point.m_normalWorldOnB) < kSameNormal) {
      ++k;
    }
    if (k == patches.size()) {
      SoftPatch& made = patches.emplace_back();
      made.manifold = touch.manifold, made.a = touch.a, made.b = touch.b;
      soft::from_bullet(-point.m_normalWorldOnB, made.normal);
      set_belt(made, *manifold.getBody0(), *manifold.getBody1());
      made.friction = static_cast<Real>(point.m_combinedFriction);
      made.restitution = static_cast<Real>(point.m_combinedRestitution);
      made.spinning_m = static_cast<Real>(point.m_combinedSpinningFriction);
      made.rolling_m = static_cast<Real>(point.m_combinedRollingFriction);
    }
    SoftPatch& patch = patches[k];
    int oldest = -1;
    for (int j = 0; j < patch.count; ++j) {
      oldest = std::max(oldest, manifold.getContactPoint(patch.of[static_cast<std::size_t>(j)]).m_lifeTime);
    }
    if (point.m_lifeTime > oldest) {
      patch.rub_1 = static_cast<Real>(point.m_appliedImpulseLateral1);
      patch.rub_2 = static_cast<Real>(point.m_appliedImpulseLateral2);
      patch.twist = static_cast<Real>(point.m_prevRHS);
    }
    const auto place = static_cast<std::size_t>(patch.count++);
    patch.of[place] = static_cast<std::int8_t>(i);
    SoftPatch::Point& to = patch.points[place];
    soft::from_bullet(point.getPositionWorldOnA() - centre_a, to.r_a);
    soft::from_bullet(point.getPositionWorldOnB() - centre_b, to.r_b);
    to.gap = static_cast<Real>(point.getDistance() - shift.dot(point.m_normalWorldOnB));
    to.impulse = static_cast<Real>(point.m_appliedImpulse);
  }
  touch.patches = static_cast<std::uint32_t>(patches.size()) - touch.first_patch;
}

}  // namespace aurasim::physics
