// The life of a node process: which phase follows which, and what the others are told meanwhile.
#include "process/node_phase.h"

#include <set>

#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using E = NodeEvent;
using P = NodePhase;

/// Every event in turn; fails where one cannot happen.
P after(std::initializer_list<E> events) {
  P phase = P::kListening;
  for (const E event : events) {
    const auto next = next_phase(phase, event);
    EXPECT_TRUE(next) << name_of(event) << " while " << name_of(phase);
    if (!next) return phase;
    phase = *next;
  }
  return phase;
}

TEST(NodePhases, ARunFromItsFirstWordToItsLast) {
  EXPECT_EQ(after({E::kFree, E::kMet, E::kStarted}), P::kRunning);
  EXPECT_EQ(after({E::kFree, E::kMet, E::kStarted, E::kLast, E::kSettled}), P::kDone);
}

TEST(NodePhases, PauseStepResumeAndReset) {
  EXPECT_EQ(after({E::kFree, E::kMet, E::kStarted, E::kHeld}), P::kPaused);
  EXPECT_EQ(after({E::kFree, E::kMet, E::kStarted, E::kHeld, E::kGoesOn, E::kHeld}), P::kPaused);
  EXPECT_EQ(after({E::kFree, E::kMet, E::kStarted, E::kHeld, E::kReset}), P::kRunning);
  EXPECT_EQ(after({E::kFree, E::kMet, E::kStarted, E::kHeld, E::kLast}), P::kLingering);
}

TEST(NodePhases, NewRegionsAreTwoChangesWithAStartEach) {
  EXPECT_EQ(after({E::kFree, E::kMet, E::kStarted, E::kChanges, E::kChanges, E::kStands, E::kStarted, E::kChanges,
                   E::kStands, E::kStarted}),
            P::kRunning);
}

TEST(NodePhases, WhoHasNotBegunMayBeRefusedAndEndsWithoutLingering) {
  EXPECT_EQ(after({E::kRefusal}), P::kRefused);
  EXPECT_EQ(after({E::kFree, E::kRefusal}), P::kRefused);
  EXPECT_EQ(after({E::kFree, E::kMet, E::kRefusal}), P::kRefused);
  EXPECT_EQ(after({E::kFree, E::kMet, E::kLast}), P::kDone);
}

TEST(NodePhases, ADeathLetsAllStandAndBeginAgainWhateverTheyDid) {
  EXPECT_EQ(after({E::kFree, E::kMet, E::kStarted, E::kDeath, E::kStands, E::kStarted}), P::kRunning);
  EXPECT_EQ(after({E::kFree, E::kMet, E::kStarted, E::kDeath, E::kStands, E::kDeath, E::kStands, E::kStarted}),
            P::kRunning)
      << "one more has died before they began";
  EXPECT_EQ(after({E::kFree, E::kMet, E::kStarted, E::kChanges, E::kDeath}), P::kRecovering);
  EXPECT_EQ(after({E::kFree, E::kMet, E::kStarted, E::kLast, E::kDeath}), P::kRecovering) << "not all had ended";
  EXPECT_FALSE(next_phase(P::kRecovering, E::kGoesOn)) << "nobody goes on without the dead";
  EXPECT_EQ(after({E::kJoins, E::kJoins, E::kStands, E::kStarted}), P::kRunning) << "who takes its region over";
}

TEST(NodePhases, OnlyWhoHasARegionOfARunIsFenced) {
  for (std::size_t i = 0; i < kNodePhases; ++i) {
    const auto phase = static_cast<P>(i);
    const bool runs = phase == P::kRunning || phase == P::kPaused || phase == P::kRecovering || phase == P::kSpare ||
                      phase == P::kWaiting || phase == P::kChanging;
    EXPECT_EQ(next_phase(phase, E::kFence).has_value(), runs) << name_of(phase);
  }
}

TEST(NodePhases, AnEndIsAnEnd) {
  for (const P phase : {P::kDone, P::kRefused, P::kFenced}) {
    for (std::size_t e = 0; e < kNodeEvents; ++e) EXPECT_FALSE(next_phase(phase, static_cast<E>(e))) << name_of(phase);
  }
}

TEST(NodePhases, EveryOneIsReachedAndHasAWayOut) {
  std::set<P> reached = {P::kListening};
  for (std::size_t round = 0; round < kNodePhases; ++round) {
    for (const P phase : std::set<P>(reached)) {
      for (std::size_t e = 0; e < kNodeEvents; ++e) {
        if (const auto next = next_phase(phase, static_cast<E>(e))) reached.insert(*next);
      }
    }
  }
  EXPECT_EQ(reached.size(), kNodePhases);
}

TEST(NodePhases, AreToldAsTheStateOfTheNode) {
  EXPECT_FALSE(state_of(P::kListening)) << "a node's word would disturb a run that is already here";
  EXPECT_EQ(state_of(P::kMeeting), messages::NodeState::kStarting);
  EXPECT_EQ(state_of(P::kChanging), messages::NodeState::kPaused);
  EXPECT_EQ(state_of(P::kLingering), messages::NodeState::kFinished);
  EXPECT_EQ(state_of(P::kFenced), messages::NodeState::kFailed);
}

}  // namespace
}  // namespace aurasim::process
