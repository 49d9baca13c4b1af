// One run of a random world in virtual time, from its beginning or from a saved world, and what came of it.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/world_cut.h"
#include "lab/scenes/interference.h"
#include "lab/virtual_cluster.h"

namespace aurasim::lab {

struct Played {
  std::vector<std::uint64_t> hash;  ///< by state
  std::uint64_t hand_offs = 0;
  std::uint64_t broken = 0;
  std::string first_fault;
  std::size_t largest_cluster = 0;
  std::size_t bodies = 0;
  double cpu_s = 0;
  std::uint64_t redos = 0;
  std::uint64_t again = 0;  ///< states computed once more
};

/// As a file would have it.
core::WorldCut through_a_file(core::WorldCut cut);

/// Collects the parts of all regions of one cluster.
class Saver {
 public:
  explicit Saver(core::Step step) : step_(step) {}

  void begin(VirtualCluster& cluster) const;
  void collect(node::Node& node);
  /// Throws std::runtime_error if they are not all there.
  core::WorldCut take(std::size_t regions);

 private:
  core::Step step_;
  std::vector<core::WorldCut> parts_;
};

/// CPU time of this thread, s.
double thread_time_s();

void note_report(const node::StepReport& report, Played& played);
/// An event of the cluster: a redo is counted once.
void note_redo(const VirtualCluster::Event& event, Played& played);

/// State 0, or that of a saved world, and what comes after it. Nothing when `stop` became true.
std::optional<Played> play(VirtualCluster& cluster, Interference& interference, core::Step steps, int lookahead,
                           const std::atomic<bool>& stop, Saver* saver = nullptr,
                           const core::WorldCut* world = nullptr);

}  // namespace aurasim::lab
