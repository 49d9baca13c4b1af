// Writes the records of one node to disk: one folder per region, one CSV file per topic. Rows are written as the run
// goes, so that a node that dies leaves what it had. The launcher merges the folders (report.h). A full disk ends the
// records, not the run.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "node/node.h"
#include "records/row_file.h"
#include "records/time_histogram.h"

namespace aurasim::records {

/// Wall-clock times of one step, milliseconds.
struct FrameTimes {
  double frame_ms = 0;  ///< from the first thing done for the step to the last, without waiting
  double wait_ms = 0;   ///< time spent waiting for neighbours
};

/// Exchanges with coupled regions.
struct Exchanges {
  TimeHistogram times;
  std::uint64_t asked = 0;     ///< for pieces of parcels that had not come in time
  std::uint64_t repeated = 0;  ///< pieces that were sent again
};

/// How a node's run ended.
struct Ending {
  double real_time_factor = 1;
  std::string outcome;
  std::vector<core::RegionId> dead_regions;
  std::uint64_t sent_bytes = 0;  ///< auras, hand-offs and acknowledgements sent to neighbours, without RTPS headers
  std::uint64_t checkpoint_bytes = 0;      ///< parts of the world sent to their keeper
  std::uint64_t checkpoints_left_out = 0;  ///< parts for which the way to the keeper was too slow
  std::string exchange = {};               ///< how bodies of two regions touch: aura or coupled
  double round_trip_ms = 0;                ///< the slowest that was measured before the start; 0: none was
  Exchanges exchanges = {};                ///< if regions are coupled
};

/// Where the records end before the run does.
struct RecordsEnd {
  core::Step after = 0;  ///< the last state that is recorded for sure
  std::string why;
};

class Recorder {
 public:
  /// Creates `folder`/region_<r>; throws std::runtime_error when that fails. With `after` it goes on with the files
  /// that are there, and removes their rows of states later than `after`.
  Recorder(const std::filesystem::path& folder, core::RegionId region, std::optional<core::Step> after = {});

  void write(const node::StepReport& report, const FrameTimes& times);

  /// Flushes everything written so far to the operating system, so that it survives the end of this process.
  void secure();

  /// Writes what came in after the last step.
  void write_settling(const node::StepReport& report);

  /// Writes the end of the records: bodies hosted here, bodies under way, all counters, and the real-time factor.
  void finish(node::Node& node, const Ending& ending);

  /// Where and why the records ended early. Empty as long as everything could be written.
  const std::optional<RecordsEnd>& records_end() const { return end_; }

  /// True if another process now records this region in the same folder.
  bool is_replaced() const { return hashes_.is_replaced(); }

  static std::filesystem::path region_folder(const std::filesystem::path& folder, core::RegionId region);

 private:
  void write_step(const node::StepReport& report, const FrameTimes& times);
  void write_hand_offs(const node::StepReport& report);
  void write_collisions(const node::StepReport& report);
  void write_violations(const node::StepReport& report);
  void note_redo(const node::StepReport& report);
  void write_bodies(node::Node& node);
  void write_summary(node::Node& node, const Ending& ending) const;
  void flush(core::Step step);
  void end_records(const RowFile& failed);

  core::RegionId region_;
  std::filesystem::path folder_;
  RowFile steps_, collisions_, migrations_, violations_, births_, removals_, hashes_, setpoints_;
  struct Redo {
    core::Step from = 0;
    core::Step to = 0;
    std::vector<core::TogetherPair> pairs;  ///< pairs of this redo, and those of earlier redos that still hold
  };
  std::vector<Redo> redos_;
  core::Step last_ = -1;  ///< newest state written
  core::Step flushed_ = 0;
  std::optional<RecordsEnd> end_;
};

}  // namespace aurasim::records
