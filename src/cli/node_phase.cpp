#include "cli/node_phase.h"

#include <array>

namespace aurasim::cli {
namespace {

using P = NodePhase;

/// "Stays impossible" in the table below.
constexpr std::optional<NodePhase> no = std::nullopt;

using Row = std::array<std::optional<NodePhase>, kNodeEvents>;

// clang-format off
constexpr std::array<Row, kNodePhases> kTable = {{
    //             free         met          started      held        goes on      changes       stands       reset        last          settled   refusal      fence
    /* listening */ {P::kMeeting, no,          no,          no,         no,          no,           no,          no,          P::kDone,      no,       P::kRefused, no},
    /* meeting   */ {no,          P::kWaiting, no,          no,         no,          no,           no,          no,          P::kDone,      no,       P::kRefused, no},
    /* waiting   */ {no,          no,          P::kRunning, no,         no,          no,           no,          no,          P::kDone,      no,       P::kRefused, no},
    /* running   */ {no,          no,          no,          P::kPaused, P::kRunning, P::kChanging, no,          P::kRunning, P::kLingering, no,       no,          P::kFenced},
    /* paused    */ {no,          no,          no,          P::kPaused, P::kRunning, P::kChanging, no,          P::kRunning, P::kLingering, no,       no,          P::kFenced},
    /* changing  */ {no,          no,          no,          no,         no,          P::kChanging, P::kWaiting, no,          no,            no,       P::kRefused, no},
    /* lingering */ {no,          no,          no,          no,         no,          no,           no,          no,          no,            P::kDone, no,          no},
    /* done      */ {},
    /* refused   */ {},
    /* fenced    */ {},
}};
// clang-format on

}  // namespace

std::optional<NodePhase> next_phase(NodePhase phase, NodeEvent event) {
  return kTable.at(static_cast<std::size_t>(phase)).at(static_cast<std::size_t>(event));
}

std::optional<dds::NodeState> state_of(NodePhase phase) {
  switch (phase) {
    case NodePhase::kListening:
      return {};
    case NodePhase::kMeeting:
      return dds::NodeState::kStarting;
    case NodePhase::kWaiting:
      return dds::NodeState::kWaiting;
    case NodePhase::kRunning:
      return dds::NodeState::kRunning;
    case NodePhase::kPaused:
    case NodePhase::kChanging:
      return dds::NodeState::kPaused;
    case NodePhase::kLingering:
    case NodePhase::kDone:
      return dds::NodeState::kFinished;
    case NodePhase::kRefused:
    case NodePhase::kFenced:
      return dds::NodeState::kFailed;
  }
  return {};
}

const char* name_of(NodePhase phase) {
  static constexpr std::array<const char*, kNodePhases> kNames = {
      "listening", "meeting", "waiting", "running", "paused", "changing", "lingering", "done", "refused", "fenced"};
  return kNames.at(static_cast<std::size_t>(phase));
}

const char* name_of(NodeEvent event) {
  static constexpr std::array<const char*, kNodeEvents> kNames = {
      "free", "met", "started", "held", "goes on", "changes", "stands", "reset", "last", "settled", "refusal", "fence"};
  return kNames.at(static_cast<std::size_t>(event));
}

}  // namespace aurasim::cli
