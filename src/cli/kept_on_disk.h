// States that a run keeps on disk, so that it can go on when all its processes have ended at once (survival.disk):
// where they are, and from which of them a run goes on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/saved_world.h"
#include "config/launch.h"

namespace aurasim::cli {

/// The folder that has a folder for each run. Nothing: runs of this launch keep nothing on disk.
std::optional<std::filesystem::path> kept_folder(const config::Launch& launch, const SaveArguments& save);

/// States from one that is kept on disk to the next; 0: a node that dies is not gone back for, so none is.
core::Step kept_steps(const config::Launch& launch);

std::filesystem::path kept_folder_of(const std::filesystem::path& kept, std::uint64_t run);

/// Throws config::BadConfig when a folder that the run is to save in cannot be written.
void check_room_for_saves(const config::Launch& launch, const SaveArguments& save);

/// The newest world of this launch, as --load takes it, that is whole and can be read, with the states that runs have
/// kept on disk. Warns of files among these that are of no use. Throws config::BadConfig when there is none.
std::string world_to_resume(const config::Launch& launch, const SaveArguments& save);

/// The command that starts this launch, for messages.
std::string launch_command(const config::Launch& launch);
/// The command that goes on from what such a run has kept on disk.
std::string resume_command(const config::Launch& launch, const SaveArguments& save);

/// Folders in which a run has its saved worlds.
std::vector<std::filesystem::path> folders_of_run(const config::Launch& launch, const SaveArguments& save,
                                                  std::uint64_t run);

/// At the end of a run of this host's launcher: what is kept on disk goes, unless somebody may want to go on from it.
/// Then it is said how.
void conclude_kept(const config::Launch& launch, const SaveArguments& save, std::uint64_t run, bool may_go_on);

}  // namespace aurasim::cli
