// What one node leaves on disk: one folder per region, one CSV file per question. Written as the run goes, so that a
// node that dies leaves what it had. The launcher merges the folders (report.h).
#pragma once

#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "node/node.h"

namespace aurasim::node {

/// Wall-clock times of one step, milliseconds.
struct FrameTimes {
  double frame_ms = 0;  ///< from the first thing done for the step to the last, without waiting
  double wait_ms = 0;   ///< for neighbours
};

/// How a node's run ended.
struct Ending {
  double real_time_factor = 1;
  std::string outcome;
  std::vector<core::RegionId> dead_regions;
};

class Recorder {
 public:
  /// Creates `folder`/region_<r>; throws std::runtime_error when that fails.
  Recorder(const std::filesystem::path& folder, core::RegionId region);
  ~Recorder();

  void write(const StepReport& report, const FrameTimes& times, const Node& node);

  /// What came in after the last step.
  void write_settling(const StepReport& report);

  /// The last word: who is here, who is on the way, all counters, and how fast it went.
  void finish(Node& node, const Ending& ending);

  static std::filesystem::path region_folder(const std::filesystem::path& folder, core::RegionId region);

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;

  File open(const char* name, const char* header) const;
  void write_hand_offs(const StepReport& report);
  void write_collisions(const StepReport& report);
  void write_bodies(Node& node) const;
  void write_summary(Node& node, const Ending& ending) const;
  void flush();

  core::RegionId region_;
  std::filesystem::path folder_;
  File steps_, collisions_, migrations_, violations_, births_, removals_;
  std::map<core::Step, std::uint64_t> hash_;
  core::Step flushed_ = 0;
};

}  // namespace aurasim::node
