// Options of a node's process, from its command line.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/ids.h"
#include "core/world_cut.h"

namespace aurasim::process {

struct NodeOptions {
  core::RegionId region{};
  std::uint64_t run = 0;  ///< number of the run, the same on all its nodes and on no others; 0: none was drawn
  std::optional<core::Step> steps;  ///< last state to compute; nothing: run until a stop command
  std::optional<std::filesystem::path> report;
  std::chrono::seconds start_time_out{30};      ///< longest time without progress of the other nodes at the start
  std::shared_ptr<const core::WorldCut> world;  ///< saved world that the run goes on from; a reset goes back to it
  std::filesystem::path saves = "saves";        ///< folder for this node's parts of saved worlds
  core::Step save_every = 0;                    ///< in states; 0: worlds are saved only on request
  std::size_t save_keep = 3;                    ///< how many regularly saved worlds stay
  /// Folder where runs keep their newest states on disk (kept_folder); nothing: they keep none.
  std::optional<std::filesystem::path> kept;
  bool takes_over = false;    ///< this process replaces the dead node of its region in a run that goes on
  bool has_launcher = false;  ///< a launcher replaces nodes that die, and ends all processes
  int heartbeat = -1;         ///< number of the launcher's pipe for signs of life (heartbeat.h)
  std::string as;             ///< name of this node's key, in a run with keys; empty: the region's own key
};

}  // namespace aurasim::process
