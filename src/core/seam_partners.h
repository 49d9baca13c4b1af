// Which coupled regions exchange parcels in a step (docs/design.md, "Coupled regions"). Regions near each other always
// do. Where a body may get to regions beyond, or may form chains of contacts over several, its host says so in the
// batch of the state before. All nodes come to know what all have said before they begin the step
// (node/seam_gathering.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/block_owners.h"
#include "core/introduction.h"

namespace aurasim::core {

class SeamPartners {
 public:
  explicit SeamPartners(const BlockOwners& owners);

  /// Begins a step. `pairs`: what all hosts have said in the state before. Regions that pairs connect, also by way of
  /// others, exchange parcels, each with each.
  void begin(std::span<const Introduction> pairs);

  /// Do two regions exchange parcels in this step?
  bool are_partners(RegionId a, RegionId b) const;

  /// May a chain of contacts in this step have bodies of both regions though no body of the one touches one of the
  /// other? It may for regions that pairs connect, and for two of three or more that share a corner of blocks.
  bool may_share_chains(RegionId a, RegionId b) const;

 private:
  std::uint32_t group(RegionId region) const;
  std::size_t index(RegionId a, RegionId b) const { return value_of(a) * count_ + value_of(b); }

  std::size_t count_;
  std::vector<bool> are_near_;          ///< by index(), as the next
  std::vector<bool> share_corners_;     ///< with a third region
  std::vector<std::uint32_t> parents_;  ///< by region: another one of its group; itself for the first
};

}  // namespace aurasim::core
