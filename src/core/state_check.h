// The check (docs/design.md, "Checked, and computed again"): was every pair of bodies that touched while a state was
// computed in one world? A node compares its own bodies with all published foreign bodies, state by state, as soon as
// all that there is to know about a state has arrived. It errs on the safe side: it may report a pair too many, none
// too few.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/aura.h"
#include "core/covered_columns.h"
#include "core/near_index.h"
#include "core/neighbour.h"
#include "core/redo.h"
#include "core/step_motion.h"
#include "core/used_room.h"
#include "core/vicinity.h"

namespace aurasim::core {

class InterestMatching;
class OwnBodies;

class StateCheck {
 public:
  /// Checks states from `start` on. Keeps references to `aura` and `vicinity`.
  StateCheck(const Aura& aura, const Vicinity& vicinity, Step start);

  /// Adds what a neighbour has published about the state received(), and about earlier ones.
  void take(const Neighbour& neighbour);
  /// Adds our bodies of a state, whether they were announced or not. A foreign body that left its path may have come to
  /// one that was not. The foreign one was announced, because it is outside of its region or near the border.
  void take_own(const Snapshot& snapshot, const InterestMatching& matching);
  /// Adds a state that one of our bodies has made up. Clusters that make up states together share a world, which has a
  /// number of its own.
  void take_made_up(const BodyState& body, Step step, std::uint32_t world);

  /// Adds states, up to the one in which the run stands, of bodies that join the neighbour later.
  void take_to_come(const Neighbour& neighbour, std::span<const AuraRecord> to_come);
  /// Checks all states up to `now`, in which the run stands. Call after take_to_come() for each live neighbour.
  void look_at_all(Step now);
  /// Checks all states for which everything has arrived, when state `now` is complete.
  void look(Step now, std::span<const Neighbour> neighbours);
  /// Pairs, a < b, that the last look() or look_at_all() found, each with the state in whose computation they may have
  /// touched.
  std::span<const Alarm> found() const { return found_; }
  /// The last state that has been looked at.
  Step checked() const { return checked_; }

 private:
  /// A body in a state, and the world in which that state was computed.
  struct Sighting {
    BodyId id{};
    std::uint32_t world = 0;
    Path path;
    bool born = true;  ///< false: it is only announced and nothing can touch it yet
  };
  struct State {
    Step step = 0;
    std::vector<Sighting> own;     ///< our bodies but for those that have not changed from this state on (noted_)
    std::vector<Sighting> others;  ///< bodies of other worlds
    double top_speed_squared = 0;  ///< of `own`
  };
  /// A sphere of `reach_m` around `middle` that holds all of a body throughout a step. Cheaper than a Motion, and
  /// larger.
  struct Way {
    const Sighting* now = nullptr;
    const Sighting* before = nullptr;  ///< a state earlier; null: its announcement has just begun
    Vec3 middle = Vec3::Zero();
    double reach_m = 0;
  };
  State& state(Step step);
  void take_changes(const OwnBodies& own, State& now);
  void take_all(const OwnBodies& own, State& now);
  void note(std::uint32_t i, const OwnBodies& own, State& now);
  void note_before(BodyId id, const Path& before, Step noted, Step now);
  void add_own(BodyId id, const Path& path, State& to) const;
  void compare_with_resting(const Way& other);
  void compare_guests();
  void add(const AuraRecord& aura, Step step, std::uint32_t world);
  void check(Step step);
  void forget();
  void free_spare_memory();
  template <class Visit>
  static void for_each_motion(const std::vector<Sighting>& bodies, const std::vector<Sighting>& same,
                              const std::vector<Sighting>& other, Visit&& visit);
  void gather_ways(const State& before, const State& after);
  void cover_others();
  double reach_at_most(const Path& end, double apart, double fastest) const;
  Way way(const Sighting& now, const Sighting* before) const;
  void compare_with_others(const Way& one, std::uint32_t from);
  bool touch(const Way& a, const Way& b) const;

  const Aura& aura_;
  const StepMotions motions_;
  const Vicinity& vicinity_;
  Step checked_;
  Step whole_;  ///< nothing is missing of states up to this one, in which the run stood
  std::deque<State> states_;
  const InterestMatching* matching_ = nullptr;  ///< that of the last take_own()
  std::vector<Step> noted_;                     ///< by body of ours: the last state in which it has changed
  std::vector<Step> noted_before_;              ///< memory for the next noted_
  State spare_;                                 ///< memory for the next one of states_
  UsedRoom used_room_;                          ///< of the lists of states_
  std::vector<Way> own_, others_;               ///< ways in the step that is being checked
  std::vector<Path> middles_;                   ///< middles of others_, indexed by near_
  NearIndex near_;
  CoveredColumns covered_;  ///< by others_; most of our bodies are far from all of them
  double margin_m_ = 0;     ///< bodies that are this near to each other may touch
  Step step_ = 0;           ///< the step that is being checked
  std::vector<Alarm> found_;
};

}  // namespace aurasim::core
