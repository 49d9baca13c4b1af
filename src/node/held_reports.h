// Reports of states that are not confirmed yet. A redo may go back to before such a state; then the state is computed
// again, and reported once only. A state's hash is given out later still, because bodies that join up to K states later
// have made up that state, too.
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "node/step_report.h"

namespace aurasim::node {

class HeldReports {
 public:
  /// `redo`: states may be computed again. Without it, every report is given out at once. `lookahead`: K.
  HeldReports(bool redo, int lookahead) : redo_(redo), lookahead_(lookahead) {}

  /// Forgets the reports that have been given out. Call at the beginning of every step.
  void begin_step() { given_out_.clear(); }
  /// Adds the report of a step, or of a redo. After a redo the reports of later states are dropped.
  void add(StepReport report);
  /// Gives out the reports of states up to `confirmed`.
  void release(core::Step confirmed);
  /// Gives out one more report of state `last`, with what has joined it since, if there is any. Drops all others. Call
  /// after release(last).
  void finish(core::Step last);

  /// The reports given out since begin_step(), in order.
  std::span<const StepReport> given_out() const { return given_out_; }
  /// Reports up to this state have been given out; -1: none.
  core::Step released() const { return released_; }

 private:
  struct HeldHash {
    core::Step told_in = 0;     ///< state of the report that had it
    bool told_by_redo = false;  ///< a redo's report had it: bodies joined anew
    HashPart part;
  };

  void drop_after(core::Step step);
  void release_hashes(core::Step until, StepReport& report);

  bool redo_;
  int lookahead_;
  std::deque<StepReport> held_;
  std::vector<HeldHash> hashes_;  ///< of states that may get more parts
  core::Step released_ = -1;
  core::Step hashed_ = -1;  ///< hashes of states up to this one have been given out
  std::vector<StepReport> given_out_;
};

}  // namespace aurasim::node
