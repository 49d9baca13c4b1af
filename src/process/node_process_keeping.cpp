// Parts of the world that a node keeps while it runs: saved parts as files, and checkpoints to go back to when a node
// dies.
#include <chrono>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "process/keepers.h"
#include "process/node_process.h"
#include "process/step_back.h"

namespace aurasim::process {
namespace {

constexpr std::chrono::nanoseconds kNoticeOfStepBack{600'000'000};  // time in which all nodes receive the command

}  // namespace

/// Writes complete parts on threads beside the run. Every node replies to the client that its part is written.
void NodeProcess::save_parts() {
  for (core::WorldCut& part : node_->take_saved()) {
    const core::Step step = part.step;
    if (const core::Step every = kept_every(); every > 0 && step % every == 0) {
      if (recovers()) checkpoints_->add(as_saved(part), step + launch_.lookahead());
      keep_on_disk(part);
    }
    if (!saves_.expects(step)) continue;
    command_server_->add_meshes(part);
    saves_.write(std::move(part), launch_, save_of());
  }
  keep_checkpoints();
  note_saves();
}

/// Saves the paused state once everything that was under way has arrived.
void NodeProcess::save_as_it_stands() {
  for (StandingSave& save : command_server_->take_standing_saves()) standing_saves_.push_back(std::move(save));
  std::erase_if(standing_saves_, [this](const StandingSave& save) {
    if (save.step != node_->current_step()) {
      command_server_->refuse(save.request, fmt::format("the run has gone on from state {} before it was saved there: "
                                                        "ask again",
                                                        save.step));
      return true;
    }
    std::optional<core::WorldCut> part = node_->present_part();
    if (!part) return false;
    if (save.step > node_->confirmed_step()) doubtful_saves_.push_back(save);
    command_server_->add_meshes(*part);
    saves_.write(std::move(*part), launch_, save_of(), cut::SaveKind::kAsked, save.request, save.file);
    return true;
  });
}

/// Looks at worlds that were saved in a pause before their state was confirmed. `back_to`: the state that all have gone
/// back to; later states are computed again, so saves of them are void.
void NodeProcess::look_at_doubtful_saves(std::optional<core::Step> back_to) {
  std::erase_if(doubtful_saves_, [&](const StandingSave& save) {
    if (!back_to || save.step <= *back_to) return save.step <= node_->confirmed_step();
    notice_ = fmt::format(
        "{} was saved in state {}, which is computed again since bodies had touched on two nodes: save it "
        "anew",
        save.file, save.step);
    spdlog::warn("region {}: {}", core::value_of(options_.region), notice_);
    return true;
  });
}

/// Asks for the next checkpoint. Every node does so by itself, in the same states.
void NodeProcess::plan_checkpoint() {
  const core::Step every = kept_every();
  if (every == 0) return;
  const core::Step next = (node_->current_step() / every + 1) * every;
  if (next <= checkpoint_) return;
  checkpoint_ = next;
  node_->save(next);
}

/// Keeps complete parts as checkpoints. A part counts once the records up to its state are on disk, because other
/// records die with the node.
void NodeProcess::keep_checkpoints() {
  const std::optional<core::Step> wanted = checkpoints_->waits_for();
  if (wanted && recorded_ >= *wanted && secured_ < *wanted) {
    if (recorder_) recorder_->secure();
    secured_ = recorded_;
  }
  checkpoints_->progress(secured_);
  if (checkpoints_->left_out() == 0 || says_left_out_) return;
  says_left_out_ = true;
  std::vector<std::uint32_t> keepers;
  for (const core::RegionId keeper : checkpoints_->keepers()) keepers.push_back(core::value_of(keeper));
  notice_ = fmt::format(
      "one of regions [{}], which keep copies of this region, takes longer to receive a part of the world than from "
      "one "
      "checkpoint to the next: after a death all may have to go back farther (survival.checkpoint)",
      fmt::join(keepers, ", "));
  spdlog::warn("{}", notice_);
}

/// Orders the regular saves; only the lead does so. Such a world is named after its state.
void NodeProcess::save_regularly() {
  const core::Step due = std::max(saved_last_, first_step()) + options_.save_every;
  if (options_.save_every == 0 || node_->current_step() < due) return;
  saved_last_ = node_->protocol().earliest_effect();
  node_->order(core::Save{fmt::format("state-{}.cut", saved_last_)}, 0, saved_last_);
}

/// Handles the request "step back". All nodes go back to the newest state that all have in memory, or that the lead
/// finds in its folder. It lies at least half the distance of two kept states back.
void NodeProcess::step_back(const RunView& run) {
  const std::optional<core::Command> back = command_server_->take_wanted_back();
  if (!back) return;
  const core::Step latest = node_->current_step() - (launch_.checkpoint_steps() + 1) / 2;
  status_.parts = checkpoints_->parts();
  std::map<core::RegionId, dds::SeenStatus> nodes = control_.statuses();
  nodes[options_.region].status = status_;
  const std::optional<dds::RunCommand> restore =
      recovers() ? plan_step_back(nodes, launch_.regions.size(), latest) : std::nullopt;
  const cut::SavedState saved = cut::newest_saved_until(options_.saves, saved_by(), latest);
  if (restore && restore->at_step >= saved.step) return send_back(*restore, *back);
  if (saved.step >= 0) return command_server_->load_instead(*back, saved.name, *node_, run);
  command_server_->refuse(back->request, fmt::format("no state until {} is kept", latest));
}

/// Sends a restore as after a death. No node has died, so the new generation begins at once, and is paused if this one
/// was.
void NodeProcess::send_back(dds::RunCommand restore, const core::Command& back) {
  restore.run = options_.run;
  restore.region = options_.region;
  restore.epoch_ns = node::wall_clock_ns() + kNoticeOfStepBack.count();
  restore.rate = pacer_.rate();
  if (hold_at_) hold_at_ = restore.at_step;
  command_server_->go_back_to(back, restore.at_step);
  publish_map(restore.generation, restore.at_step);
  restore.request = control_.send(restore);
  restore_ = restore;
  repeat_commands(restore);
}

cut::SavedWorld NodeProcess::as_saved(core::WorldCut part) const {
  return {cut::identity_of(launch_), core::value_of(options_.region),
          static_cast<std::uint32_t>(launch_.regions.size()), 0, std::move(part)};
}

/// The regions that keep this node's parts, chosen by the hosts of the present nodes.
std::vector<core::RegionId> NodeProcess::keepers() {
  std::map<core::RegionId, std::uint16_t> hosts;
  for (const auto& [region, seen] : control_.statuses()) hosts[region] = seen.host;
  return keepers_of(options_.region, static_cast<std::uint32_t>(launch_.regions.size()), hosts);
}

}  // namespace aurasim::process
