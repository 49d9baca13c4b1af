// Saved worlds of a launch: with what one was computed, which ones there are, and how a run goes on from one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/launch.h"
#include "core/world_cut.h"
#include "cut/part_store.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace aurasim::cli {

cut::Identity identity_of(const config::Launch& launch);

/// What a run begins with, as the command line says it.
struct LoadArguments {
  std::string file;
  bool other_build = false;

  /// Returns the option --load.
  CLI::Option* add_to(CLI::App& command);
};

/// Where and how often nodes save their parts, as the command line says it.
struct SaveArguments {
  std::string folder = "saves";
  bool folder_is_given = false;
  double every_s = 0;    ///< simulated; 0: when somebody asks for it
  std::size_t keep = 3;  ///< of those that nobody has asked for

  void add_to(CLI::App& command);
};

/// Null if there is nothing to load. Throws config::BadConfig where the file cannot be used, and says why.
std::shared_ptr<const core::WorldCut> load_world(const LoadArguments& arguments, const config::Launch& launch);

/// Null; or why a saved world may not be called so: it becomes a file's name on every node's host.
const char* problem_with_save_name(const std::string& name);
/// Likewise for who asks: with what was found, and what a name is for. Empty: it may.
std::string refused_save_name(const std::string& name);

/// What nodes have saved, and to whom it has to belong.
struct SavedBy {
  std::uint64_t world = 0;          ///< config::Launch::world_identity
  std::vector<std::uint64_t> runs;  ///< numbers of the run, as its saved worlds have them
  std::string command;              ///< that starts such a run, for messages
};

/// The newest world of a run that is whole, on this host, and can be read: in the folder of saved worlds, or among what
/// is kept on disk. Nothing: there is none.
std::optional<cut::StoredWorld> newest_saved_world(const std::vector<std::filesystem::path>& folders,
                                                   const SavedBy& by);

/// For people: how a run goes on from the newest of its worlds that is here.
std::string say_newest_saved(const std::vector<std::filesystem::path>& folders, const SavedBy& by);

/// For people, when no process has any of the run's world any more.
std::string world_is_lost(const std::vector<std::filesystem::path>& folders, const SavedBy& by);

/// A world that lies in a folder of saved worlds.
struct SavedState {
  core::Step step = -1;  ///< -1: there is none
  std::string name;
};

/// The newest one of this run in the folder that is not later than state `latest`.
SavedState newest_saved_until(const std::filesystem::path& folder, const SavedBy& by, core::Step latest);

}  // namespace aurasim::cli
