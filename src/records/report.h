// Merges what the nodes of a run have left on disk into one report (docs/design.md, "What is counted"), and counts
// bodies: those hosted at the end, those that went down with a dead node, those lost, and those hosted twice. Nothing
// is guessed: a body counts as gone with a dead node only if the records say that the node hosted it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/ids.h"

namespace aurasim::records {

struct RunFacts {
  std::size_t regions = 0;
  double step_s = 1.0 / 60;
  std::vector<core::RegionId> died;  ///< regions whose process ended before its time
};

struct DeadRegion {
  core::RegionId region{};
  std::size_t bodies = 0;  ///< number of bodies that went down with it
};

/// A node whose records end before its run did.
struct IncompleteRegion {
  core::RegionId region{};
  std::uint64_t after_step = 0;  ///< the last step that is recorded for sure
  std::string why;
};

struct Accounts {
  std::uint64_t bodies = 0;
  std::uint64_t lost = 0;
  std::uint64_t unaccounted = 0;  ///< bodies that no node has, while records that might explain it are missing
  std::uint64_t duplicated = 0;
  std::uint64_t hand_offs = 0;
  std::uint64_t thrashed = 0;
  double real_time_factor = 0;
  std::size_t redos = 0;
  double redo_share = 0;                            ///< share of the nodes' computing time that went into redos
  std::map<std::string, std::uint64_t> violations;  ///< by kind
  std::vector<DeadRegion> dead;
  std::vector<IncompleteRegion> incomplete;
  std::vector<std::string> not_merged;  ///< merged files that did not fit on the disk
};

/// Removes what an earlier run has left in `folder` (region_* and the merged files). Leaves everything else alone.
void clear_report(const std::filesystem::path& folder);

/// True if any node has written anything into `folder`.
bool has_records(const std::filesystem::path& folder);

/// Returns the regions, of 0 to `regions` - 1, whose records in `folder` do not reach the run's end, or the state where
/// the run broke off.
std::vector<core::RegionId> regions_without_end(const std::filesystem::path& folder, std::size_t regions);

/// Reserves disk space for the summary, so that it can be written even when the disk has become full. Throws
/// std::runtime_error when there is no space.
void reserve_summary(const std::filesystem::path& folder);

/// Reads `folder`/region_*; writes summary.json, steps.csv, collisions.csv, migrations.csv, violations.csv and
/// state_hash.csv into `folder`. Throws std::runtime_error when it cannot write summary.json. Other files that it
/// cannot write are listed in Accounts::not_merged.
Accounts merge_report(const std::filesystem::path& folder, const RunFacts& facts);

}  // namespace aurasim::records
