#include "process/saving.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "cut/kept_on_disk.h"

namespace aurasim::process {

cut::SaveOf Saving::save_of() const { return {options_.run != 0 ? options_.run : start_, start_ + generation_}; }

cut::SavedBy Saving::saved_by() const { return {launch_.world_identity(), runs_, cut::launch_command(launch_)}; }

std::vector<std::filesystem::path> Saving::folders() const {
  std::vector<std::filesystem::path> folders = {options_.saves};
  if (!options_.kept) return folders;
  for (const std::uint64_t run : runs_) folders.push_back(cut::kept_folder_of(*options_.kept, run));
  return folders;
}

void Saving::begin(std::uint64_t start, core::Generation generation, core::Step step) {
  change_map(start, generation);
  checkpoint_ = recorded_ = secured_ = 0;
  saved_last_ = std::min(saved_last_, step);
  const std::uint64_t run = save_of().run;
  if (std::ranges::find(runs_, run) == runs_.end()) runs_.push_back(run);
  if (options_.kept) writer_.use_kept_folder(cut::kept_folder_of(*options_.kept, run));
}

void Saving::change_map(std::uint64_t start, core::Generation generation) {
  start_ = start;
  generation_ = generation;
}

/// Number of states between two kept states; 0 if none is kept. A run of one node has no keeper, so its states are kept
/// on disk only.
core::Step Saving::kept_every() const {
  if (launch_.recovers()) return launch_.checkpoint_steps();
  return options_.kept && launch_.regions.size() == 1 ? cut::kept_steps(launch_) : 0;
}

void Saving::plan_checkpoint(node::Node& node) {
  const core::Step every = kept_every();
  if (every == 0) return;
  const core::Step next = (node.current_step() / every + 1) * every;
  if (next <= checkpoint_) return;
  checkpoint_ = next;
  node.save(next);
}

void Saving::keep_parts(node::Node& node, CommandServer& server, Checkpoints& checkpoints,
                        records::Recorder* recorder) {
  for (core::WorldCut& part : node.take_saved()) {
    const core::Step step = part.step;
    if (const core::Step every = kept_every(); every > 0 && step % every == 0) {
      if (launch_.recovers()) checkpoints.add(as_saved(part), step + launch_.lookahead());
      keep_on_disk(part, server);
    }
    if (!writer_.expects(step)) continue;
    server.add_meshes(part);
    writer_.write(std::move(part), launch_, save_of());
  }
  keep_checkpoints(checkpoints, recorder);
}

/// Writes a part for survival.disk. A state is skipped while the last one is still being written.
void Saving::keep_on_disk(const core::WorldCut& part, CommandServer& server) {
  if (!options_.kept || writer_.is_writing(cut::SaveKind::kKept)) return;
  core::WorldCut whole = part;
  server.add_meshes(whole);
  writer_.write(std::move(whole), launch_, save_of(), cut::SaveKind::kKept, 0, fmt::format("state-{}.cut", part.step));
}

/// A part counts as a checkpoint once the records up to its state are on disk, because other records die with the node.
void Saving::keep_checkpoints(Checkpoints& checkpoints, records::Recorder* recorder) {
  const std::optional<core::Step> wanted = checkpoints.waits_for();
  if (wanted && recorded_ >= *wanted && secured_ < *wanted) {
    if (recorder) recorder->secure();
    secured_ = recorded_;
  }
  checkpoints.progress(secured_);
  if (checkpoints.left_out() == 0 || std::exchange(left_out_reported_, true)) return;
  std::vector<std::uint32_t> keepers;
  for (const core::RegionId keeper : checkpoints.keepers()) keepers.push_back(core::value_of(keeper));
  report(
      fmt::format("one of regions [{}], which keep copies of this region, takes longer to receive a part of the world "
                  "than from one checkpoint to the next: after a death all nodes may have to go back farther. A "
                  "longer survival.checkpoint gives it time",
                  fmt::join(keepers, ", ")));
}

void Saving::save_as_it_stands(node::Node& node, CommandServer& server) {
  for (StandingSave& save : server.take_standing_saves()) standing_.push_back(std::move(save));
  std::erase_if(standing_, [&](const StandingSave& save) {
    if (save.step != node.current_step()) {
      server.refuse(save.request,
                    fmt::format("the run has gone on from state {} before it was saved there: ask for the save again",
                                save.step));
      return true;
    }
    if (save.step > node.shown_step()) return false;  // not all nodes have checked the state yet
    std::optional<core::WorldCut> part = node.present_part();
    if (!part) return false;
    if (save.step > node.confirmed_step()) doubtful_.push_back(save);
    server.add_meshes(*part);
    writer_.write(std::move(*part), launch_, save_of(), cut::SaveKind::kAsked, save.request, save.file);
    return true;
  });
}

void Saving::look_at_doubtful(const node::Node& node, std::optional<core::Step> back_to) {
  std::erase_if(doubtful_, [&](const StandingSave& save) {
    if (!back_to || save.step <= *back_to) return save.step <= node.confirmed_step();
    report(
        fmt::format("{} is void: it was saved in state {}, which is computed again because a static was not where its "
                    "order puts it. Save the world again",
                    save.file, save.step));
    return true;
  });
}

/// A regularly saved world is named after its state.
void Saving::save_regularly(node::Node& node, core::Step first) {
  const core::Step due = std::max(saved_last_, first) + options_.save_every;
  if (options_.save_every == 0 || node.current_step() < due) return;
  saved_last_ = node.protocol().earliest_effect();
  node.order(core::Save{fmt::format("state-{}.cut", saved_last_)}, 0, saved_last_);
}

void Saving::receive(const std::map<core::RegionId, messages::SeenStatus>& statuses) {
  for (const auto& [region, seen] : statuses) writer_.receive(region, seen.status.saved, seen.status.not_saved);
}

void Saving::reply(CommandServer& server) {
  for (const cut::PartWriter::Written& written : writer_.progress(std::chrono::steady_clock::now())) {
    if (written.request != 0) server.reply_saved(written);
  }
  for (std::string& words : writer_.take_words()) report(std::move(words));
}

void Saving::conclude(CommandServer& server, const std::map<core::RegionId, messages::SeenStatus>& statuses,
                      bool is_over) {
  writer_.finish();
  receive(statuses);
  reply(server);
  if (is_over && !options_.has_launcher && options_.kept) {
    for (const std::uint64_t run : runs_) {
      cut::PartStore(cut::kept_folder_of(*options_.kept, run)).remove_all_of(core::value_of(options_.region));
    }
  }
  if (writer_.regular_ones_failed() && !options_.has_launcher) spdlog::error("{}", cut::kNothingSaved);
}

cut::SavedWorld Saving::as_saved(core::WorldCut part) const {
  return {cut::identity_of(launch_), core::value_of(options_.region),
          static_cast<std::uint32_t>(launch_.regions.size()), 0, std::move(part)};
}

void Saving::report(std::string words) {
  spdlog::warn("region {}: {}", core::value_of(options_.region), words);
  words_.push_back(std::move(words));
}

}  // namespace aurasim::process
