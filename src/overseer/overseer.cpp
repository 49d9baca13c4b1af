#include "overseer/overseer.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "config/launch_variants.h"
#include "config/meshes.h"
#include "core/command.h"
#include "node/scene_additions.h"
#include "overseer/ray_regions.h"
#include "overseer/replay.h"

namespace aurasim::overseer {

using namespace std::chrono_literals;
using core::RegionId;

namespace {

constexpr auto kRound = 5ms;
constexpr auto kStatusPeriod = 250ms;
constexpr auto kOverlayPeriod = 200ms;
constexpr auto kMovesPeriod = 50ms;
constexpr auto kGrowPeriod = 2s;        // retry period while a mesh is missing
constexpr double kOldestView_s = 0.25;  // a ray is answered with states that are newer than the view by at most this

}  // namespace

Overseer::Overseer(const config::Launch& launch, dds::Participant& participant, dds::ControlBus& control,
                   WebServer& web, CommandSink& sink)
    : participant_(participant),
      web_(web),
      sink_(sink),
      watch_(launch, participant, control),
      additions_reader_(participant),
      meshes_(participant),
      scene_(launch.scene) {
  Hello hello;
  hello.scene = launch.scene.name;
  hello.step_s = launch.step_s();
  hello.tick_hz = launch.observe.tick_hz;
  web_.publish(Notice::kHello, hello_message(hello));
  publish_scene();
  web_.publish(Notice::kMap, map_message(launch.regions));
}

void Overseer::record(const std::filesystem::path& file) {
  recording_.emplace(file);
  recording_began_s_ = view_clock_s();
  write_down(ChunkKind::kAbout, recorded_run_text({watch_.launch().scene.name, watch_.launch().step_s(),
                                                   watch_.launch().observe.tick_hz}));
  write_down(ChunkKind::kScene, scene_text());
  write_down(ChunkKind::kMap, map_message(watch_.launch().regions));
}

/// Runs `job` on the recording. A full disk ends the recording, not the overseer.
template <class Job>
void Overseer::keep_recording(Job job) {
  if (!recording_) return;
  try {
    job(*recording_, view_clock_s() - recording_began_s_);
  } catch (const BadRecording& error) {
    spdlog::error("recording ends: {}", error.what());
    recording_.reset();
  }
}

void Overseer::write_down(ChunkKind kind, const std::string& text) {
  keep_recording([&](RecordingWriter& recording, double time_s) { recording.write(kind, text, time_s); });
}

void Overseer::write_down(const WorldFrame& frame) {
  keep_recording([&](RecordingWriter& recording, double time_s) { recording.write(frame, time_s); });
}

void Overseer::publish_scene() {
  const std::string text = scene_text();
  web_.publish(Notice::kScene, text);
  moves_have_changed_ = !static_moves_.empty();
  write_down(ChunkKind::kScene, text);
}

std::string Overseer::scene_text() const { return scene_message(scene_, published_generation_, removed_statics_); }

/// Publishes moved statics, at a limited rate, because programs may move a static in every state. Frames are shown
/// later than this.
void Overseer::publish_moves() {
  if (!moves_have_changed_ || Clock::now() < next_moves_) return;
  next_moves_ = Clock::now() + kMovesPeriod;
  moves_have_changed_ = false;
  const std::string text = moves_message(published_generation_, static_moves_);
  web_.publish(Notice::kMoves, text);
  write_down(ChunkKind::kMoves, text);
}

/// Takes clients' scene additions into the scene once the run shows their generation, and again when a mesh arrives
/// later.
void Overseer::grow() {
  if (std::optional<dds::SceneAdditions> newest = additions_reader_.take()) {
    additions_ = std::move(newest);
    additions_are_shown_ = false;
  }
  publish_moves();
  if (!additions_ || additions_->generation != published_generation_) return;
  const bool has_all = has_all_meshes();
  if (additions_are_shown_ && !has_all) return;
  const auto lasting = take_moves();
  additions_are_shown_ = true;
  const bool is_known = has_all && grown_by_ == lasting;
  if (!is_known) grow_by(additions_->orders);
  if (has_all) grown_by_ = lasting;
  if (has_all) additions_.reset();
}

/// Takes the moves of statics out of the orders. Returns the numbers of all other orders.
std::vector<std::uint64_t> Overseer::take_moves() {
  std::vector<std::uint64_t> others;
  static_moves_.clear();
  for (const core::Order& order : additions_->orders) {
    if (std::holds_alternative<core::MoveStatic>(order.action)) {
      static_moves_.push_back(order);
    } else {
      others.push_back(order.sequence);
    }
  }
  moves_have_changed_ = true;
  return others;
}

void Overseer::grow_by(std::span<const core::Order> orders) {
  const auto mesh = [this](const core::MeshRef& ref) -> std::optional<core::Shape> {
    const core::TriangleMesh* const found = meshes_.mesh(ref.hash);
    return found == nullptr ? std::nullopt : std::optional(config::shape_for(*found, ref.use));
  };
  scene_ = watch_.launch().scene;
  removed_statics_.clear();
  for (const core::Order& order : orders) {
    node::extend(scene_, order.action, mesh);
    if (const auto* removed = std::get_if<core::RemoveStatic>(&order.action)) removed_statics_.insert(removed->id);
  }
  publish_scene();
}

bool Overseer::has_all_meshes() {
  return std::ranges::all_of(additions_->orders, [this](const core::Order& order) {
    const auto* const defined = std::get_if<core::DefineShape>(&order.action);
    const auto* const ref = defined == nullptr ? nullptr : std::get_if<core::MeshRef>(&defined->shape);
    return ref == nullptr || meshes_.mesh(ref->hash) != nullptr;
  });
}

void Overseer::turn() {
  watch_.look(kRound);
  if (watch_.take_change()) show_change();
  grow();
  compose_frames();
  serve_commands();
  publish_status();
}

/// Shows that the run has got other regions or another scene.
void Overseer::show_change() {
  overlays_.forget();
  scene_is_published_ = false;  // also needed when bodies of this generation arrived before the map
  const std::string map = map_message(watch_.launch().regions);
  web_.publish(Notice::kMap, map);
  write_down(ChunkKind::kMap, map);
}

void Overseer::compose_frames() {
  bool any = false;
  while (const WorldFrame* frame = watch_.view().compose(view_clock_s())) {
    any = true;
    if (!scene_is_published_ || frame->generation != published_generation_) {
      published_generation_ = frame->generation;
      scene_is_published_ = true;
      scene_ = watch_.launch().scene;
      removed_statics_.clear();
      static_moves_.clear();
      grown_by_.clear();
      moves_have_changed_ = true;
      publish_scene();
      grow();
    }
    web_.show(*frame);
    write_down(*frame);
  }
  if (any || Clock::now() >= next_overlays_) show_overlays();  // also while the run is paused
}

void Overseer::show_overlays() {
  next_overlays_ = Clock::now() + kOverlayPeriod;
  const Show wanted = web_.wanted();
  overlays_.look(participant_, watch_.observer_settings(), wanted, scene_, watch_.view());
  if (!wanted.auras && !wanted.links && !wanted.contacts) return;
  const double ahead_s = (1 + watch_.launch().uncertainty()) * watch_.launch().lookahead() * watch_.launch().step_s();
  web_.show_overlays(overlays_.encode(watch_.view(), ahead_s));
}

void Overseer::serve_commands() {
  for (PageRequest& page_request : web_.take_requests()) {
    auto* const request = std::get_if<Request>(&page_request);
    if (request == nullptr) continue;
    auto* const command = std::get_if<core::Ask>(&request->ask.what);
    if (auto* ray = command != nullptr ? std::get_if<core::Ray>(command) : nullptr) {
      const double margin_m = watch_.launch().tolerances.speed_m_s * kOldestView_s;
      ray->regions =
          regions_for_ray({ray->from_W, ray->to_W}, watch_.launch().regions, watch_.view(), scene_, margin_m);
    }
    sink_.submit(std::move(*request));
  }
  for (const Reply& reply : sink_.take_replies()) web_.answer(reply);
}

std::string Overseer::state_of_run() const {
  using State = messages::NodeState;
  const auto any = [&](State state) {
    return std::any_of(watch_.nodes().begin(), watch_.nodes().end(), [&](const auto& entry) {
      return entry.second.status.state == state && (state == State::kFinished || !entry.second.lost);
    });
  };
  if (any(State::kRecovering)) return "recovering";
  if (any(State::kRunning)) return "running";
  if (any(State::kPaused)) return "paused";
  if (any(State::kStarting) || any(State::kWaiting) || watch_.nodes().empty()) return "starting";
  return any(State::kFinished) ? "finished" : "lost";
}

void Overseer::measure_hand_offs() {
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - hand_offs_measured_).count();
  if (elapsed_s < 1) return;
  hand_offs_measured_ = Clock::now();
  for (const auto& [region, seen] : watch_.nodes()) {
    HandOffs& known = hand_offs_[region];
    const std::uint64_t count = seen.status.hand_offs_out;
    known.per_s = count >= known.count ? static_cast<double>(count - known.count) / elapsed_s : 0;
    known.count = count;
  }
}

RunStatus Overseer::status() {
  measure_hand_offs();
  RunStatus status;
  status.state = state_of_run();
  status.clients = web_.counters().clients;
  status.nodes = watch_.nodes();
  status.step = std::max<core::Step>(0, watch_.view().stamp());
  for (const auto& [region, seen] : watch_.nodes()) {
    if (!seen.lost && seen.status.generation == watch_.view().generation())
      status.step = std::max(status.step, seen.status.step);
    if (!seen.lost) status.rate = seen.status.rate;
    status.hand_offs_per_s[region] = hand_offs_[region].per_s;
  }
  return status;
}

void Overseer::publish_status() {
  if (Clock::now() < next_status_) return;
  next_status_ = Clock::now() + kStatusPeriod;
  const RunStatus now = status();
  const std::string message = status_message(now);
  web_.publish(Notice::kStatus, message);
  write_down(ChunkKind::kStatus, message);
  const ViewCounters& view = watch_.view().counters();
  std::string text = node_metrics(now);
  const auto add = [&](const char* name, const char* help, std::uint64_t value) {
    text += fmt::format("# HELP aurasim_view_{0} {1}\n# TYPE aurasim_view_{0} counter\naurasim_view_{0} {2}\n", name,
                        help, value);
  };
  add("frames_total", "Frames composed.", view.frames);
  add("incomplete_frames_total", "Frames composed without a region that is alive.", view.incomplete);
  add("lost_ticks_total", "Ticks of a region that never came.", view.gaps);
  add("replicas_total", "Replicas received.", watch_.replicas().received());
  add("refused_replicas_total", "Replicas refused.", watch_.replicas().refused());
  text +=
      fmt::format("# HELP aurasim_view_bodies Bodies seen.\n# TYPE aurasim_view_bodies gauge\naurasim_view_bodies {}\n",
                  watch_.view().body_count());
  web_.set_metrics(std::move(text));
}

}  // namespace aurasim::overseer
