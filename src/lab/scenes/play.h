// Plays one run of a random world in virtual time, from its beginning or from a saved world, and collects its results.
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
  std::vector<std::uint64_t> hash;  ///< hash of each state
  std::uint64_t hand_offs = 0;
  std::uint64_t broken = 0;
  std::string first_fault;
  std::size_t largest_cluster = 0;
  std::size_t bodies = 0;
  double cpu_s = 0;
  std::uint64_t redos = 0;
  std::uint64_t again = 0;  ///< number of states computed again
};

/// The world after encoding and decoding it, as through a file.
core::WorldCut through_a_file(core::WorldCut cut);

/// Collects the parts of all regions of one cluster.
class Saver {
 public:
  explicit Saver(core::Step step) : step_(step) {}

  void begin(VirtualCluster& cluster) const;
  void collect(node::Node& node);
  /// The whole world. Throws std::runtime_error if a part is missing.
  core::WorldCut take(std::size_t regions);

 private:
  core::Step step_;
  std::vector<core::WorldCut> parts_;
};

void note_report(const node::StepReport& report, Played& played);
/// Notes an event of the cluster. A redo is counted once, not once for each node.
void note_redo(const VirtualCluster::Event& event, Played& played);

/// Plays from state 0, or from the saved world `world`, to state `steps`. Nothing when `stop` became true.
std::optional<Played> play(VirtualCluster& cluster, Interference& interference, core::Step steps, int lookahead,
                           const std::atomic<bool>& stop, Saver* saver = nullptr,
                           const core::WorldCut* world = nullptr);

}  // namespace aurasim::lab
