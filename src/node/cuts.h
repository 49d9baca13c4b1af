// The states that a node keeps of itself: cuts, to go back to when the run is computed again, and the parts of the
// world that have been asked for (docs/design.md, "The cut").
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/intake.h"
#include "core/redo.h"
#include "node/births.h"
#include "node/collision_watch.h"

namespace aurasim::node {

/// A node's part of a consistent cut through the run, from which it can go back to the state.
struct Cut {
  core::Step step = 0;
  core::ChangedState bodies;            ///< hosted here; those that left in this state are taken out
  std::vector<core::Adoption> joining;  ///< clusters sent here in this state or before that have not joined yet
  ToBeBorn to_be_born;                  ///< also with the spawn orders received after the cut
  CollisionCounts collisions;

  /// Adds a cluster that joins this node now, if it had been sent in the cut's state or before.
  void note_arrival(const core::Adoption& adoption);
};

/// Cuts to go back to, ascending.
class Cuts {
 public:
  /// `lookahead`: K.
  explicit Cuts(int lookahead) : lookahead_(lookahead) {}

  void keep(Cut cut);
  void clear();
  /// Memory of the bodies of a dropped cut, for the next one. Its contents mean nothing.
  core::ChangedState take_memory();
  bool empty() const { return cuts_.empty(); }
  /// Precondition: not empty.
  core::Step oldest() const { return cuts_.front().step; }
  void note_arrival(const core::Adoption& adoption);
  void note_spawn(const core::Order& order);

  /// Drops the cuts to which no redo can go back any more. Of those that are only needed for a pair that a redo has not
  /// brought together, one every kBetweenOlderCuts states stays. All nodes go back to the same state, so no node may
  /// drop its cut before all have confirmed later states. The cut before the one that the next redo needs stays, too.
  /// `alarms_given_up`: no alarm leads to a redo any more, so one may stand for ever. Precondition: not empty.
  void forget(core::Step confirmed, bool alarms_given_up);
  /// The redo that brings the pairs of the alarms to one host. `together`: pairs that share a host already. If one of
  /// them has raised the first alarm, the redo goes back farther than the last one. Preconditions: not empty, and
  /// `alarms` is not.
  core::Redo plan(std::span<const core::Alarm> alarms, std::vector<core::TogetherPair> together);
  /// True if the last plan() was for a pair that an earlier redo has not brought together.
  bool is_stubborn() const { return stubborn_ > 0; }
  /// Drops the cuts after state `step` and returns the one of that state. Throws std::logic_error if there is none.
  Cut& back_to(core::Step step);

 private:
  const Cut& before(core::Step touch, std::size_t farther) const;
  void drop(Cut& cut);

  int lookahead_;
  std::deque<Cut> cuts_;
  std::vector<core::ChangedState> memory_;
  std::size_t stubborn_ = 0;  ///< number of redos in a row that have not brought a pair together
};

/// The states of which this node's part of the world has been asked for, and the state in which the run ends.
class SavedStates {
 public:
  /// Asks for the part of a later state.
  void ask(core::Step step) { states_.push_back({step, {}, false, false}); }
  /// Keeps state `last`, because the run may end after it. Of several such states the earliest counts.
  void end_with(core::Step last);
  std::optional<core::Step> end() const;
  /// The cut of the end, if the run ends in `last` and that state has been computed; null otherwise.
  const Cut* end_cut(core::Step last) const;
  void forget_end();

  /// Keeps a cut of state `step`, made by `cut`, for all who have asked for it.
  void take(core::Step step, const std::function<Cut()>& cut);
  void note_arrival(const core::Adoption& adoption);
  void note_spawn(const core::Order& order);
  /// Notes which of the states are whole. `is_whole(step)`: every cluster that was under way in that state has arrived.
  void note_whole(const std::function<bool(core::Step)>& is_whole);
  /// To be called when the run goes back to state `step`. Later states will be kept anew, but for those up to
  /// `confirmed`, of which every node gives out its part as it was.
  void put_back(core::Step step, core::Step confirmed);
  /// Takes the whole states up to `confirmed` that have been asked for.
  std::vector<Cut> take_whole(core::Step confirmed);

 private:
  struct State {
    core::Step step = 0;
    std::optional<Cut> cut;
    bool is_whole = false;
    bool is_the_end = false;  ///< take_whole() leaves it
    bool is_confirmed = false;
  };
  std::vector<State> states_;
};

}  // namespace aurasim::node
