// Load of a run's nodes in each window of a few seconds: the data of the thesis's figures 5.2 to 5.16.
#pragma once

#include <cstdint>
#include <vector>

#include "core/ids.h"

namespace aurasim::lab {

/// One step of one node.
struct StepLoad {
  double physics_ms = 0;
  double protocol_ms = 0;
  double transport_ms = 0;
  double watch_ms = 0;
  double cut_ms = 0;
  double hash_ms = 0;
  std::size_t bodies = 0;
  std::size_t awake = 0;
  std::size_t projecting = 0;
  std::size_t foreign = 0;
  std::size_t largest_cluster = 0;
  // Since the step before.
  std::uint64_t departures = 0;
  std::uint64_t returns = 0;  ///< departures that bring a body back (round_trips.h)
  std::uint64_t aura_updates = 0;
  std::uint64_t aura_bytes = 0;
  std::uint64_t hand_off_bytes = 0;
  std::uint64_t link_bytes = 0;
  std::uint64_t datagrams = 0;
  std::uint64_t violations = 0;
  std::uint64_t late = 0;  ///< late or missed collisions

  double frame_ms() const { return physics_ms + protocol_ms + transport_ms + watch_ms + cut_ms + hash_ms; }
};

/// One window of one node, or of all nodes together (region -1). For all nodes, frames are those of the slowest node in
/// each step, other times are means over nodes, counts are sums, and the largest cluster is the largest of all.
struct Window {
  int region = -1;
  double begin_s = 0;
  double frame_max_ms = 0, frame_p95_ms = 0, frame_mean_ms = 0;
  double slow_down = 1;  ///< time taken over time simulated, for the whole run
  StepLoad mean;         ///< times: means; counts: sums over the window; numbers of bodies: of its last step
};

/// Gathers the steps of all nodes, in any order.
class WindowSums {
 public:
  WindowSums(std::size_t regions, core::Step steps_per_window, double step_s)
      : regions_(regions), steps_per_window_(steps_per_window), step_s_(step_s), loads_(regions) {}

  /// Adds the load of one step. If a step is computed again, its times are those of the first time, and its messages
  /// are added.
  void add(std::size_t region, core::Step step, const StepLoad& load);
  /// The windows that every node has completed. In each, region -1 comes after the nodes.
  std::vector<Window> windows() const;

 private:
  Window of_region(std::size_t region, std::size_t first, std::size_t last) const;
  Window of_all(std::size_t first, std::size_t last) const;

  std::size_t regions_;
  core::Step steps_per_window_;
  double step_s_;
  std::vector<std::vector<StepLoad>> loads_;  ///< by region and step, from step 1
};

}  // namespace aurasim::lab
