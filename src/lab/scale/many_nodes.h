// Costs of a node in a world that grows with the number of nodes: hundreds of nodes in virtual time, in one thread.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "lab/scale/rain_run.h"

namespace aurasim::lab {

struct ManyNodes {
  std::size_t side = 8;         ///< the regions are a grid of side x side, each of 80 m x 80 m
  double run_s = 3;             ///< length of the run, simulated seconds
  double bodies_per_node = 20;  ///< that fall into the world until the end, half of them near borders
  bool coupled = false;         ///< regions are coupled; else with auras
  std::size_t deaths = 0;       ///< nodes that die half way, all at once; the run then goes on from the newest cut

  std::size_t nodes() const { return side * side; }
};

/// Means over all nodes and all states of the second half of the run.
struct NodeCosts {
  double messages = 0;  ///< copies of batches, hand-offs and answers that a node sends in a step; parcels, if coupled
  double bytes = 0;     ///< of these, coded as for DDS
  double physics_us = 0, protocol_us = 0, transport_us = 0;  ///< CPU time of a step; transport: coding, without sockets
  double memory_kB = 0;    ///< memory of a node at the end, with its share of the network that is under way
  double bodies = 0;       ///< of a node at the end
  double hand_offs = 0;    ///< of a node and second
  std::uint64_t hash = 0;  ///< of the world in the last state
  std::size_t redos = 0;
};

/// Nothing when `shown` returned false. `shown(share)` is called now and then with the share of the run that is done.
std::optional<NodeCosts> measure_many_nodes(const ManyNodes& many, const RainPlace& place,
                                            const std::function<bool(double)>& shown);

}  // namespace aurasim::lab
