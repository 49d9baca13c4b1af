// What a node process does, from joining the domain to its end: a state machine of phases and what moves it on. What
// the others are told (dds::NodeState) follows from the phase.
#pragma once

#include <cstdint>
#include <optional>

#include "dds/control.h"

namespace aurasim::cli {

enum class NodePhase : std::uint8_t {
  kListening,   ///< has joined the domain and says nothing yet: is it free?
  kMeeting,     ///< has published who it is and waits for its neighbours
  kWaiting,     ///< is ready for the start, which region 0 gives
  kRunning,     ///< computes, or waits for what the next state needs
  kPaused,      ///< stands in a state until it is told to go on
  kChanging,    ///< stands until all do: the run gets another scene or other regions
  kLingering,   ///< has computed its last state; the others may still need what it has published
  kDone,        ///< has ended well
  kRefused,     ///< could not begin, or not go on: another run is here, or somebody is missing
  kFenced,      ///< the others may go on without it (fence.h), or the run ends because another node has died
  kRecovering,  ///< a node has died: stands until all go back to a state that is kept
  kSpare,       ///< has no world yet: waits to take a region over
};
inline constexpr std::size_t kNodePhases = 12;

enum class NodeEvent : std::uint8_t {
  kFree,     ///< nobody else is in the domain
  kMet,      ///< all endpoints of all neighbours are matched
  kStarted,  ///< region 0 has named the first step's time
  kHeld,     ///< the state of a pause has been computed
  kGoesOn,   ///< resume or step
  kChanges,  ///< the state of a change has been computed
  kStands,   ///< so have all others: what is new begins with another start
  kReset,    ///< all over again, from state 0
  kLast,     ///< the last state has been computed, or somebody asks the process to stop
  kSettled,  ///< nobody needs anything of it any more
  kRefusal,
  kFence,  ///< into kFenced
  kDeath,  ///< a node of the run has died
  kJoins,  ///< a run that has lost a node
};
inline constexpr std::size_t kNodeEvents = 14;

/// Nothing: that cannot happen in this phase.
std::optional<NodePhase> next_phase(NodePhase phase, NodeEvent event);

/// What its status says. Nothing while it only listens.
std::optional<dds::NodeState> state_of(NodePhase phase);

const char* name_of(NodePhase phase);
const char* name_of(NodeEvent event);

}  // namespace aurasim::cli
