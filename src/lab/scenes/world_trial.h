// Runs one world twice: on the regions of its launch file, and on one node. Each state has to have the same bits in
// both.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/sync_mode.h"
#include "lab/launch_rules.h"

namespace aurasim::lab {

/// Rules of a trial in virtual time. The launch file's network settings are ignored; they are for real runs.
struct TrialRules {
  core::Step steps = 400;
  core::SyncMode sync = core::SyncMode::kDeterministic;
  bool bad_network = false;            ///< loss, delay, jitter, duplicates; with every other seed also reordering
  bool partitions = false;             ///< three times some nodes are cut off from the others for up to two seconds
  std::vector<std::string> overrides;  ///< as --set
  std::optional<core::Step> save_at;   ///< the world is saved in this state, and goes on from it on other nodes
  std::vector<int> load_on;            ///< numbers of nodes on which the saved world goes on; all need the same bits
  int deaths = 0;                      ///< number of nodes that die, one after the other, at random times
  SetupOf setup_of;
};

struct WorldOutcome {
  std::optional<core::Step> first_difference;  ///< the first state with other bits than on one node
  std::string error;                           ///< why a run did not come to its end; empty if it did
  std::uint64_t late = 0, missed = 0, unflagged = 0;
  std::uint64_t unflagged_on_one = 0;  ///< the same count on one node, which is no fault of the regions
  std::uint64_t violations = 0;        ///< all kinds
  std::uint64_t speed = 0, latency = 0, promise = 0, span = 0;  ///< violations of these kinds
  std::uint64_t redos = 0, computed_again = 0;                  ///< how often the run was put back; states
  std::uint64_t hand_offs = 0;
  std::uint64_t broken = 0;  ///< bodies for which physics broke down, on one node
  std::string first_fault;   ///< fault of the first of them
  std::size_t largest_cluster = 0;
  std::size_t bodies = 0;  ///< at the end, on one node
  std::size_t regions = 0;
  double regions_s = 0, one_s = 0;  ///< CPU time

  bool is_equal() const { return error.empty() && !first_difference; }
  /// True for outcomes that must not happen in any world.
  bool has_failed() const { return !is_equal() || unflagged > unflagged_on_one; }
};

/// The world whose files lie in `directory`. `seed`: seed of the network's faults. Nothing when `stop` became true.
/// Throws config::BadConfig when the files are wrong, std::runtime_error when they ask for another precision than this
/// program's.
std::optional<WorldOutcome> run_world(const std::filesystem::path& directory, const TrialRules& rules,
                                      std::uint64_t seed, const std::atomic<bool>& stop);

}  // namespace aurasim::lab
