// Trials over DDS in real time. The nodes stay up between trials, and pairs of one series fly side by side, far enough
// apart not to hear of each other: as many worlds in one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "lab/campaign.h"
#include "lab/real_cluster.h"

namespace aurasim::lab {

/// Used by one thread.
class RealLaboratory {
 public:
  /// `domain`: of DDS, for this laboratory alone.
  RealLaboratory(std::uint32_t domain, std::filesystem::path profiles);
  ~RealLaboratory();

  /// As lab::run_job. A violation counts for every pair that flies in the same run.
  std::vector<Trial> run_job(const Campaign& campaign, const Job& job);

 private:
  RealCluster& cluster_for(const core::RegionMap& map, const Conditions& conditions);

  std::uint32_t domain_;
  std::filesystem::path profiles_;
  std::unique_ptr<RealCluster> cluster_;
  RealNetwork network_;            ///< of the nodes that are up
  std::uint64_t map_version_ = 0;  ///< likewise
};

/// Pairs that fly at the same time.
inline constexpr std::uint32_t kPairsAtOnce = 10;

}  // namespace aurasim::lab
