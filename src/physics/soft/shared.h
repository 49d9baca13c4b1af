// The contacts between bodies of several coupled regions (physics/coupling.h), in a soft step.
//
// Both hosts of a contact across an edge of blocks find it, because each knows the other's body as a guest. Contacts
// around a corner of blocks, and those of giants, may form chains over more than two regions. So each region tells the
// others which of them it has found. In each sweep, regions exchange the movers of the bodies in such contacts, and all
// of them compute the same result. A mover is sent as early in the sweep as it is final, so that most sweeps need one
// message.
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

  /// Names the regions that may have contacts in common with this one in the step. No other region is told of contacts.
  void expect(std::span<const core::RegionId> regions) { peers_.assign(regions.begin(), regions.end()); }

  /// Tells the other regions which of the bodies that touch guests at their homes are in parts that stir, and learns
  /// the same of guests. Call between SoftIslands::find_parts() and SoftIslands::settle().
  void tell_stirs(SoftIslands& islands);
  /// Tells the hosts of sleepers whether what touched them is calm, and calls our own sleepers. Call after
  /// SoftIslands::rest().
  void call_sleepers(SoftIslands& islands);

  /// Tells the other regions which contacts were found and which bodies move, and learns the same of them. Guests then
  /// move if their hosts say so. Returns true if a guest is woken.
  bool meet(SoftContacts& contacts, SoftIslands& islands);

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
    std::uint8_t elsewhere = 0;
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
  /// Contacts of a phase that hang together.
  struct Chain {
    std::vector<std::int32_t> movers;
    std::vector<std::size_t> patches;   ///< by place in SoftPatches
    std::vector<core::RegionId> hosts;  ///< of the movers, but this region
    bool is_ours = false;               ///< some of the bodies are ours
  };
  /// A patch that waits.
  struct Waiting {
    core::BodyId a{}, b{};
    Parts parts;
    std::int32_t mover_a = 0, mover_b = 0;
    SoftPatch* patch = nullptr;
    std::size_t chain = 0;
  };
  /// The bodies in common contacts with another region.
  struct Common {
    std::vector<std::int32_t> ours, theirs;  ///< movers; some are there more than once
    std::vector<std::size_t> patches;        ///< by place in SoftPatches
  };
  /// The movers that are sent to another region and received from it, ascending by id of the body.
  struct Rows {
    std::vector<std::int32_t> ours, theirs;
  };
  /// By phase, and by the other region.
  template <class Each>
  using ByPhase = std::array<std::map<core::RegionId, Each>, kSoftPhases>;
  /// The phases in which a body has contacts, as bits, and the host of those that it touches across its edge.
  struct Touched {
    std::uint8_t phases = 0;
    core::RegionId across{};
  };
  struct Known {
    core::BodyId id{};
    core::RegionId host{};
    Touched touched;                       ///< of own bodies
    std::uint8_t elsewhere = 0;            ///< of bodies of other regions: what their host has told
    const Chain* around_corner = nullptr;  ///< if we solve it: the chain of phase kCorners that the body is in
  };

  bool is_expected(core::RegionId region) const;
  SoftPhase phase_of(const btRigidBody& a, const btRigidBody& b) const;
  /// The regions that have to know a contact of phase kCorners or kGiants.
  std::vector<core::RegionId> audience(const btRigidBody& body, SoftPhase phase) const;
  void read(core::RegionId from);
  const Known& known(std::int32_t mover) const { return known_[static_cast<std::size_t>(mover)]; }
  void settle(SoftPhase phase);
  std::vector<Chain> find_chains(std::span<Waiting> waiting) const;
  void note_corners(std::vector<Chain>&& chains);
  /// The host of a body tells another region this: the phases, as bits, in which the other may not solve all contacts
  /// of the body.
  static std::uint8_t elsewhere(const Touched& touched, core::RegionId other);
  /// The phase before which the mover of a body in a common contact of `phase` with another region is sent: the first
  /// after which the other region knows it until then.
  SoftPhase sent_before(SoftPhase phase, const Known& body, core::RegionId other) const;
  /// Lists the movers of common contacts by the phase before which they are sent. `bouncing`: only those of contacts
  /// that may bounce; null: all.
  void order_rows(ByPhase<Rows>& rows, const SoftPatches* bouncing) const;

  Coupling coupling_;
  double block_m_;
  std::vector<core::RegionId> peers_;  ///< those of expect()
  std::map<core::BodyId, Foreign> foreign_;
  std::vector<ForeignPatch> foreign_patches_;
  std::vector<Touched> touched_;              ///< by slot in SoftIslands
  std::vector<std::uint32_t> touched_slots_;  ///< those that are not empty
  std::vector<Known> known_;                  ///< by mover
  std::vector<Placed> placed_;
  std::array<std::vector<Waiting>, kSoftPhases> waiting_;
  std::vector<Chain> around_corners_;
  ByPhase<Common> common_;
  ByPhase<Rows> rows_, bouncing_rows_;
  ParcelWriter parcel_;
};

}  // namespace aurasim::physics
