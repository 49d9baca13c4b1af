#include "process/node_phase.h"

#include <array>

namespace aurasim::process {
namespace {

using P = NodePhase;

/// An event that is impossible in a phase, in the table below.
constexpr std::optional<NodePhase> no = std::nullopt;

using Row = std::array<std::optional<NodePhase>, kNodeEvents>;

// clang-format off
constexpr std::array<Row, kNodePhases> kTable = {{
    //               free         met          started      held        goes on      changes       stands       reset        last          settled   refusal      fence       death           joins
    /* listening  */ {P::kMeeting, no,          no,          no,         no,          no,           no,          no,          P::kDone,      no,       P::kRefused, no,         no,             P::kSpare},
    /* meeting    */ {no,          P::kWaiting, no,          no,         no,          no,           no,          no,          P::kDone,      no,       P::kRefused, no,         no,             no},
    /* waiting    */ {no,          no,          P::kRunning, no,         no,          no,           no,          no,          P::kDone,      no,       P::kRefused, P::kFenced, P::kRecovering, P::kSpare},
    /* running    */ {no,          no,          no,          P::kPaused, P::kRunning, P::kChanging, no,          P::kRunning, P::kLingering, no,       no,          P::kFenced, P::kRecovering, no},
    /* paused     */ {no,          no,          no,          P::kPaused, P::kRunning, P::kChanging, no,          P::kRunning, P::kLingering, no,       no,          P::kFenced, P::kRecovering, no},
    /* changing   */ {no,          no,          no,          no,         no,          P::kChanging, P::kWaiting, no,          no,            no,       P::kRefused, P::kFenced, P::kRecovering, P::kSpare},
    /* lingering  */ {no,          no,          no,          no,         no,          no,           no,          no,          no,            P::kDone, no,          no,         P::kRecovering, no},
    /* done       */ {},
    /* refused    */ {},
    /* fenced     */ {},
    /* recovering */ {no,          no,          no,          no,         no,          no,           P::kWaiting, no,          P::kLingering, no,       P::kRefused, P::kFenced, P::kRecovering, no},
    /* spare      */ {no,          no,          no,          no,         no,          no,           P::kWaiting, no,          P::kDone,      no,       P::kRefused, P::kFenced, no,             P::kSpare},
}};
// clang-format on

}  // namespace

std::optional<NodePhase> next_phase(NodePhase phase, NodeEvent event) {
  return kTable.at(static_cast<std::size_t>(phase)).at(static_cast<std::size_t>(event));
}

std::optional<messages::NodeState> state_of(NodePhase phase) {
  switch (phase) {
    case NodePhase::kListening:
      return {};
    case NodePhase::kMeeting:
      return messages::NodeState::kStarting;
    case NodePhase::kWaiting:
      return messages::NodeState::kWaiting;
    case NodePhase::kRunning:
      return messages::NodeState::kRunning;
    case NodePhase::kPaused:
    case NodePhase::kChanging:
      return messages::NodeState::kPaused;
    case NodePhase::kLingering:
    case NodePhase::kDone:
      return messages::NodeState::kFinished;
    case NodePhase::kRefused:
    case NodePhase::kFenced:
      return messages::NodeState::kFailed;
    case NodePhase::kRecovering:
      return messages::NodeState::kRecovering;
    case NodePhase::kSpare:
      return messages::NodeState::kSpare;
  }
  return {};
}

const char* name_of(NodePhase phase) {
  static constexpr std::array<const char*, kNodePhases> kNames = {"listening", "meeting",  "waiting",    "running",
                                                                  "paused",    "changing", "lingering",  "done",
                                                                  "refused",   "fenced",   "recovering", "spare"};
  return kNames.at(static_cast<std::size_t>(phase));
}

const char* name_of(NodeEvent event) {
  static constexpr std::array<const char*, kNodeEvents> kNames = {"free",    "met",    "started", "held", "goes on",
                                                                  "changes", "stands", "reset",   "last", "settled",
                                                                  "refusal", "fence",  "death",   "joins"};
  return kNames.at(static_cast<std::size_t>(event));
}

}  // namespace aurasim::process
