#include "physics/soft/shared.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "core/keep_one_of_each.h"
#include "physics/bullet_convert.h"
#include "physics/moving_body.h"
#include "physics/soft/contacts.h"
#include "physics/soft/islands.h"
#include "physics/soft/seam_parcels.h"

namespace aurasim::physics {
namespace {

using soft::Mover;

SoftPlace place(const btRigidBody& body, double block_m) {
  const BodyPlace& place = place_of(body);
  return soft_place(from_bullet(body.getWorldTransform().getOrigin()), place.block, place.radius_m, block_m);
}

/// The two regions would wait for each other, or solve the contact differently.
[[noreturn]] void throw_unexpected(const btRigidBody& a, const btRigidBody& b) {
  throw std::logic_error("bodies " + std::to_string(core::value_of(place_of(a).id)) + " and " +
                         std::to_string(core::value_of(place_of(b).id)) +
                         " touch, and were not expected to reach each other in this step");
}

}  // namespace

bool SoftShared::is_expected(core::RegionId region) const { return std::ranges::find(peers_, region) != peers_.end(); }

std::vector<core::RegionId> SoftShared::audience(const btRigidBody& body, SoftPhase phase) const {
  if (phase == SoftPhase::kGiants) return peers_;
  std::vector<core::RegionId> regions;
  const core::Block corner = place(body, block_m_).corner;
  for (const core::Block& block : {core::Block{corner.x - 1, corner.y - 1}, core::Block{corner.x, corner.y - 1},
                                   core::Block{corner.x - 1, corner.y}, corner}) {
    const core::RegionId region = coupling_.owners->owner(block);
    if (region == coupling_.self || std::ranges::find(regions, region) != regions.end()) continue;
    expect_to_meet(coupling_, region);
    if (is_expected(region)) regions.push_back(region);
  }
  return regions;
}

void SoftShared::tell_stirs(SoftIslands& islands) {
  // Whether a part stirs only matters to bodies that sleep or want to. Both hosts know of which bodies this is true.
  std::map<core::RegionId, std::vector<std::pair<core::BodyId, std::uint32_t>>> ours, theirs;
  islands.for_each_seam([&](std::uint32_t a, std::uint32_t b) {
    const btRigidBody *one = &islands.body_at(a), *other = &islands.body_at(b);
    if (is_guest(*one) == is_guest(*other)) return;
    if (is_guest(*one)) std::swap(one, other), std::swap(a, b);
    const core::RegionId host = place_of(*other).host;
    if (islands.is_sleepy(b)) ours[host].emplace_back(place_of(*one).id, a);
    if (islands.is_sleepy(a)) theirs[host].emplace_back(place_of(*other).id, b);
  });
  for (auto& [host, bodies] : ours) {
    core::keep_one_of_each(bodies);
    parcel_.clear();
    for (const auto& [id, slot] : bodies) parcel_.put(static_cast<std::uint8_t>(islands.stirs(slot)));
    coupling_.mail->post(host, parcel_.bytes());
  }
  for (auto& [host, bodies] : theirs) {
    core::keep_one_of_each(bodies);
    ParcelReader parcel(coupling_.mail->fetch(host));
    for (const auto& [id, slot] : bodies) {
      if (parcel.take<std::uint8_t>() != 0) islands.note_stirs(slot);
    }
    if (!parcel.at_end()) throw BadParcel("a parcel between regions is too long");
  }
}

void SoftShared::call_sleepers(SoftIslands& islands) {
  std::map<core::RegionId, ParcelWriter> ours;
  std::map<core::RegionId, std::vector<std::pair<std::uint32_t, const SoftTouch*>>> theirs;
  for (const SoftTouch& touch : islands.touches()) {
    if (touch.slot_a == 0 || touch.slot_b == 0) continue;
    const bool a_moves = islands.moves(touch.slot_a);
    if (a_moves == islands.moves(touch.slot_b)) continue;
    const std::uint32_t mover = a_moves ? touch.slot_a : touch.slot_b, sleeper = a_moves ? touch.slot_b : touch.slot_a;
    const btRigidBody &moved = islands.body_at(mover), &asleep = islands.body_at(sleeper);
    if (is_guest(moved) == is_guest(asleep)) continue;
    if (is_guest(asleep)) {
      const bool is_calm = moved.getActivationState() == WANTS_DEACTIVATION;
      ParcelWriter& parcel = ours[place_of(asleep).host];
      parcel.put(static_cast<std::uint8_t>(!is_calm));
      write_impulses(touch, parcel);
    } else {
      theirs[place_of(moved).host].emplace_back(sleeper, &touch);
    }
  }
  for (const auto& [host, parcel] : ours) coupling_.mail->post(host, parcel.bytes());
  for (const auto& [host, sleepers] : theirs) {
    ParcelReader parcel(coupling_.mail->fetch(host));
    for (const auto& [sleeper, touch] : sleepers) {
      if (parcel.take<std::uint8_t>() != 0) islands.call(sleeper);
      read_impulses(parcel, *touch);
    }
    if (!parcel.at_end()) throw BadParcel("a parcel between regions is too long");
  }
}

bool SoftShared::meet(SoftContacts& contacts, SoftIslands& islands) {
  for (const std::uint32_t slot : touched_slots_) touched_[slot] = {};
  touched_slots_.clear();
  touched_.resize(islands.slots());
  struct Told {
    std::vector<const btRigidBody*> bodies;
    std::vector<std::pair<const SoftTouch*, SoftPhase>> touches;
  };
  std::map<core::RegionId, Told> told;
  for (const core::RegionId peer : peers_) told[peer];
  for (const SoftTouch& touch : contacts.touches()) {
    if (touch.a < 0 || touch.b < 0 || !touch.acts) continue;
    const btRigidBody* const ends[2] = {&islands.body_at(touch.slot_a), &islands.body_at(touch.slot_b)};
    const SoftPhase phase = physics::phase_of(place(*ends[0], block_m_), place(*ends[1], block_m_));
    if (phase == SoftPhase::kInside) continue;
    for (int i = 0; i < 2; ++i) {
      Touched& touched = touched_[slot_of(*ends[i])];
      if (touched.phases == 0) touched_slots_.push_back(slot_of(*ends[i]));
      touched.phases |= bit_of(phase);
      if (phase == SoftPhase::kEdges)
        touched.across = is_guest(*ends[1 - i]) ? place_of(*ends[1 - i]).host : coupling_.self;
      if (!is_guest(*ends[i])) continue;
      if (!is_expected(place_of(*ends[i]).host)) throw_unexpected(*ends[0], *ends[1]);
      told[place_of(*ends[i]).host].bodies.push_back(ends[1 - i]);
    }
    if (phase == SoftPhase::kEdges) continue;
    const bool we_tell = !is_guest(*ends[touch.a < touch.b ? 0 : 1]);  // both hosts have found it
    for (const core::RegionId peer : audience(*ends[0], phase)) {
      bool has_it = false;
      for (const btRigidBody* end : ends) {
        if (is_guest(*end)) {
          has_it = has_it || place_of(*end).host == peer;
        } else {
          told[peer].bodies.push_back(end);
        }
      }
      if (we_tell && !has_it) told[peer].touches.emplace_back(&touch, phase);
    }
  }
  for (auto& [peer, what] : told) {
    core::keep_one_of_each(what.bodies, [](const btRigidBody* body) { return body->getUserIndex(); });
    parcel_.clear();
    parcel_.put(static_cast<std::uint32_t>(what.bodies.size()));
    for (const btRigidBody* body : what.bodies) {
      const std::uint8_t phases = elsewhere(touched_[slot_of(*body)], peer);
      write_body(*body, islands.moves(slot_of(*body)), phases, parcel_);
    }
    std::size_t patches = 0;
    for (const auto& [touch, phase] : what.touches) patches += touch->patches;
    parcel_.put(static_cast<std::uint32_t>(patches));
    for (const auto& [touch, phase] : what.touches) {
      for (const SoftPatch& patch : contacts.patches_of(*touch)) {
        for (const std::uint32_t end : {touch->slot_a, touch->slot_b}) {
          parcel_.put(core::value_of(place_of(islands.body_at(end)).id));
        }
        parcel_.put(static_cast<std::int32_t>(touch->parts.part0));
        parcel_.put(static_cast<std::int32_t>(touch->parts.part1));
        parcel_.put(static_cast<std::uint8_t>(phase));
        write_patch(patch, parcel_);
      }
    }
    coupling_.mail->post(peer, parcel_.bytes());
  }
  foreign_.clear();
  foreign_patches_.clear();
  for (const core::RegionId peer : peers_) read(peer);
  bool any_woken = false;
  for (btRigidBody* body : islands.guests()) {
    const auto known = foreign_.find(place_of(*body).id);
    islands.decide(*body, known != foreign_.end() && known->second.moves);
    any_woken = any_woken || islands.is_woken(slot_of(*body));
  }
  return any_woken;
}

void SoftShared::read(core::RegionId from) {
  ParcelReader parcel(coupling_.mail->fetch(from));
  for (std::uint32_t left = parcel.take_count(kBodyBytes); left > 0; --left) {
    const core::BodyId id{parcel.take<std::uint64_t>()};
    Foreign& body = foreign_[id];
    body.host = from;
    body.moves = parcel.take<std::uint8_t>() != 0;
    body.elsewhere = parcel.take<std::uint8_t>();
    body.inertia.inv_mass = parcel.take<soft::Real>();
    parcel.take_some(body.inertia.inv_inertia, 6);
    parcel.take_some(body.v, 3), parcel.take_some(body.w, 3);
  }
  for (std::uint32_t left = parcel.take_count(kLeastPatchBytes); left > 0; --left) {
    ForeignPatch& patch = foreign_patches_.emplace_back();
    patch.a = core::BodyId{parcel.take<std::uint64_t>()}, patch.b = core::BodyId{parcel.take<std::uint64_t>()};
    patch.parts.part0 = parcel.take<std::int32_t>(), patch.parts.part1 = parcel.take<std::int32_t>();
    const auto phase = parcel.take<std::uint8_t>();
    patch.phase = static_cast<SoftPhase>(phase);
    if (patch.phase != SoftPhase::kCorners && patch.phase != SoftPhase::kGiants) {
      throw BadParcel("a contact of another region has an unknown phase");
    }
    patch.patch = read_patch(parcel);
  }
  if (!parcel.at_end()) throw BadParcel("a parcel between regions is too long");
}

void SoftShared::make_room(std::vector<btRigidBody*>& held) {
  for (auto& waiting : waiting_) waiting.clear();
  for (auto& common : common_) common.clear();
  known_.assign(held.size(), {});
  for (std::size_t i = 1; i < held.size(); ++i) {
    const BodyPlace& place = place_of(*held[i]);
    known_[i] = {place.id, place.is_guest ? place.host : coupling_.self, {}, 0, nullptr};
    if (!place.is_guest) {
      known_[i].touched = touched_[slot_of(*held[i])];
    } else if (const auto body = foreign_.find(place.id); body != foreign_.end()) {
      body->second.mover = static_cast<std::int32_t>(i);
      known_[i].elsewhere = body->second.elsewhere;
    }
  }
  for (const ForeignPatch& patch : foreign_patches_) {
    for (const core::BodyId id : {patch.a, patch.b}) {
      const auto body = foreign_.find(id);
      if (body == foreign_.end() || !body->second.moves || body->second.mover > 0) continue;
      body->second.mover = static_cast<std::int32_t>(held.size());
      held.push_back(nullptr);
      known_.push_back({id, body->second.host, {}, body->second.elsewhere, nullptr});
    }
  }
}

void SoftShared::take_in(Mover* movers, std::vector<SoftInertia>& inertias) const {
  for (const auto& [id, body] : foreign_) {
    if (body.mover == 0) continue;
    Mover& mover = movers[body.mover];
    mover = {};
    std::copy_n(body.v, 3, mover.v), std::copy_n(body.w, 3, mover.w);
    inertias[static_cast<std::size_t>(body.mover)] = body.inertia;
  }
}

void SoftShared::add(const SoftTouch& touch, std::span<SoftPatch> found, std::int32_t a, std::int32_t b,
                     SoftPhase phase, std::size_t group) {
  if (found.empty()) return;
  const bool both_move = a > 0 && b > 0;
  const std::int32_t any = std::max(a, b);
  if (!both_move && any > 0 && known(any).host != coupling_.self) return;  // its host alone solves it
  const bool waits = both_move && (phase == SoftPhase::kCorners || phase == SoftPhase::kGiants);
  const std::size_t first = placed_.size();
  for (SoftPatch& patch : found) {
    if (waits) {
      waiting_[static_cast<std::size_t>(phase)].push_back({known(a).id, known(b).id, touch.parts, a, b, &patch, 0});
    } else {
      placed_.push_back({&patch, a, b, phase, group});
    }
  }
  if (!both_move || phase != SoftPhase::kEdges || known(a).host == known(b).host) return;
  const bool a_is_ours = known(a).host == coupling_.self;
  Common& with = common_[static_cast<std::size_t>(phase)][known(a_is_ours ? b : a).host];
  with.ours.push_back(a_is_ours ? a : b);
  with.theirs.push_back(a_is_ours ? b : a);
  for (std::size_t i = first; i < placed_.size(); ++i) with.patches.push_back(i);
}

void SoftShared::settle() {
  for (ForeignPatch& foreign : foreign_patches_) {
    // A sleeper whose host has not found the contact is not told of.
    const auto a = foreign_.find(foreign.a), b = foreign_.find(foreign.b);
    if (a == foreign_.end() || b == foreign_.end() || !a->second.moves || !b->second.moves) continue;
    waiting_[static_cast<std::size_t>(foreign.phase)].push_back(
        {foreign.a, foreign.b, foreign.parts, a->second.mover, b->second.mover, &foreign.patch, 0});
  }
  settle(SoftPhase::kCorners);
  settle(SoftPhase::kGiants);
  order_rows(rows_, nullptr);
}

/// Finds which contacts hang together. Sets Waiting::chain.
std::vector<SoftShared::Chain> SoftShared::find_chains(std::span<Waiting> waiting) const {
  std::vector<std::int32_t> parents(known_.size());
  std::iota(parents.begin(), parents.end(), 0);
  const auto root = [&](std::int32_t mover) {
    while (parents[static_cast<std::size_t>(mover)] != mover) mover = parents[static_cast<std::size_t>(mover)];
    return mover;
  };
  for (const Waiting& w : waiting) {
    const std::int32_t a = root(w.mover_a), b = root(w.mover_b);
    parents[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  constexpr std::size_t kNone = ~std::size_t{0};
  std::vector<std::size_t> chain_of(known_.size(), kNone);  // by root
  std::vector<Chain> chains;
  for (Waiting& w : waiting) {
    std::size_t& number = chain_of[static_cast<std::size_t>(root(w.mover_a))];
    if (number == kNone) number = chains.size(), chains.emplace_back();
    w.chain = number;
    Chain& chain = chains[number];
    for (const std::int32_t mover : {w.mover_a, w.mover_b}) {
      chain.movers.push_back(mover);
      const core::RegionId host = known(mover).host;
      if (host == coupling_.self) {
        chain.is_ours = true;
      } else if (std::ranges::find(chain.hosts, host) == chain.hosts.end()) {
        chain.hosts.push_back(host);
      }
    }
  }
  return chains;
}

/// Contacts that hang together are solved by all regions that host a body of them, and by no other.
void SoftShared::settle(SoftPhase phase) {
  std::vector<Waiting>& waiting = waiting_[static_cast<std::size_t>(phase)];
  std::ranges::stable_sort(waiting, {}, [](const Waiting& w) {
    return std::tuple(std::max(w.a, w.b), std::min(w.a, w.b), w.a, w.parts.part0, w.parts.part1);
  });
  std::vector<Chain> chains = find_chains(waiting);
  for (const Waiting& w : waiting) {
    if (!chains[w.chain].is_ours) continue;
    chains[w.chain].patches.push_back(placed_.size());
    placed_.push_back({w.patch, w.mover_a, w.mover_b, phase, 0});  // one group: a chain may be anywhere
  }
  auto& all_common = common_[static_cast<std::size_t>(phase)];
  for (const Chain& chain : chains) {
    if (!chain.is_ours) continue;
    expect_all_to_meet(coupling_, chain.hosts);  // else one of them does not know the whole chain
    for (const core::RegionId host : chain.hosts) {
      Common& common = all_common[host];
      common.patches.insert(common.patches.end(), chain.patches.begin(), chain.patches.end());
      for (const std::int32_t mover : chain.movers) {
        if (known(mover).host == coupling_.self) common.ours.push_back(mover);
        if (known(mover).host == host) common.theirs.push_back(mover);
      }
    }
  }
  if (phase == SoftPhase::kCorners) note_corners(std::move(chains));
}

void SoftShared::note_corners(std::vector<Chain>&& chains) {
  around_corners_ = std::move(chains);
  for (const Chain& chain : around_corners_) {
    if (!chain.is_ours) continue;
    for (const std::int32_t mover : chain.movers) known_[static_cast<std::size_t>(mover)].around_corner = &chain;
  }
}

}  // namespace aurasim::physics
