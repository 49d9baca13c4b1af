// The phases of a node process from joining the domain to its end, as a state machine, and the events that change the
// phase. The state that the node publishes (dds::NodeState) follows from the phase.
#pragma once

#include <cstdint>
#include <optional>

#include "dds/control.h"

namespace aurasim::process {

enum class NodePhase : std::uint8_t {
  kListening,   ///< has joined the domain and publishes nothing yet; finds out whether the domain is free
  kMeeting,     ///< has published its status and waits for its neighbours
  kWaiting,     ///< is ready and waits for the start command of region 0
  kRunning,     ///< computes, or waits for what the next state needs
  kPaused,      ///< waits in a state for a command to go on
  kChanging,    ///< waits until all nodes do: the run gets another scene or other regions
  kLingering,   ///< has computed its last state; the others may still need what it has published
  kDone,        ///< has ended well
  kRefused,     ///< could not begin or go on: another run is in the domain, or a node is missing
  kFenced,      ///< the others may go on without it (fence.h), or the run ends because another node has died
  kRecovering,  ///< a node has died: waits until all go back to a state that is kept
  kSpare,       ///< has no world yet and waits to take a region over
};
inline constexpr std::size_t kNodePhases = 12;

enum class NodeEvent : std::uint8_t {
  kFree,     ///< no other run is in the domain
  kMet,      ///< all endpoints of all neighbours are matched
  kStarted,  ///< region 0 has named the first step's time
  kHeld,     ///< the state of a pause has been computed
  kGoesOn,   ///< a resume or step command has come
  kChanges,  ///< the state of a change has been computed
  kStands,   ///< all nodes wait in the state of a change; the new world begins with another start command
  kReset,    ///< the run begins again from state 0
  kLast,     ///< the last state has been computed, or the process is asked to stop
  kSettled,  ///< no other node needs anything of this one any more
  kRefusal,
  kFence,  ///< the fence has closed: into kFenced
  kDeath,  ///< a node of the run has died
  kJoins,  ///< this process joins a run that has lost a node
};
inline constexpr std::size_t kNodeEvents = 14;

/// The phase after `event`. Nothing if the event cannot happen in this phase.
std::optional<NodePhase> next_phase(NodePhase phase, NodeEvent event);

/// The state in the node's status. Nothing in phase kListening.
std::optional<messages::NodeState> state_of(NodePhase phase);

const char* name_of(NodePhase phase);
const char* name_of(NodeEvent event);

}  // namespace aurasim::process
