// Which parts of the world this node keeps and who keeps its own; and the request to go back to a kept state.
#include <chrono>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "process/keepers.h"
#include "process/node_process.h"
#include "process/step_back.h"

namespace aurasim::process {
namespace {

constexpr std::chrono::nanoseconds kNoticeOfStepBack{600'000'000};  // time in which all nodes receive the command

}  // namespace

/// Keeps what the node has completed, and replies to clients.
void NodeProcess::keep_parts() {
  saving_.keep_parts(*node_, endpoints_.commands(), checkpoints(), records_.recorder());
  saving_.hear(control().statuses());
  saving_.reply(endpoints_.commands());
  note_words_of_saves();
}

/// The last message about saves goes into the status.
void NodeProcess::note_words_of_saves() {
  for (std::string& words : saving_.take_words()) notices_.note_news(std::move(words));
}

/// Finishes all saves at the end of the run.
void NodeProcess::conclude_saves() {
  saving_.conclude(endpoints_.commands(), control().statuses(), !fence_.closed() && has_reached_the_end());
  note_words_of_saves();
}

/// Handles the request "step back". All nodes go back to the newest state that all have in memory, or that the lead
/// finds in its folder. It lies at least half the distance of two kept states back.
void NodeProcess::step_back(const RunView& run) {
  const std::optional<core::Command> back = endpoints_.commands().take_wanted_back();
  if (!back) return;
  const core::Step latest = node_->current_step() - (launch_.checkpoint_steps() + 1) / 2;
  status_.content().parts = checkpoints().parts();
  const std::optional<messages::RunCommand> restore =
      recovers() ? plan_step_back(nodes_and_self(), launch_.regions.size(), latest) : std::nullopt;
  const cut::SavedState saved = cut::newest_saved_until(options_.saves, saving_.saved_by(), latest);
  if (restore && restore->at_step >= saved.step) return send_back(*restore, *back);
  if (saved.step >= 0) return endpoints_.commands().load_instead(*back, saved.name, *node_, run);
  endpoints_.commands().refuse(back->request, fmt::format("no state until {} is kept", latest));
}

/// Sends a restore as after a death. No node has died, so the new generation begins at once, and is paused if this one
/// was.
void NodeProcess::send_back(messages::RunCommand restore, const core::Command& back) {
  restore.epoch_ns = node::wall_clock_ns() + kNoticeOfStepBack.count();
  schedule_.hold_earlier_in(restore.at_step);
  endpoints_.commands().go_back_to(back, restore.at_step);
  send_restore(restore);
}

/// The regions that keep this node's parts, chosen by the hosts of the present nodes.
std::vector<core::RegionId> NodeProcess::keepers() {
  std::map<core::RegionId, std::uint16_t> hosts;
  for (const auto& [region, seen] : control().statuses()) hosts[region] = seen.host;
  return keepers_of(options_.region, static_cast<std::uint32_t>(launch_.regions.size()), hosts);
}

}  // namespace aurasim::process
