// One process of a simulated run whose network breaks (outage_sim.h), with the program's own roster, fence and
// recovery.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "outage_sim.h"

namespace aurasim::process::test {

inline dds::Guid guid_of(std::uint64_t process, std::uint32_t host) {
  dds::Guid guid;
  guid.guidPrefix.value[0] = static_cast<unsigned char>(process >> 8U);
  guid.guidPrefix.value[1] = static_cast<unsigned char>(process);
  guid.guidPrefix.value[3] = static_cast<unsigned char>(host);
  guid.entityId = 0x102U;
  return guid;
}

/// What one process hears of another.
struct HeardProcess {
  Time last{};
  bool lost = true;
  bool is_stuck = false;                    ///< lost here and not there: Fast DDS does not match such a pair again
  Time whole_since{};                       ///< the link to it
  std::chrono::milliseconds until_found{};  ///< that long after the link is whole
  core::Step step = -1;                     ///< newest batch, of `generation`
  core::Generation generation = 0;
};

struct OutageSim::Process {
  Process(std::uint64_t id_in, std::uint32_t host_in, core::RegionId region_in, std::uint32_t regions_in)
      : id(id_in),
        host(host_in),
        region(region_in),
        regions(regions_in),
        writer(guid_of(id, host)),
        fence({region, regions, true, false}, [this] { return signs(); }),
        recovery({region, regions, std::chrono::seconds(20), true, false, kCheckpointSteps}) {
    roster.emplace(dds::RosterSettings{regions, 1, 1, region, writer, false}, speakers);
    status.region = region;
    status.process = id;
    status.run = status.agreement = 1;
  }

  std::map<core::RegionId, node::PeerSign> signs() {
    std::map<core::RegionId, node::PeerSign> signs;
    for (std::uint32_t r = 0; r < regions; ++r) {
      if (core::RegionId{r} != region) signs[core::RegionId{r}].lost = true;
    }
    for (const auto& [other, seen] : nodes) {
      if (other != region) signs[other] = {seen.lost, seen.dead || seen.has_ended(), seen.seen};
    }
    return signs;
  }
  core::Generation current() const { return restoration.newest(generation); }

  std::uint64_t id;
  std::uint32_t host;
  core::RegionId region;
  std::uint32_t regions;
  dds::Guid writer;
  dds::Speakers speakers;
  std::optional<dds::NodeRoster> roster;
  Fence fence;
  Recovery recovery;
  Phase phase = Phase::kRuns;
  bool knows_world = true;
  core::Generation generation = 0;
  core::Step step = 0;
  messages::Status status;
  SeenNodes nodes;
  std::map<std::uint64_t, HeardProcess> heard;  ///< by process
  std::map<core::RegionId, std::set<core::Step>> parts;
  std::vector<core::RegionId> keepers;
  std::map<core::RegionId, std::set<core::Step>> unsent;  ///< own parts, by keeper
  Restoration restoration;
  std::set<core::RegionId> given;  ///< regions whose parts have come, for the generation of the restore
  Time deadline{};
  bool is_started = false;
  std::set<core::RegionId> silent;  ///< streams that have ended since `generation` began
};

}  // namespace aurasim::process::test
