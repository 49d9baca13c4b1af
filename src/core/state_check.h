// The check (docs/design.md, "Checked, and computed again"): has every pair of bodies that touched while a state was
// computed been in one world? A node looks at its own bodies and at all that it has been told of those of others, in
// the states that they were in, K states late. Errs to one side: a pair too many is named, none too few.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/aura.h"
#include "core/near_index.h"
#include "core/neighbour.h"
#include "core/redo.h"
#include "core/vicinity.h"

namespace aurasim::core {

class InterestMatching;

class StateCheck {
 public:
  /// States from `start` on. Keeps references.
  StateCheck(const Aura& aura, const Vicinity& vicinity, Step start);

  /// What a neighbour has published of the state applied(), and of earlier ones.
  void take(const Neighbour& neighbour);
  /// Our bodies in a state, those that others have to know of.
  void take_own(const Snapshot& snapshot, const InterestMatching& matching);
  /// A state that one of ours has made up alone, as the `nth` cluster that has joined: it was in no world with others.
  void take_made_up(const BodyState& body, Step step, std::uint32_t nth);

  /// Looks at all states that everything is known of, when state `now` is complete.
  void look(Step now, std::span<const Neighbour> neighbours);
  /// Pairs found by the last look(), a < b, with the state in whose computation they may have touched.
  std::span<const Alarm> found() const { return found_; }
  /// The last state that has been looked at.
  Step checked() const { return checked_; }

 private:
  /// A body in a state, and the world in which that state was computed.
  struct Sighting {
    BodyId id{};
    std::uint32_t world = 0;
    Path path;
    bool born = true;  ///< false: it is only announced, and nothing can touch it yet
  };
  struct State {
    Step step = 0;
    std::vector<Sighting> own;
    std::vector<Sighting> others;  ///< of other worlds
  };
  /// Where a body has been during a step: within `reach_m` of `middle`, with all that belongs to it. Cheaper than a
  /// Motion, and larger.
  struct Way {
    const Sighting* now = nullptr;
    const Sighting* before = nullptr;  ///< a state ago; none: it has only just begun to be announced
    Vec3 middle = Vec3::Zero();
    double reach_m = 0;
  };
  /// A body on its way through one step.
  struct Motion {
    Path at_start, at_end;
    double stray_m = 0;  ///< its surface may be this far off the straight way in between
  };

  State& state(Step step);
  void add(const AuraRecord& aura, Step step, std::uint32_t world);
  void check(Step step);
  void gather_ways(const State& before, const State& after);
  Way way(const Sighting& now, const Sighting* before) const;
  void compare_with_others(const Way& one, std::uint32_t from, double margin_m);
  Motion motion(const Sighting& now, const Sighting* before) const;
  bool touch(const Motion& a, const Motion& b) const;
  bool meet_ahead(const Motion& a, const Motion& b, double allowed_m) const;
  bool meet_on(const Pose& a, const Pose& b, const Motion& of_a, const Motion& of_b, const Vec3& way,
               double allowed_m) const;
  bool sweeps_into(const Motion& moving, const Motion& other, double share, double allowed_m) const;
  Pose pose(const Motion& motion, double share) const;

  const Aura& aura_;
  const Vicinity& vicinity_;
  Step checked_;
  std::deque<State> states_;
  std::vector<Way> own_, others_;  ///< in the step that is looked at
  std::vector<Path> middles_;      ///< of others_, for finding who is near
  NearIndex near_;
  Step step_ = 0;  ///< that is looked at
  std::vector<Alarm> found_;
};

}  // namespace aurasim::core
