#include "physics/soft/world.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <span>
#include <vector>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/progress.h"
#include "core/used_room.h"
#include "physics/bounds.h"
#include "physics/broadphase.h"
#include "physics/contact_impulses.h"
#include "physics/contact_pairs.h"
#include "physics/dispatcher.h"
#include "physics/first_contacts.h"
#include "physics/settings.h"
#include "physics/soft/contacts.h"
#include "physics/soft/islands.h"
#include "physics/soft/listed_joints.h"
#include "physics/soft/resting_pairs.h"
#include "physics/soft/shared.h"
#include "physics/soft/step.h"
#include "physics/soft/threads.h"

namespace aurasim::physics {
namespace {

template <class T>
std::span<T* const> span_of(btAlignedObjectArray<T*>& array) {
  return {array.size() > 0 ? &array[0] : nullptr, static_cast<std::size_t>(array.size())};
}

class SoftWorld final : public World {
 public:
  SoftWorld(const WorldParts& parts, const Settings& settings)
      : World(&parts.dispatcher, &parts.broadphase, &parts.solver, &parts.configuration),
        first_contacts_(parts.first_contacts),
        contact_impulses_(parts.contact_impulses),
        settings_(settings),
        moving_statics_(parts.moving_statics),
        team_(parts.team),
        resting_(static_cast<ContactPairs&>(*parts.broadphase.getOverlappingPairCache()),
                 static_cast<Dispatcher&>(parts.dispatcher), parts.first_contacts) {
    make_lists();
  }

  int stepSimulation(btScalar step_s, int, btScalar) override {
    team_.employ_for(islands_.awake().size());  // as many as at the end of the last step
    islands_.call(team_);
    if (used_room_.is_spare(islands_.awake().size())) free_spare_memory();
    bring_back([this](std::uint32_t slot) { return !islands_.sleeps(slot); });
    resting_.put_away(islands_);
    moved_.assign(islands_.awake().begin(), islands_.awake().end());
    prepare(step_s);
    if (!islands_.are_at_rest()) m_broadphasePairCache->calculateOverlappingPairs(m_dispatcher1);
    core::Progress::mark();
    contacts_->look(*getPairCache(), static_cast<btCollisionDispatcher&>(*m_dispatcher1), getDispatchInfo(),
                    getGravity());
    first_contacts_.report(contacts_->came(), *getPairCache());
    joints_.look(span_of(m_constraints), team_);
    islands_.find_parts(contacts_->touches(), contacts_->touches_of_sleepers(), joints_.all());
    if (shared_) shared_->tell_stirs(islands_);
    islands_.settle(contacts_->touches(), contacts_->parted());
    joints_.sort([this](std::uint32_t slot) { return islands_.moves(slot); });
    if (islands_.has_woken_any()) {
      bring_back([this](std::uint32_t slot) { return islands_.is_woken(slot); });
      contacts_->add_woken(*getPairCache());
      std::ranges::copy_if(islands_.awake(), std::back_inserter(moved_),
                           [this](const btRigidBody* body) { return islands_.is_woken(slot_of(*body)); });
    }
    if (shared_ && shared_->meet(*contacts_, islands_)) {
      contacts_->add_woken_guests(*getPairCache());
      std::ranges::copy_if(islands_.guests(), std::back_inserter(moved_),
                           [this](const btRigidBody* guest) { return islands_.is_woken(slot_of(*guest)); });
    }
    islands_.sort(contacts_->touches(), team_);
    core::Progress::mark();
    step_->solve({islands_.awake(), moving_statics_, islands_.touches(), joints_.sorted(), getGravity(),
                  shared_ ? &*shared_ : nullptr},
                 *contacts_, contact_impulses_);
    report_met();
    islands_.rest(step_s, team_);
    if (shared_) shared_->call_sleepers(islands_);
    called_.clear();
    for (const std::uint32_t slot : islands_.called()) called_.push_back(&islands_.body_at(slot));
    return 1;
  }

  void forget_past() override { islands_.forget_past(); }

  void couple(const Coupling& coupling) override { shared_.emplace(coupling, settings_.block_m); }
  void expect_contacts_with(std::span<const core::RegionId> regions) override { shared_->expect(regions); }

  bool knows_moved() const override { return true; }
  std::span<btRigidBody* const> moved() const override { return moved_; }
  std::span<const btRigidBody* const> called() const override { return called_; }
  void add_contacts_of_moved(std::vector<std::pair<int, int>>& contacts) const override {
    if (moved_.empty()) return;
    for (const SoftTouch& touch : contacts_->touches()) {
      if (touch.ahead) continue;
      contacts.emplace_back(std::min(touch.a, touch.b), std::max(touch.a, touch.b));
    }
  }

  // Bullet's list of bodies that are no statics is kept empty. It is not used, and would be searched for each body that
  // leaves.
  void addRigidBody(btRigidBody* body) override {
    islands_.insert(*body);
    btDiscreteDynamicsWorld::addRigidBody(body);
    m_nonStaticRigidBodies.resize(0);
  }
  void addRigidBody(btRigidBody* body, int group, int mask) override {
    islands_.insert(*body);
    btDiscreteDynamicsWorld::addRigidBody(body, group, mask);
    m_nonStaticRigidBodies.resize(0);
  }
  void removeRigidBody(btRigidBody* body) override {
    islands_.remove(*body);
    btDiscreteDynamicsWorld::removeRigidBody(body);
  }

 private:
  /// Makes the parts that hold nothing but lists of the present step.
  void make_lists() {
    contacts_.emplace(settings_.step_s, settings_.continuous, team_, islands_, first_contacts_);
    step_.emplace(settings_, team_);
  }

  /// Frees the memory that steps with many awake bodies have used.
  void free_spare_memory() {
    make_lists();
    islands_.free_spare_memory();
    core::free_memory(moved_);
    joints_ = {};
  }

  /// Brings back the pairs of awake bodies that are `wanted(slot)`.
  template <class Wanted>
  void bring_back(Wanted&& wanted) {
    const SleepingPairs& sleeping = static_cast<const ContactPairs&>(*getPairCache()).sleeping();
    if (sleeping.empty()) return;
    for (const btRigidBody* body : islands_.awake()) {
      const std::uint32_t slot = slot_of(*body);
      if (sleeping.has(slot) && wanted(slot)) resting_.bring_back(slot, getDispatchInfo());
    }
  }

  /// Reports the first contacts of bodies that touched within the step, perhaps only for a part of it.
  void report_met() {
    for (const SoftAhead& ahead : contacts_->ahead()) {
      if (std::ranges::none_of(contacts_->patches_of(ahead), &SoftPatch::has_pressed)) continue;
      const auto& a = *static_cast<const btCollisionObject*>(ahead.proxy_a->m_clientObject);
      const auto& b = *static_cast<const btCollisionObject*>(ahead.proxy_b->m_clientObject);
      first_contacts_.add({a.getUserIndex(), b.getUserIndex(), 0, static_cast<double>(ahead.v.length()), ahead.p},
                          *getPairCache()->findPair(ahead.proxy_a, ahead.proxy_b));
    }
  }

  /// Damps the awake bodies, and updates their bounds. Most of them stay in their boxes.
  void prepare(btScalar step_s) {
    const std::span<btRigidBody* const> awake = islands_.awake();
    contacts_->bounds().begin(islands_.slots());
    team_.side_by_side([&](const soft::Worker& worker) {
      const auto [first, last] = worker.share(awake.size());
      for (std::size_t i = first; i < last; ++i) {
        btRigidBody& body = *awake[i];
        if (body.getLinearDamping() > 0 || body.getAngularDamping() > 0) body.applyDamping(step_s);
        islands_.look_at(body);
        const Bounds bounds = bounds_ahead(body);
        contacts_->bounds().note(slot_of(body), bounds);
        broadphase().bound(*body.getBroadphaseHandle(), bounds, worker);
      }
    });
    broadphase().give_boxes();
  }
  Broadphase& broadphase() { return static_cast<Broadphase&>(*m_broadphasePairCache); }

  /// Bounds of a body, with its way in the step.
  Bounds bounds_ahead(const btRigidBody& body) const {
    const btVector3 margin(gContactBreakingThreshold, gContactBreakingThreshold, gContactBreakingThreshold);
    btVector3 low, high;
    body.getAabb(low, high);
    if (settings_.continuous) {
      const btVector3 way = contacts_->way(body, getGravity()), none(0, 0, 0);
      btVector3 back = way, on = way;
      back.setMin(none), on.setMax(none);
      low += back, high += on;
    }
    return {low - margin, high + margin};
  }

  FirstContacts& first_contacts_;
  ContactImpulses& contact_impulses_;
  SoftIslands islands_;
  ListedJoints joints_;
  const Settings settings_;
  core::UsedRoom used_room_;
  std::optional<SoftContacts> contacts_;  ///< never empty
  std::vector<btRigidBody*> moved_;       ///< bodies that were awake at the start of the last step, or were woken in it
  std::vector<const btRigidBody*> called_;  ///< sleepers that wake in the next step
  const std::vector<btRigidBody*>& moving_statics_;
  std::optional<SoftStep> step_;  ///< never empty
  soft::Team& team_;
  RestingPairs resting_;
  std::optional<SoftShared> shared_;  ///< if this world is coupled with those of other regions
};

}  // namespace

std::unique_ptr<World> make_soft_world(const WorldParts& parts, const Settings& settings) {
  return std::make_unique<SoftWorld>(parts, settings);
}

}  // namespace aurasim::physics
