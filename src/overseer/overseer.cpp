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
constexpr auto kLookPeriod = 20ms;
constexpr auto kOverlayPeriod = 200ms;
constexpr auto kGrowPeriod = 2s;        // while a mesh is missing
constexpr double kOldestView_s = 0.25;  // a ray is answered with states that are so much newer than the view, at most

/// A finished node is not waited for, but its bodies are where they are; those of a dead one are gone.
WorldView::RegionState region_state(const dds::SeenStatus& seen) {
  using State = WorldView::RegionState;
  switch (seen.status.state) {
    case dds::NodeState::kRunning:
    case dds::NodeState::kPaused:
    case dds::NodeState::kRecovering:
    case dds::NodeState::kCutOff:
      return seen.lost ? State::kDead : State::kLive;
    case dds::NodeState::kFailed:
      return State::kDead;
    case dds::NodeState::kStarting:
    case dds::NodeState::kWaiting:
    case dds::NodeState::kSpare:
    case dds::NodeState::kFinished:
      return State::kAbsent;
  }
  return State::kAbsent;
}

}  // namespace

Overseer::Overseer(const config::Launch& launch, dds::Participant& participant, dds::ControlBus& control,
                   WebServer& web, CommandSink& sink)
    : launch_(launch),
      agreement_(launch.agreement()),
      participant_(participant),
      control_(control),
      web_(web),
      sink_(sink),
      observer_settings_{launch.regions.version(), static_cast<std::uint32_t>(launch.regions.size()),
                         static_cast<std::uint32_t>(launch.scene.prototypes.size() + core::kRoomForClients)},
      additions_reader_(participant),
      meshes_(participant),
      scene_(launch.scene),
      view_settings_{.region_count = launch.regions.size(),
                     .unclaimed_patience = static_cast<core::Step>(3 * launch.time.step_hz)} {
  replicas_.emplace(participant, observer_settings_);
  view_.emplace(view_settings_);
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
  recording_began_s_ = now_s();
  write_down(ChunkKind::kAbout, recorded_run_text({launch_.scene.name, launch_.step_s(), launch_.observe.tick_hz}));
  write_down(ChunkKind::kScene, scene_text());
  write_down(ChunkKind::kMap, map_message(launch_.regions));
}

/// A full disk ends the recording, not the overseer.
template <class Job>
void Overseer::keep_recording(Job job) {
  if (!recording_) return;
  try {
    job(*recording_, now_s() - recording_began_s_);
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
  write_down(ChunkKind::kScene, text);
}

std::string Overseer::scene_text() const { return scene_message(scene_, published_generation_, removed_statics_); }

/// What clients have added to the scene, once the run shows that generation; again when a mesh has come later.
void Overseer::grow() {
  if (std::optional<dds::SceneAdditions> newest = additions_reader_.take()) {
    additions_ = std::move(newest);
    additions_are_shown_ = false;
  }
  if (!additions_ || additions_->generation != published_generation_) return;
  const bool has_all = has_all_meshes();
  if (additions_are_shown_ && !has_all) return;
  const auto mesh = [this](const core::MeshRef& ref) -> std::optional<core::Shape> {
    const core::TriangleMesh* const found = meshes_.mesh(ref.hash);
    return found == nullptr ? std::nullopt : std::optional(config::shape_for(*found, ref.use));
  };
  scene_ = launch_.scene;
  removed_statics_.clear();
  for (const core::Order& order : additions_->orders) {
    node::extend(scene_, order.action, mesh);
    if (const auto* removed = std::get_if<core::RemoveStatic>(&order.action)) removed_statics_.insert(removed->id);
  }
  additions_are_shown_ = true;
  if (has_all) additions_.reset();
  publish_scene();
}

bool Overseer::has_all_meshes() {
  return std::ranges::all_of(additions_->orders, [this](const core::Order& order) {
    const auto* const defined = std::get_if<core::DefineShape>(&order.action);
    const auto* const ref = defined == nullptr ? nullptr : std::get_if<core::MeshRef>(&defined->shape);
    return ref == nullptr || meshes_.mesh(ref->hash) != nullptr;
  });
}

double Overseer::now_s() const { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

void Overseer::turn() {
  replicas_->wait(kRound);
  look_at_nodes();
  look_at_map();
  for (core::Replica& replica : replicas_->take()) view_->accept(std::move(replica), now_s());
  grow();
  compose_frames();
  serve_commands();
  publish_status();
}

/// The same regions under other processes: the world of the old ones is gone. Whoever takes a region over goes on with
/// it in a later generation.
bool Overseer::run_was_restarted() {
  bool restarted = false;
  for (const auto& [region, seen] : nodes_) {
    const dds::Status& status = seen.status;
    const auto [known, is_first] = pids_.try_emplace(region, status.pid);
    const bool begins_anew = status.generation == 0 || status.generation < view_->generation();
    if (known->second == status.pid || status.state == dds::NodeState::kSpare) continue;
    known->second = status.pid;
    restarted = restarted || begins_anew;
  }
  return restarted;
}

void Overseer::look_at_nodes() {
  if (Clock::now() < next_look_) return;
  next_look_ = Clock::now() + kLookPeriod;
  nodes_.clear();
  for (const auto& [region, seen] : control_.statuses()) {
    if (is_of_this_run(seen) && core::value_of(region) < launch_.regions.size()) nodes_.emplace(region, seen);
  }
  if (run_was_restarted()) {
    view_.emplace(view_settings_);
    replicas_.emplace(participant_, observer_settings_);  // nodes give all that they have to whoever comes
  }
  for (const auto& [region, seen] : nodes_) view_->set_region(region, region_state(seen));
}

/// The run may get other regions or another scene while it goes on.
void Overseer::look_at_map() {
  const dds::WorldMap* newest = nullptr;
  for (const auto& [version, map] : control_.maps()) {
    const bool ours = map.agreement == agreement_ && map.generation > map_generation_;
    if (ours && (newest == nullptr || map.generation > newest->generation)) newest = &map;
  }
  if (newest == nullptr) return;
  map_generation_ = newest->generation;
  try {
    config::Launch changed = launch_;
    if (newest->scene != launch_.scene.name) changed = config::with_scene(changed, newest->scene);
    if (newest->map_version != launch_.regions.version()) changed = config::with_regions(changed, newest->regions);
    launch_ = std::move(changed);
  } catch (const config::BadConfig& error) {
    return spdlog::error("the run has changed to what cannot be read here: {}", error.what());
  }
  observer_settings_.map_version = launch_.regions.version();
  observer_settings_.prototype_count =
      static_cast<std::uint32_t>(launch_.scene.prototypes.size() + core::kRoomForClients);
  replicas_.emplace(participant_, observer_settings_);
  overlays_.forget();
  view_.emplace(view_settings_);
  scene_is_published_ = false;  // also when bodies of this generation have come before the map
  web_.publish(Notice::kMap, map_message(launch_.regions));
  write_down(ChunkKind::kMap, map_message(launch_.regions));
}

void Overseer::compose_frames() {
  bool any = false;
  while (const WorldFrame* frame = view_->compose(now_s())) {
    any = true;
    if (!scene_is_published_ || frame->generation != published_generation_) {
      published_generation_ = frame->generation;
      scene_is_published_ = true;
      scene_ = launch_.scene;
      removed_statics_.clear();
      publish_scene();
      grow();
    }
    web_.show(*frame);
    write_down(*frame);
  }
  if (any || Clock::now() >= next_overlays_) show_overlays();  // also of a run that stands
}

void Overseer::show_overlays() {
  next_overlays_ = Clock::now() + kOverlayPeriod;
  const Show wanted = web_.wanted();
  overlays_.look(participant_, observer_settings_, wanted, scene_, *view_);
  if (!wanted.auras && !wanted.links && !wanted.contacts) return;
  const double ahead_s = (1 + launch_.aura.uncertainty) * launch_.lookahead() * launch_.step_s();
  web_.show_overlays(overlays_.encode(*view_, ahead_s));
}

void Overseer::serve_commands() {
  for (PageRequest& page_request : web_.take_requests()) {
    auto* const request = std::get_if<Request>(&page_request);
    if (request == nullptr) continue;
    if (auto* ray = std::get_if<CastRay>(&request->command)) {
      const double margin_m = launch_.tolerances.speed_m_s * kOldestView_s;
      ray->regions = regions_for_ray({ray->from, ray->to}, launch_.regions, *view_, scene_, margin_m);
    }
    sink_.submit(std::move(*request));
  }
  for (const Reply& reply : sink_.take_replies()) web_.answer(reply);
}

std::string Overseer::state_of_run() const {
  using State = dds::NodeState;
  const auto any = [&](State state) {
    return std::any_of(nodes_.begin(), nodes_.end(), [&](const auto& entry) {
      return entry.second.status.state == state && (state == State::kFinished || !entry.second.lost);
    });
  };
  if (any(State::kRecovering)) return "recovering";
  if (any(State::kRunning)) return "running";
  if (any(State::kPaused)) return "paused";
  if (any(State::kStarting) || any(State::kWaiting) || nodes_.empty()) return "starting";
  return any(State::kFinished) ? "finished" : "lost";
}

void Overseer::measure_hand_offs() {
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - hand_offs_measured_).count();
  if (elapsed_s < 1) return;
  hand_offs_measured_ = Clock::now();
  for (const auto& [region, seen] : nodes_) {
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
  status.nodes = nodes_;
  status.step = std::max<core::Step>(0, view_->stamp());
  for (const auto& [region, seen] : nodes_) {
    if (!seen.lost && seen.status.generation == view_->generation())
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
  const ViewCounters& view = view_->counters();
  std::string text = node_metrics(now);
  const auto add = [&](const char* name, const char* help, std::uint64_t value) {
    text += fmt::format("# HELP aurasim_view_{0} {1}\n# TYPE aurasim_view_{0} counter\naurasim_view_{0} {2}\n", name,
                        help, value);
  };
  add("frames_total", "Frames composed.", view.frames);
  add("incomplete_frames_total", "Frames composed without a region that is alive.", view.incomplete);
  add("lost_ticks_total", "Ticks of a region that never came.", view.gaps);
  add("replicas_total", "Replicas received.", replicas_->received());
  add("refused_replicas_total", "Replicas refused.", replicas_->refused());
  text +=
      fmt::format("# HELP aurasim_view_bodies Bodies seen.\n# TYPE aurasim_view_bodies gauge\naurasim_view_bodies {}\n",
                  view_->body_count());
  web_.set_metrics(std::move(text));
}

}  // namespace aurasim::overseer
