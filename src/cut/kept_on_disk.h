// States that a run keeps on disk, so that it can go on when all its processes have ended at once (survival.disk):
// their folders, and the choice of the state from which a run goes on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "config/launch.h"
#include "cut/saved_world.h"

namespace aurasim::cut {

/// The folder with one folder per run. Nothing if runs of this launch keep no states on disk.
std::optional<std::filesystem::path> kept_folder(const config::Launch& launch, const SaveArguments& save);

/// Number of states from one that is kept on disk to the next. 0 if none is kept, because the run does not recover from
/// deaths.
core::Step kept_steps(const config::Launch& launch);

std::filesystem::path kept_folder_of(const std::filesystem::path& kept, std::uint64_t run);

/// Throws config::BadConfig when a folder that the run is to save in cannot be written.
void check_room_for_saves(const config::Launch& launch, const SaveArguments& save);

/// The newest whole and readable world of this launch, as an argument for --load. States that runs have kept on disk
/// are included. Warns of kept files that cannot be used. Throws config::BadConfig when there is none.
std::string world_to_resume(const config::Launch& launch, const SaveArguments& save);

/// The command that starts this launch, for messages.
std::string launch_command(const config::Launch& launch);
/// The command that goes on from the states that such a run has kept on disk.
std::string resume_command(const config::Launch& launch, const SaveArguments& save);

/// Folders in which a run has its saved worlds.
std::vector<std::filesystem::path> folders_of_run(const config::Launch& launch, const SaveArguments& save,
                                                  std::uint64_t run);

/// To be called at the end of a launcher's run. Removes the states kept on disk, unless `may_go_on` and one of them is
/// whole. Then it logs the command that goes on from it.
void conclude_kept(const config::Launch& launch, const SaveArguments& save, std::uint64_t run, bool may_go_on);

}  // namespace aurasim::cut
