// Saved worlds of a launch: the identity of what computed one, the worlds on this host, and how a run goes on from one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/launch.h"
#include "core/world_cut.h"
#include "cut/part_store.h"

namespace aurasim::cut {

Identity identity_of(const config::Launch& launch);

/// Command-line options for the saved world that a run begins with.
struct LoadArguments {
  std::string file;
  bool other_build = false;
};

/// Command-line options for where and how often nodes save their parts.
struct SaveArguments {
  std::string folder = "saves";
  bool folder_is_given = false;
  double every_s = 0;    ///< simulated seconds; 0: only on request
  std::size_t keep = 3;  ///< how many regularly saved worlds stay
};

/// The world that --load names. Null if the option is not given. Throws config::BadConfig, with the reason, if the file
/// cannot be used.
std::shared_ptr<const core::WorldCut> load_world(const LoadArguments& arguments, const config::Launch& launch);

/// Identifies the run that saved worlds have to belong to.
struct SavedBy {
  std::uint64_t world = 0;          ///< config::Launch::world_identity
  std::vector<std::uint64_t> runs;  ///< numbers of the run, as its saved worlds have them
  std::string command;              ///< command line that starts such a run, for messages
};

/// The newest whole and readable world of the run on this host, in `folders`: saved worlds, and states kept on disk.
/// Nothing if there is none.
std::optional<StoredWorld> newest_saved_world(const std::vector<std::filesystem::path>& folders, const SavedBy& by);

/// Message for users: how the run goes on from the newest of its worlds on this host.
std::string say_newest_saved(const std::vector<std::filesystem::path>& folders, const SavedBy& by);

/// Message for users when no process has the run's world any more.
std::string world_is_lost(const std::vector<std::filesystem::path>& folders, const SavedBy& by);

/// Name and state of a world in a folder of saved worlds.
struct SavedState {
  core::Step step = -1;  ///< -1: there is none
  std::string name;
};

/// The newest saved world of this run in `folder` that is not later than state `latest`.
SavedState newest_saved_until(const std::filesystem::path& folder, const SavedBy& by, core::Step latest);

/// True for a name that a saved world may have. It becomes a file's name on every node's host.
bool is_save_name(std::string_view name);

}  // namespace aurasim::cut
