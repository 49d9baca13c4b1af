// Measures round trips between nodes before a run starts (topic probe). The node of region 0, the lead, asks, and each
// other one answers at once. Nothing is sent again, so lost messages show.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/ids.h"
#include "dds/participant.h"

namespace aurasim::dds {

class RoundTrips {
 public:
  struct Answer {
    core::RegionId region{};
    std::uint32_t number = 0;  ///< of the question
  };

  /// The lead gets endpoints for each other region, and each other region for the lead. The participant must outlive
  /// this object.
  RoundTrips(Participant& participant, core::RegionId self, std::uint32_t region_count, std::uint64_t map_version);
  ~RoundTrips();

  /// Sends a question to a region. For the lead.
  void ask(core::RegionId region, std::uint32_t number);
  /// Answers to the lead that have come since the last call.
  std::vector<Answer> take_answers();
  /// Answers the questions that have come since the last call. For each node but the lead.
  void answer();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::dds
