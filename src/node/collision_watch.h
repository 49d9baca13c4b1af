// Late and missed collisions (docs/design.md, "What is counted"), as one node can see them. A collision is late when
// two bodies come to one host, and in the first states that it computes of both they already overlap by more than one
// step of their relative speed, with or without a contact. It is missed when two bodies of different hosts overlap in
// the same state.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/clearance.h"
#include "core/ids.h"
#include "core/intake.h"
#include "core/interest_matching.h"
#include "physics/region_world.h"

namespace aurasim::node {

struct SeenCollision {
  physics::Collision collision;
  bool late = false;
  bool missed = false;
  bool flagged = false;  ///< a violation before it may explain it
};

struct CollisionCounts {
  std::uint64_t late = 0;
  std::uint64_t missed = 0;
  std::uint64_t unflagged = 0;  ///< late and missed collisions that no violation explains
};

class CollisionWatch {
 public:
  CollisionWatch(double step_s, double gravity_m_s2, int lookahead, const core::ClearanceQuery& clearance)
      : step_s_(step_s), gravity_m_s2_(gravity_m_s2), lookahead_(lookahead), clearance_(clearance) {}

  /// Notes a body that has just been born. Its first overlaps are not counted, because the scene placed it there.
  void newborn(core::BodyId body, core::Step birth);

  /// A cluster has joined for the state that is being computed.
  void join(const core::Adoption& adoption);

  /// Judges the first contacts of a step. `last_violation` is the newest step with a broken promise.
  void judge(std::span<const physics::Collision> first_contacts, core::Step last_violation,
             std::vector<SeenCollision>& out);

  /// Judges overlaps without a contact of the bodies that have joined. Bullet makes no contact between two sleeping
  /// bodies. Without this check the overlap would show only when something wakes them, long after the broken promise
  /// that caused it.
  void judge_arrivals(const core::Snapshot& snapshot, const core::InterestMatching& matching, core::Step last_violation,
                      std::vector<SeenCollision>& out);

  /// Compares foreign auras with where our own bodies were in the auras' states.
  void compare(const core::Snapshot& snapshot, const core::InterestMatching& matching, core::Step last_violation,
               std::vector<SeenCollision>& out);

  std::uint64_t late() const { return counts_.late; }
  std::uint64_t missed() const { return counts_.missed; }
  std::uint64_t unflagged() const { return counts_.unflagged; }
  const CollisionCounts& counts() const { return counts_; }
  /// Called when the run goes back to a cut: restores the counts of that cut.
  void put_back(const CollisionCounts& counts);

 private:
  using Pair = std::pair<core::BodyId, core::BodyId>;  ///< ascending

  /// A body that joined for this state, and where and when it was last in a world.
  struct Joined {
    core::BodyId id;
    core::RegionId source;
    core::Step stamp;
  };
  struct Remembered {
    core::BodyId id;
    core::Pose pose;
  };
  struct State {
    core::Step step;
    std::vector<Remembered> bodies;  ///< those near foreign auras, ascending id
  };

  void sort_joined();
  bool met_here(const physics::Collision& c) const;
  bool is_late(const physics::Collision& c) const;
  bool was_just_born(const physics::Collision& c) const;
  bool flagged(core::Step step, core::Step last_violation) const;
  const core::Pose* remembered(core::Step step, core::BodyId id) const;
  static const Joined* find(const std::vector<Joined>& joined, core::BodyId id);
  static bool came_together(const Pair& pair, const std::vector<Joined>& joined);
  void forget_parted(const core::OwnBodies& own);
  void forget_grown_up(core::Step now);
  void forget_separated(core::Step now);
  std::optional<SeenCollision> overlap_of(std::uint32_t i, std::uint32_t j, const core::Snapshot& snapshot,
                                          const core::InterestMatching& matching) const;
  void report(SeenCollision seen, core::Step last_violation, std::vector<SeenCollision>& out);
  void remember(const core::Snapshot& snapshot, const core::InterestMatching& matching);

  double step_s_;
  double gravity_m_s2_;
  int lookahead_;
  const core::ClearanceQuery& clearance_;
  std::vector<std::pair<core::BodyId, core::Step>> births_;  ///< bodies that are young or not born yet, ascending id
  std::deque<State> states_;
  std::map<Pair, core::Step> overlapping_;  ///< pairs counted as missed, with the newest state in which they overlapped
  std::vector<Joined> joined_;              ///< joined for the state being computed; ascending id from judge() on
  std::vector<Joined> joined_before_;       ///< joined for the state before
  std::set<Pair> untouching_;  ///< pairs that overlap without a contact; their contact is already judged when it comes
  CollisionCounts counts_;
};

}  // namespace aurasim::node
