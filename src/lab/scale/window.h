// Load of a run's nodes in each window of a few seconds: the data of the thesis's figures 5.2 to 5.16.
#pragma once

#include <cstdint>
#include <vector>

#include "core/ids.h"

namespace aurasim::lab {

/// The work of a node since an earlier state.
struct Counts {
  std::uint64_t departures = 0;
  std::uint64_t returns = 0;  ///< departures that bring a body back (round_trips.h)
  std::uint64_t aura_updates = 0;
  std::uint64_t aura_bytes = 0;
  std::uint64_t hand_off_bytes = 0;
  std::uint64_t link_bytes = 0;
  std::uint64_t datagrams = 0;
  std::uint64_t violations = 0;
  std::uint64_t late = 0;  ///< late or missed collisions

  Counts& operator+=(const Counts& other);
};

/// One step of one node.
struct StepLoad : Counts {
  double physics_ms = 0;
  double protocol_ms = 0;
  double transport_ms = 0;
  double other_ms = 0;  ///< the rest of the frame
  std::size_t bodies = 0;
  std::size_t projecting = 0;
  std::size_t largest_cluster = 0;

  double frame_ms() const { return physics_ms + protocol_ms + transport_ms + other_ms; }
};

/// One window of all nodes together.
struct Window : Counts {
  double frame_max_ms = 0, frame_p95_ms = 0, frame_mean_ms = 0;  ///< of the slowest node in each step
  double physics_ms = 0, protocol_ms = 0, transport_ms = 0;      ///< means over the steps, summed over nodes
  std::size_t bodies = 0, projecting = 0;                        ///< in its last step
  std::size_t most_hosted = 0;                                   ///< bodies of the node with most, in its last step
  std::size_t largest_cluster = 0;                               ///< of any step
  double slow_down = 1;                                          ///< time taken over time simulated, for the whole run
};

/// Gathers the steps of all nodes, in any order.
class WindowSums {
 public:
  WindowSums(std::size_t regions, core::Step steps_per_window)
      : steps_per_window_(static_cast<std::size_t>(steps_per_window)), loads_(regions) {}

  /// Adds the load of one step. If a step is computed again, its times are those of the first time, and its messages
  /// are added.
  void add(std::size_t region, core::Step step, const StepLoad& load);
  /// The windows that every node has completed.
  std::vector<Window> windows() const;

 private:
  Window window_from(std::size_t first) const;

  std::size_t steps_per_window_;
  std::vector<std::vector<StepLoad>> loads_;  ///< by region and step, from step 1
};

}  // namespace aurasim::lab
