// Coupled regions (physics/coupling.h): who hosts a body, and which bodies of other regions a region has to know, is
// settled before each step.
//
// A body is sent to a region if it may touch something in that region's territory within the step. So two bodies that
// may touch are both known to the host of one of them, unless both are far from home. A body that extends beyond the
// territory of its host is far. Whoever meets a far body there answers its host with all that the body may touch.
#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "core/keep_one_of_each.h"
#include "physics/bounds.h"
#include "physics/bullet_convert.h"
#include "physics/halo.h"
#include "physics/moving_body.h"
#include "physics/simulation.h"

namespace aurasim::physics {

void Simulation::couple(const Coupling& coupling) {
  coupling_ = std::make_unique<Coupling>(coupling);
  world_.couple(coupling);
  notes_.for_borders.note_all();
}

/// Bounds of what a body may touch in the next step.
Bounds Simulation::reach_of(const btRigidBody& body) const {
  Bounds bounds = bounds_of(body).grown(scalar(kReachSlack_m));
  if (!body.isActive()) return bounds;
  const btScalar step_s = scalar(settings_.step_s);
  const btVector3 pull = to_bullet(scene_->gravity) + body.getInvMass() * body.getTotalForce();
  const btVector3 way = step_s * body.getLinearVelocity(), drop = step_s * step_s / 2 * pull;
  const btVector3 none(0, 0, 0);
  for (const btVector3& end : {way, drop}) {
    btVector3 back = end, on = end;
    back.setMin(none), on.setMax(none);
    bounds.low += back, bounds.high += on;
  }
  return bounds;
}

/// A box around reach_of(), which takes less time.
Bounds Simulation::around_reach_of(const btRigidBody& body) const {
  const btScalar step_s = scalar(settings_.step_s);
  const btVector3 pull = to_bullet(scene_->gravity) + body.getInvMass() * body.getTotalForce();
  const btScalar radius_m = scalar(place_of(body).radius_m + 2 * kReachSlack_m);
  const btVector3 around = step_s * body.getLinearVelocity().absolute() + step_s * step_s / 2 * pull.absolute() +
                           btVector3(radius_m, radius_m, radius_m);
  const btVector3& p_WB = body.getWorldTransform().getOrigin();
  return {p_WB - around, p_WB + around};
}

Visit Simulation::visit_of(const HostedBody& body) const {
  return {body.record(), host_of(body), from_bullet(body.rigid->getTotalForce()),
          from_bullet(body.rigid->getTotalTorque())};
}

/// The region that hosts a body in the next step.
core::RegionId Simulation::host_of(const HostedBody& body) const {
  const BodyPlace& place = place_of(*body.rigid);
  if (place.is_guest) return place.host;
  const core::RegionId self = coupling_->self;
  return coupling_->owners->owns(self, place.block) ? self : coupling_->owners->owner(place.block);
}

void Simulation::meet_neighbours() {
  arrived_.clear();
  const std::vector<core::BodyId> guests_before = std::exchange(guests_, {});
  std::vector<Visit> guests;  // of this region
  const std::vector<core::ClusterState> left = send_halos(guests);
  std::vector<Halo> received;
  for_each_peer(*coupling_, [&](core::RegionId peer) {
    received.push_back(fetch(peer));
    for (const core::BodyRecord& body : received.back().for_you.bodies) arrived_.push_back({body, peer});
  });
  std::ranges::sort(arrived_, {}, [](const Moved& moved) { return moved.body.id; });
  for (Halo& halo : received) {
    for (const core::BodyId id : halo.broken) part_from(id);
    guests.insert(guests.end(), halo.guests.begin(), halo.guests.end());
  }
  ++meeting_;
  take_guests(guests);
  for (const Halo& halo : received) take_over(halo.for_you, halo.arrivals);
  for (const core::ClusterState& cluster : left) restore_contacts(cluster);
  meet_far();
  restore_late_contacts();
  core::keep_one_of_each(guests_);
  send_home(guests_before);
  find_seams();
}

/// Sends each partner the bodies that it hosts from now on, and its guests. Returns the bodies that have left, with
/// their contacts. Adds them to `guests`: they are at first guests of this region.
std::vector<core::ClusterState> Simulation::send_halos(std::vector<Visit>& guests) {
  std::map<core::RegionId, Halo> halos;
  for_each_peer(*coupling_, [&](core::RegionId peer) { halos[peer].broken = broken_; });
  broken_.clear();
  left_.clear();
  at_border_.clear();
  std::map<core::RegionId, std::vector<core::BodyId>> leaving;
  watched_.add(notes_.for_borders, table_);
  const auto tell_of = [&](const HostedBody& body) {
    const core::RegionId host = host_of(body);
    const bool is_ours = host == coupling_->self;
    if (is_ours && is_within(around_reach_of(*body.rigid), coupling_->owners->interior(host))) return;
    if (!is_ours) {
      expect_to_meet(*coupling_, host);
      leaving[host].push_back(body.id);
      guests.push_back(visit_of(body));
      left_.push_back({guests.back().body, host});
      halos[host].arrivals.push_back(guests.back());
    }
    const Bounds reach = reach_of(*body.rigid);
    if (is_ours && is_within(reach, coupling_->owners->interior(host))) return;
    if (is_ours) at_border_.push_back({body.id, reach});
    for (auto& [peer, halo] : halos) {
      if (peer != host && overlap(reach, coupling_->owners->territory(peer))) halo.guests.push_back(visit_of(body));
    }
    check_partners(reach);
  };
  watched_.keep(table_, [&](const HostedBody& body) {
    if (!is_to_be_watched(body)) return false;
    if (!is_guest(*body.rigid)) tell_of(body);
    return true;
  });
  std::vector<std::span<const core::BodyId>> clusters;
  for (const auto& [host, ids] : leaving) clusters.emplace_back(ids);
  std::vector<core::ClusterState> left = hand_over(clusters);
  std::size_t next = 0;
  for (const auto& [host, ids] : leaving) {
    for (core::BodyRecord& body : left[next].bodies) ++body.epoch;
    halos[host].for_you = left[next++];
  }
  for (const auto& [peer, halo] : halos) post(peer, halo);
  return left;
}

/// Throws std::logic_error unless this region exchanges parcels with all regions whose territory a body may reach.
void Simulation::check_partners(const Bounds& reach) const {
  const core::BlockOwners& owners = *coupling_->owners;
  if (is_within(reach, owners.surroundings(coupling_->self))) return;
  for (std::uint32_t i = 0; i < owners.size(); ++i) {
    const core::RegionId region{i};
    if (region != coupling_->self && overlap(reach, owners.territory(region))) expect_to_meet(*coupling_, region);
  }
}

void Simulation::restore_later(const core::ClusterState& cluster, std::span<const std::uint32_t> records) {
  for (const std::uint32_t index : records) {
    core::ManifoldRecord& later = late_contacts_.manifolds.emplace_back(cluster.manifolds[index]);
    const auto first =
        cluster.points.begin() + static_cast<std::ptrdiff_t>(later.first_point * core::kContactPointDoubles);
    later.first_point = static_cast<std::uint32_t>(late_contacts_.points.size() / core::kContactPointDoubles);
    late_contacts_.points.insert(late_contacts_.points.end(), first,
                                 first + static_cast<std::ptrdiff_t>(later.point_count * core::kContactPointDoubles));
  }
}

/// Contacts of a saved world with bodies of other regions are restored when these have come for the first time.
void Simulation::restore_late_contacts() {
  const core::ClusterState late = std::exchange(late_contacts_, {});
  if (late.manifolds.empty()) return;
  notes_.give_up_copy();
  restore_contacts(late);
  late_contacts_ = {};  // of bodies that are not near any more
}

/// Tells the hosts of far bodies what these may touch here, and learns what our far bodies may touch elsewhere.
void Simulation::meet_far() {
  struct Far {
    core::BodyId id;
    core::RegionId host;
    Bounds reach;
  };
  const core::BlockOwners& owners = *coupling_->owners;
  std::vector<Far> far;
  for (const AtBorder& body : at_border_) {
    if (!is_within(body.reach, owners.territory(coupling_->self)))
      far.push_back({body.id, coupling_->self, body.reach});
  }
  const auto look_at = [&](core::BodyId id, core::RegionId host, const btRigidBody& body) {
    if (is_within(around_reach_of(body), owners.territory(host))) return;
    const Bounds reach = reach_of(body);
    if (!is_within(reach, owners.territory(host))) far.push_back({id, host, reach});
  };
  for (const Moved& arrived : arrived_) look_at(arrived.body.id, coupling_->self, *table_.find(arrived.body.id)->rigid);
  std::size_t near = 0;
  for (const core::BodyId id : guests_) {
    const btRigidBody& guest = *table_.find(id, near)->rigid;
    look_at(id, place_of(guest).host, guest);
  }
  std::map<core::RegionId, Halo> answers;
  std::vector<core::RegionId> expected;
  for (const Far& one : far) {
    if (one.host == coupling_->self) {
      for_each_peer(*coupling_, [&](core::RegionId peer) {
        if (overlap(one.reach, owners.territory(peer))) expected.push_back(peer);
      });
    } else if (overlap(one.reach, owners.territory(coupling_->self))) {
      answers[one.host];
    }
  }
  for (auto& [host, answer] : answers) {
    for (const HostedBody& body : table_.bodies()) {
      if (!body.born || host_of(body) == host) continue;
      const Bounds reach = reach_of(*body.rigid);
      const bool is_known = overlap(reach, owners.territory(host));  // it was sent before
      const auto may_touch = [&](const Far& one) { return one.host == host && overlap(one.reach, reach); };
      const bool is_far_guest = std::ranges::any_of(far, [&](const Far& one) { return one.id == body.id; });
      if (is_guest(*body.rigid) && !is_far_guest) continue;
      if (!is_known && std::ranges::any_of(far, may_touch)) answer.guests.push_back(visit_of(body));
    }
    post(host, answer);
  }
  core::keep_one_of_each(expected);
  std::vector<Visit> guests;
  for (const core::RegionId peer : expected) {
    const Halo answer = fetch(peer);
    guests.insert(guests.end(), answer.guests.begin(), answer.guests.end());
  }
  take_guests(guests);
}

void Simulation::post(core::RegionId to, const Halo& halo) {
  parcel_.clear();
  write(halo, parcel_);
  coupling_->mail->post(to, parcel_.bytes());
}

Halo Simulation::fetch(core::RegionId from) {
  ParcelReader parcel(coupling_->mail->fetch(from));
  Halo halo = read_halo(parcel);
  const auto check = [this](const core::BodyRecord& body) {
    if (core::value_of(body.prototype) >= scene_->prototypes.size()) throw BadParcel("unknown prototype in a parcel");
  };
  for (const Visit& visit : halo.guests) check(visit.body);
  for (const core::BodyRecord& body : halo.for_you.bodies) check(body);
  return halo;
}

/// Removes bodies that another region hosts from now on.
std::vector<core::ClusterState> Simulation::hand_over(std::span<const std::span<const core::BodyId>> clusters) {
  if (clusters.empty()) return {};
  notes_.give_up_copy();
  std::vector<core::ClusterState> left = copy_whole(clusters);
  for (const std::span<const core::BodyId> cluster : clusters) {
    for (const core::BodyId id : cluster) {
      const btRigidBody* const gone = table_.find(id)->rigid.get();
      std::erase_if(pushed_, [gone](const Push& push) { return push.body == gone; });
    }
  }
  const std::uint64_t severed = severed_contacts_;
  release(clusters);
  severed_contacts_ = severed;  // both sides keep the contacts with bodies that stay
  return left;
}

/// Adds bodies that this region hosts from now on, with their contacts.
void Simulation::take_over(const core::ClusterState& cluster, std::span<const Visit> visits) {
  if (cluster.bodies.empty()) return;
  notes_.give_up_copy();
  std::vector<core::BodyId> known;
  for (const core::BodyRecord& body : cluster.bodies) {
    const HostedBody* const here = table_.find(body.id);
    if (here != nullptr && is_guest(*here->rigid)) known.push_back(body.id);
  }
  drop_guests(known);
  join(cluster);
  for (std::size_t i = 0; i < visits.size(); ++i) {
    push(*table_.find(cluster.bodies[i].id)->rigid, visits[i]);
  }
}

void Simulation::push(btRigidBody& body, const Visit& visit) {
  if (visit.force.isZero(0) && visit.torque.isZero(0)) return;
  pushed_.push_back({&body, to_bullet(visit.force), to_bullet(visit.torque)});
  body.applyCentralForce(pushed_.back().force);
  body.applyTorque(pushed_.back().torque);
}

void Simulation::take_guests(std::vector<Visit>& visits) {
  const auto id_of = [](const Visit& visit) { return visit.body.id; };
  std::ranges::stable_sort(visits, {}, id_of);
  const auto twins = std::ranges::unique(visits, {}, id_of);  // several regions may answer with the same body
  visits.erase(twins.begin(), twins.end());
  std::vector<HostedBody> arrivals;
  std::size_t near = 0;
  for (const Visit& visit : visits) {
    HostedBody* body = table_.find(visit.body.id, near);
    if (body == nullptr) {
      arrivals.push_back(make_body(visit.body));
      arrivals.back().is_guest = place_of(*arrivals.back().rigid).is_guest = true;
      continue;
    }
    if (!is_guest(*body->rigid)) {
      throw BadParcel("body " + std::to_string(core::value_of(body->id)) + " has two hosts");
    }
    set_motion(*body->rigid, visit.body);
    note_change(*body->rigid);
    world_.move(*body->rigid);
  }
  if (!arrivals.empty()) {
    notes_.give_up_copy();
    insert(std::move(arrivals));
    insert_born();
  }
  near = 0;
  for (const Visit& visit : visits) {
    btRigidBody& body = *table_.find(visit.body.id, near)->rigid;
    BodyPlace& place = place_of(body);
    place.host = visit.host, place.met = meeting_;
    guests_.push_back(visit.body.id);
    push(body, visit);
  }
}

/// Removes a guest that has been removed from the world. What lay on it wakes.
void Simulation::part_from(core::BodyId id) {
  const HostedBody* const body = table_.find(id);
  if (body == nullptr || !is_guest(*body->rigid)) return;
  wake_beside(id);
  drop_guests({&id, 1});
}

/// Removes those of earlier guests that no longer come near.
void Simulation::send_home(std::span<const core::BodyId> guests_before) {
  std::vector<core::BodyId> gone;
  std::size_t near = 0;
  for (const core::BodyId id : guests_before) {
    const HostedBody* const body = table_.find(id, near);
    if (body != nullptr && is_guest(*body->rigid) && place_of(*body->rigid).met != meeting_) gone.push_back(id);
  }
  drop_guests(gone);
}

void Simulation::drop_guests(std::span<const core::BodyId> ids) {
  if (ids.empty()) return;
  notes_.give_up_copy();  // which contacts other bodies still have with them is not known
  std::vector<std::uint32_t> leaving;
  std::vector<btRigidBody*> gone;
  for (const core::BodyId id : ids) {
    HostedBody* const body = table_.find(id);
    leaving.push_back(static_cast<std::uint32_t>(body - table_.bodies().data()));
    gone.push_back(body->rigid.get());
    std::erase_if(pushed_, [&](const Push& push) { return push.body == body->rigid.get(); });
  }
  world_.remove(gone);
  std::ranges::sort(leaving);
  erase(leaving);
}

}  // namespace aurasim::physics
