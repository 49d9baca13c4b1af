// Words of nodes while the run stands in a state (docs/design.md, "A state in which the run stands"). Usually a state
// is checked when later states have brought all messages about it. While the run stands there are no later states, so
// the nodes say by words what is missing. Each word goes to all neighbours:
//   1: the states of bodies that have been handed over to the sender and join it later; not said if K = 1, where these
//      bodies join in the next state
//   2: the sender has checked the state, with word 1 of all its neighbours, and no pair has touched on two nodes
//   k: all nodes up to k - 2 hops from the sender have said word 2
// A node that has the word hops_across + 1 of all its neighbours knows that all nodes have checked the state.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/ids.h"
#include "core/intake.h"

namespace aurasim::core {

class Standing {
 public:
  /// `hops_across`: largest number of hops between two regions. `lookahead`: K.
  Standing(int hops_across, int lookahead)
      : last_word_(static_cast<std::uint32_t>(std::max(1, hops_across)) + 1), unsaid_(lookahead > 1 ? 0 : 1) {}

  void begin(Step state) {
    state_ = state;
    said_ = unsaid_;
  }
  /// The state in which the run stands, or last stood; -1: it has not stood yet.
  Step state() const { return state_; }
  /// Number of the last word that this node has said in the state.
  std::uint32_t said() const { return said_; }
  /// The number of the next word, which is said now.
  std::uint32_t say() { return ++said_; }

  /// Have all neighbours answered the last word, so that the next one may be said?
  bool may_say_more(const Intake& intake) const { return said_ < last_word_ && is_answered(intake); }
  /// Does this node know that all nodes have checked the state?
  bool is_checked_by_all(const Intake& intake) const { return said_ == last_word_ && is_answered(intake); }

 private:
  bool is_answered(const Intake& intake) const { return said_ == unsaid_ || intake.all_have_said(state_, said_); }

  std::uint32_t last_word_;
  std::uint32_t unsaid_;  ///< words up to this number are not said
  Step state_ = -1;
  std::uint32_t said_ = 0;
};

}  // namespace aurasim::core
