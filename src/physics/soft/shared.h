// The contacts between bodies of several coupled regions (physics/coupling.h), in a soft step.
//
// Both hosts of a contact across an edge of blocks find it, because each knows the other's body as a guest. Contacts
// around a corner of blocks, and those of giants, may form chains over more than two regions. So each region tells the
// others which of them it has found. In each sweep, regions exchange the movers of the bodies in such contacts before
// the phase in which these are solved, and all of them compute the same result.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "physics/coupling.h"
#include "physics/parcel.h"
#include "physics/soft/exchange.h"
#include "physics/soft/patches.h"
#include "physics/soft/seams.h"

class btRigidBody;

namespace aurasim::physics {

class SoftContacts;
class SoftIslands;

class SoftShared final : public SoftExchange {
 public:
  SoftShared(const Coupling& coupling, double block_m) : coupling_(coupling), block_m_(block_m) {}

  /// Tells the other regions which of the bodies that touch guests at their homes are in parts that stir, and learns
  /// the same of guests. Call between SoftIslands::find_parts() and SoftIslands::settle().
  void tell_stirs(SoftIslands& islands);
  /// Tells the hosts of sleepers whether what touched them is calm, and calls our own sleepers. Call after
  /// SoftIslands::rest().
  void call_sleepers(SoftIslands& islands);

  /// Tells the other regions which contacts were found and which bodies move, and learns the same of them. Guests then
  /// move if their hosts say so. `bodies`: all that are not static. Returns true if a guest is woken.
  bool meet(std::span<btRigidBody* const> bodies, SoftContacts& contacts, SoftIslands& islands);

  /// Appends an empty place to `held` (bodies by mover) for each body that is only known from contacts of others.
  void make_room(std::vector<btRigidBody*>& held);
  /// Fills the movers of these places.
  void take_in(soft::Mover* movers, std::vector<SoftInertia>& inertias) const;

  /// A patch, as SoftPatches::put() gets it.
  struct Placed {
    SoftPatch* patch;
    std::int32_t a, b;
    SoftPhase phase;
    std::size_t group;
  };

  void begin() { placed_.clear(); }
  /// Places the patches of a touch between two movers. Patches of phases with chains wait for settle().
  void add(const SoftTouch& touch, std::span<SoftPatch> found, std::int32_t a, std::int32_t b, SoftPhase phase,
           std::size_t group);
  /// Places the patches that wait, with those of other regions, in an order that follows from each group alone.
  void settle();
  std::span<const Placed> placed() const { return placed_; }
  /// Notes which contacts may bounce. Call after SoftPatches::build().
  void note_bounces(const SoftPatches& patches);

  void exchange(SoftPhase phase, bool bounces, soft::Mover* movers) override;

 private:
  /// A body of another region, as its host has told.
  struct Foreign {
    core::RegionId host{};
    bool moves = false;
    SoftInertia inertia;
    soft::Real v[3] = {}, w[3] = {};
    std::int32_t mover = 0;
  };
  struct ForeignPatch {
    core::BodyId a{}, b{};
    Parts parts;
    SoftPhase phase{};
    SoftPatch patch;
  };
  /// A patch that waits.
  struct Waiting {
    core::BodyId a{}, b{};
    Parts parts;
    std::int32_t mover_a = 0, mover_b = 0;
    SoftPatch* patch = nullptr;
  };
  /// The movers that two regions exchange before a phase, ascending by id of the body.
  struct Rows {
    std::vector<std::int32_t> ours, theirs;
    std::vector<std::size_t> patches;  ///< common contacts, by place in SoftPatches
    bool bounces = false;              ///< some of them may bounce
  };
  struct Known {
    core::BodyId id{};
    core::RegionId host{};
  };

  SoftPhase phase_of(const btRigidBody& a, const btRigidBody& b) const;
  /// The regions that have to know a contact of phase kCorners or kGiants.
  std::vector<core::RegionId> audience(const btRigidBody& body, SoftPhase phase) const;
  void read(core::RegionId from);
  const Known& known(std::int32_t mover) const { return known_[static_cast<std::size_t>(mover)]; }
  void settle(SoftPhase phase);

  Coupling coupling_;
  double block_m_;
  std::map<core::BodyId, Foreign> foreign_;
  std::vector<ForeignPatch> foreign_patches_;
  std::vector<Known> known_;  ///< by mover
  std::vector<Placed> placed_;
  std::array<std::vector<Waiting>, kSoftPhases> waiting_;
  std::array<std::map<core::RegionId, Rows>, kSoftPhases> rows_;
  ParcelWriter parcel_;
};

}  // namespace aurasim::physics
