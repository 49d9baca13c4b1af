// What becomes of a node's written parts: the replies to clients, the states kept on disk, and the end of the run.
#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cut/kept_on_disk.h"
#include "process/node_process.h"

namespace aurasim::process {

/// The run that saves belong to. A run whose nodes were started by hand has no number, so the request id of its start
/// serves.
cut::SaveOf NodeProcess::save_of() const {
  const std::uint64_t start = start_->request;
  return {options_.run != 0 ? options_.run : start, start + generation_};
}

cut::SavedBy NodeProcess::saved_by() const {
  return {launch_.world_identity(), saved_runs_, cut::launch_command(launch_)};
}

std::vector<std::filesystem::path> NodeProcess::save_folders() const {
  std::vector<std::filesystem::path> folders = {options_.saves};
  if (!options_.kept) return folders;
  for (const std::uint64_t run : saved_runs_) folders.push_back(cut::kept_folder_of(*options_.kept, run));
  return folders;
}

/// To be called when a generation begins.
void NodeProcess::begin_to_save() {
  const std::uint64_t run = save_of().run;
  if (std::ranges::find(saved_runs_, run) == saved_runs_.end()) saved_runs_.push_back(run);
  if (options_.kept) saves_.use_kept_folder(cut::kept_folder_of(*options_.kept, run));
}

/// Number of states between two kept states; 0 if none is kept. A run of one node has no keeper, so its states are kept
/// on disk only.
core::Step NodeProcess::kept_every() const {
  if (recovers()) return launch_.checkpoint_steps();
  return options_.kept && launch_.regions.size() == 1 ? cut::kept_steps(launch_) : 0;
}

/// Writes a part for survival.disk. A state is skipped while the last one is still being written.
void NodeProcess::keep_on_disk(const core::WorldCut& part) {
  if (!options_.kept || saves_.is_writing(cut::SaveKind::kKept)) return;
  core::WorldCut whole = part;
  command_server_->add_meshes(whole);
  saves_.write(std::move(whole), launch_, save_of(), cut::SaveKind::kKept, 0, fmt::format("state-{}.cut", part.step));
}

void NodeProcess::note_saves() {
  for (const auto& [region, seen] : control_.statuses()) saves_.hear(region, seen.status.saved, seen.status.not_saved);
  for (const cut::PartWriter::Written& written : saves_.progress(std::chrono::steady_clock::now())) {
    if (written.request != 0) command_server_->reply_saved(written);
  }
  for (const std::string& words : saves_.take_words()) {
    notice_ = words;
    spdlog::warn("{}", words);
  }
}

/// Finishes all saves at the end of the run. If there is a launcher, it removes the states kept on disk.
void NodeProcess::conclude_saves() {
  saves_.finish();
  note_saves();
  const bool is_over = !fence_.closed() && stop_at_ && has_reached(*stop_at_);
  if (is_over && !options_.has_launcher && options_.kept) {
    for (const std::uint64_t run : saved_runs_) {
      cut::PartStore(cut::kept_folder_of(*options_.kept, run)).remove_all_of(core::value_of(options_.region));
    }
  }
  if (saves_.regular_ones_failed() && !options_.has_launcher) spdlog::error("{}", cut::kNothingSaved);
}

}  // namespace aurasim::process
