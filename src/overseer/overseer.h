// The gateway between a run and the pages that watch it: puts the world together from what the nodes publish over DDS,
// and hands frames, texts and commands to and fro. Listens only: the nodes do not notice whether it is there.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "config/launch.h"
#include "dds/control.h"
#include "dds/scene_additions_bus.h"
#include "overseer/commands.h"
#include "overseer/overlay_view.h"
#include "overseer/page_messages.h"
#include "overseer/recording.h"
#include "overseer/web_server.h"
#include "overseer/world_watch.h"

namespace aurasim::overseer {

/// Used by one thread.
class Overseer {
 public:
  /// All arguments must outlive the overseer.
  Overseer(const config::Launch& launch, dds::Participant& participant, dds::ControlBus& control, WebServer& web,
           CommandSink& sink);

  /// Starts to record what is published to pages. Throws BadRecording when the file cannot be written.
  void record(const std::filesystem::path& file);

  /// Runs one round: waits a few milliseconds for news and passes it on.
  void turn();

 private:
  using Clock = std::chrono::steady_clock;

  void publish_scene();
  std::string scene_text() const;
  void grow();
  std::vector<std::uint64_t> take_moves();
  void grow_by(std::span<const core::Order> orders);
  void publish_moves();
  bool has_all_meshes();
  void write_down(ChunkKind kind, const std::string& text);
  void write_down(const WorldFrame& frame);
  template <class Job>
  void keep_recording(Job job);
  void show_change();
  void compose_frames();
  void show_overlays();
  void serve_commands();
  void publish_status();
  RunStatus status();
  std::string state_of_run() const;
  void measure_hand_offs();

  dds::Participant& participant_;
  WebServer& web_;
  CommandSink& sink_;
  WorldWatch watch_;
  dds::SceneAdditionsReader additions_reader_;
  dds::MeshReader meshes_;
  core::Scene scene_;  ///< the scene with the scene additions so far
  std::set<core::StaticId> removed_statics_;
  std::vector<core::Order> static_moves_;
  bool moves_have_changed_ = false;  ///< moves have changed since they were last published
  Clock::time_point next_moves_;
  std::vector<std::uint64_t> grown_by_;  ///< numbers of orders that scene_ contains
  /// Additions that wait until their generation is shown and all their meshes are here.
  std::optional<dds::SceneAdditions> additions_;
  bool additions_are_shown_ = false;  ///< additions_ are shown with balls in the place of missing meshes
  OverlayView overlays_;
  core::Generation published_generation_ = 0;
  bool scene_is_published_ = true;  ///< the scene of published_generation_ and of the newest map was published
  std::optional<RecordingWriter> recording_;
  double recording_began_s_ = 0;
  struct HandOffs {
    std::uint64_t count = 0;
    double per_s = 0;
  };
  std::map<core::RegionId, HandOffs> hand_offs_;
  Clock::time_point hand_offs_measured_;
  Clock::time_point next_status_;
  Clock::time_point next_overlays_;
};

}  // namespace aurasim::overseer
