// A run as an observer sees it: its nodes, the launch as the run is now, and its bodies, put together from what the
// nodes publish over DDS. It only receives.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "config/launch.h"
#include "dds/control.h"
#include "dds/replica_bus.h"
#include "overseer/world_view.h"

namespace aurasim::overseer {

/// Used by one thread.
class WorldWatch {
 public:
  /// `participant` and `control` must outlive it.
  WorldWatch(const config::Launch& launch, dds::Participant& participant, dds::ControlBus& control);

  /// Waits at most `time_out` for news, and takes in what has arrived.
  void look(std::chrono::nanoseconds time_out);

  /// The launch as the run is now: a run may get other regions or another scene while it goes on.
  const config::Launch& launch() const { return launch_; }
  /// Hash of the launch that the run began with.
  std::uint64_t agreement() const { return agreement_; }
  const std::map<core::RegionId, messages::SeenStatus>& nodes() const { return nodes_; }
  const dds::ObserverSettings& observer_settings() const { return settings_; }
  const dds::ReplicaReader& replicas() const { return *replicas_; }
  WorldView& view() { return *view_; }
  const WorldView& view() const { return *view_; }

  /// True when the run has got another map or scene since the last call.
  bool take_change() { return std::exchange(changed_, false); }
  /// Newest state of this generation that the region has published; -1: none.
  core::Step published(core::RegionId region, core::Generation generation) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Published {
    core::Generation generation = 0;
    core::Step step = -1;
  };

  void note(const core::Replica& replica);

  void look_at_nodes();
  void look_at_map();
  bool run_was_restarted();
  void watch_anew();

  config::Launch launch_;
  std::uint64_t agreement_;
  dds::Participant& participant_;
  dds::ControlBus& control_;
  dds::ObserverSettings settings_;
  ViewSettings view_settings_;
  std::optional<dds::ReplicaReader> replicas_;
  std::optional<WorldView> view_;
  std::map<core::RegionId, messages::SeenStatus> nodes_;
  std::map<core::RegionId, std::uint32_t> pids_;
  std::map<core::RegionId, Published> published_;
  core::Generation map_generation_ = 0;
  bool changed_ = false;
  Clock::time_point next_look_;
};

/// Seconds of the clock that WorldView is given.
double view_clock_s();

}  // namespace aurasim::overseer
