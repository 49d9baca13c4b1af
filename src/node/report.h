// Merges what the nodes of a run have left on disk into one report (docs/design.md, "What is counted"), and counts
// bodies: who is here, who went down with a dead node, who is lost, who is there twice. Nothing is guessed: a body
// counts as gone with a dead node only if the records say that it was there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/ids.h"

namespace aurasim::node {

struct RunFacts {
  std::size_t regions = 0;
  double step_s = 1.0 / 60;
  std::vector<core::RegionId> died;  ///< regions whose process ended before its time
};

struct DeadRegion {
  core::RegionId region{};
  std::size_t bodies = 0;  ///< that went down with it
};

struct Accounts {
  std::uint64_t bodies = 0;
  std::uint64_t lost = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t hand_offs = 0;
  std::uint64_t thrashed = 0;
  std::uint64_t reclaimed = 0;
  double real_time_factor = 0;
  std::vector<DeadRegion> dead;
};

/// Removes what an earlier run has left in `folder` (region_* and the merged files). Leaves everything else alone.
void clear_report(const std::filesystem::path& folder);

/// Regions 0 to `regions` - 1 whose records in `folder` do not say that they came to the run's end.
std::vector<core::RegionId> regions_without_end(const std::filesystem::path& folder, std::size_t regions);

/// Reads `folder`/region_*; writes summary.json, steps.csv, collisions.csv, migrations.csv, violations.csv and
/// state_hash.csv into `folder`. Throws std::runtime_error when it cannot write.
Accounts merge_report(const std::filesystem::path& folder, const RunFacts& facts);

}  // namespace aurasim::node
