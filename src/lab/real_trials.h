// Trials over DDS in real time. The nodes stay up between trials. Pairs of one series fly side by side, so far apart
// that they do not affect each other, as if each had its own world.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "lab/campaign.h"
#include "lab/real_cluster.h"

namespace aurasim::lab {

/// May be used by one thread only.
class RealLaboratory {
 public:
  /// `domain`: DDS domain, used by this laboratory alone.
  RealLaboratory(std::uint32_t domain, std::filesystem::path profiles);
  ~RealLaboratory();

  /// As lab::run_job. A violation counts for every pair that flies in the same run.
  std::vector<Trial> run_job(const Campaign& campaign, const Job& job);

 private:
  RealCluster& cluster_for(const core::RegionMap& map, const Conditions& conditions);

  std::uint32_t domain_;
  std::filesystem::path profiles_;
  std::unique_ptr<RealCluster> cluster_;
  RealNetwork network_;            ///< network of the running nodes
  std::uint64_t map_version_ = 0;  ///< of the map that the running nodes have
};

/// Number of pairs that fly at the same time.
inline constexpr std::uint32_t kPairsAtOnce = 10;

}  // namespace aurasim::lab
