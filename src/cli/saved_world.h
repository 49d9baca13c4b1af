// Saved worlds of a launch: with what one was computed, how a node writes its part, and how a run goes on from one.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "config/launch.h"
#include "core/order.h"
#include "core/world_cut.h"
#include "cut/cut_file.h"

namespace CLI {
class App;
}

namespace aurasim::cli {

cut::Identity identity_of(const config::Launch& launch);

/// What a run begins with, as the command line says it.
struct LoadArguments {
  std::string file;
  bool other_build = false;

  void add_to(CLI::App& command);
};

/// Where and how often nodes save their parts, as the command line says it.
struct SaveArguments {
  std::string folder = "saves";
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

/// The file of the newest state that nodes have saved without being asked, as far as this host has parts of it; empty:
/// there is none.
std::string newest_saved_world(const std::filesystem::path& folder);

/// For people, when no process has any of the run's world any more: what there is in the folder of saved worlds.
std::string world_is_lost(const std::filesystem::path& saves);

/// A world that lies in a folder of saved worlds.
struct SavedState {
  core::Step step = -1;  ///< -1: there is none
  std::string name;
};

/// The newest one of this launch that is not later than state `latest`, by what the headers of its files say.
SavedState newest_saved_until(const std::filesystem::path& folder, const config::Launch& launch, core::Step latest);

/// Writes the parts of one region, beside the run.
class PartWriter {
 public:
  /// `keep`: so many worlds that nobody has asked for stay.
  PartWriter(std::filesystem::path folder, core::RegionId region, std::size_t keep)
      : folder_(std::move(folder)), region_(region), keep_(keep) {}

  /// An order to save, in the state that it names.
  void expect(const core::Order& order) { expected_.push_back(order); }
  bool expects(core::Step step) const;
  /// A part that is complete. `life`: a number that all nodes of the run have, and those of no other; another one when
  /// it has begun anew.
  void write(core::WorldCut part, const config::Launch& launch, std::uint64_t life);
  /// Likewise; of a save that is no order.
  void write(core::WorldCut part, const config::Launch& launch, std::uint64_t life, std::uint64_t request,
             const std::string& file);

  struct Written {
    std::uint64_t request = 0;
    core::Step step = 0;
    std::string file;
    std::string error;  ///< why there is none; empty: there is
  };
  /// Since the last call.
  std::vector<Written> take_written();

 private:
  void forget_old_ones(const Written& written);

  std::filesystem::path folder_;
  core::RegionId region_;
  std::size_t keep_;
  std::vector<core::Order> expected_;
  std::vector<std::future<Written>> writing_;
  std::deque<std::string> regular_;  ///< files that nobody has asked for
};

}  // namespace aurasim::cli
