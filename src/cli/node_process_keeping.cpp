// What a node keeps of the world while it runs: parts that somebody has asked for, as files, and those that it can go
// back to when a node dies.
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cli/node_process.h"

namespace aurasim::cli {

/// Written beside the run. Every node says to whoever has asked for it that it has.
void NodeProcess::save_parts() {
  for (core::WorldCut& part : node_->take_saved()) {
    const core::Step step = part.step;
    if (recovers() && step % launch_.checkpoint_steps() == 0) {
      checkpoints_->add(as_saved(part), step + launch_.lookahead());
    }
    saves_.write(std::move(part), launch_);
  }
  keep_checkpoints();
  for (const PartWriter::Written& written : saves_.take_written()) {
    if (!written.error.empty()) spdlog::error("state {} was not saved: {}", written.step, written.error);
    if (written.request != 0) command_server_->reply_saved(written);
  }
}

/// Every node does so by itself, in the same states.
void NodeProcess::plan_checkpoint() {
  if (!recovers()) return;
  const core::Step every = launch_.checkpoint_steps();
  const core::Step next = (node_->current_step() / every + 1) * every;
  if (next <= checkpoint_) return;
  checkpoint_ = next;
  node_->save(next);
}

/// A part counts once what was recorded up to it is on disk: it would die with the node otherwise.
void NodeProcess::keep_checkpoints() {
  const std::optional<core::Step> wanted = checkpoints_->waits_for();
  if (wanted && recorded_ >= *wanted && secured_ < *wanted) {
    if (recorder_) recorder_->secure();
    secured_ = recorded_;
  }
  checkpoints_->progress(secured_);
  if (checkpoints_->left_out() == 0 || says_left_out_) return;
  says_left_out_ = true;
  notice_ = fmt::format(
      "region {} takes longer for a part of the world than from one to the next: after a death all may "
      "have to go back farther (survival.checkpoint)",
      core::value_of(keeper()));
  spdlog::warn("{}", notice_);
}

/// On the lead. What is asked for by nobody is called by its state.
void NodeProcess::save_regularly() {
  const core::Step due = std::max(saved_last_, first_step()) + options_.save_every;
  if (options_.save_every == 0 || node_->current_step() < due) return;
  saved_last_ = node_->protocol().earliest_effect();
  node_->order(core::Save{fmt::format("state-{}.cut", saved_last_)}, 0, saved_last_);
}

cut::SavedWorld NodeProcess::as_saved(core::WorldCut part) const {
  return {identity_of(launch_), core::value_of(options_.region), static_cast<std::uint32_t>(launch_.regions.size()),
          std::move(part)};
}

/// Who keeps our parts: the next region's node on another host, or the next one where there is no other host.
core::RegionId NodeProcess::keeper() {
  const auto regions = static_cast<std::uint32_t>(launch_.regions.size());
  const auto behind = [&](std::uint32_t i) { return core::RegionId{(core::value_of(options_.region) + i) % regions}; };
  const auto& statuses = control_.statuses();
  const auto self = statuses.find(options_.region);
  for (std::uint32_t i = 1; i < regions; ++i) {
    const auto other = statuses.find(behind(i));
    if (self == statuses.end() || other == statuses.end()) continue;
    if (other->second.host != self->second.host) return behind(i);
  }
  return behind(1);
}

}  // namespace aurasim::cli
