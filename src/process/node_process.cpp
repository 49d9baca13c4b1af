#include "process/node_process.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "core/command.h"
#include "dds/random_id.h"
#include "host/heartbeat.h"
#include "host/stop_signal.h"
#include "process/long_step.h"
#include "setup/guard_log.h"
#include "setup/key_choice.h"
#include "setup/launch_setup.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

void log_impairment(const dds::Participant& participant) {
  const auto report = participant.impairment();
  if (!report) return;
  const auto& [by, datagrams] = *report;
  spdlog::info(
      "impaired network: delay {:.3g} ms, jitter {:.3g} ms, loss {:.3g}, bandwidth {}, reorder {}, "
      "discovery {}, seed {}; datagrams passed {}, delayed {}, lost {}, overflowed {}, still queued {}",
      1e3 * by.delay_s, 1e3 * by.jitter_s, by.loss,
      by.bandwidth_B_s > 0 ? fmt::format("{:.4g} B/s", by.bandwidth_B_s) : "unlimited", by.reorder, by.discovery,
      by.seed, datagrams.passed, datagrams.delayed, datagrams.lost, datagrams.overflowed, datagrams.queued);
}

RecoverySettings recovery_settings(const config::Launch& launch, const NodeOptions& options, bool can_be_cut) {
  RecoverySettings settings;
  settings.region = options.region;
  settings.regions = static_cast<std::uint32_t>(launch.regions.size());
  settings.patience =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(launch.survival.patience_s));
  settings.can_be_cut = can_be_cut;
  settings.has_launcher = options.has_launcher;
  settings.checkpoint_steps = launch.checkpoint_steps();
  return settings;
}

/// DDS settings of a node. A launcher on this host that receives the heartbeat knows which of its processes live, and
/// ends those that hang; then nothing else judges that.
dds::Settings settings_of_node(const config::Launch& launch, const NodeOptions& options) {
  dds::Settings settings = setup::with_keys(setup::dds_settings(launch, options.region), launch,
                                            setup::member_for_node(launch, options.as, options.region));
  const bool is_watched = options.has_launcher && options.heartbeat >= 0;
  settings.believes_silence = !is_watched;
  settings.show_life = [heartbeat = host::Heartbeat(options.heartbeat)] { heartbeat.beat(); };
  return settings;
}

double milliseconds(Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

}  // namespace

dds::TransportSettings neighbour_transport(const config::Launch& launch, core::RegionId region) {
  dds::TransportSettings settings;
  settings.region = region;
  settings.neighbours = launch.regions.neighbours(region, setup::listening_distance_m(launch));
  settings.map_version = launch.regions.version();
  settings.region_count = static_cast<std::uint32_t>(launch.regions.size());
  settings.prototype_count = static_cast<std::uint32_t>(launch.scene.prototypes.size() + core::kRoomForClients);
  settings.static_count = static_cast<std::uint32_t>(launch.scene.statics.size() + core::kRoomForClients);
  settings.joint_count = static_cast<std::uint32_t>(launch.scene.joints.size() + core::kRoomForClients);
  return settings;
}

NodeProcess::NodeProcess(const config::Launch& launch, const NodeOptions& options)
    : launch_(launch),
      options_(options),
      participant_(std::make_unique<dds::Participant>(settings_of_node(launch, options))),
      control_(*participant_, {launch.regions.version(), options.region, launch.agreement(), options.run,
                               static_cast<std::uint32_t>(launch.regions.size())}),
      fence_(fence_settings(), [this] { return peer_signs(); }),
      saving_(launch_, options_),
      pacer_(launch.step_s(), launch.time.pace == config::Pace::kWall),
      recovery_(recovery_settings(launch, options, !participant_->stays_on_this_host())) {
  status_.region = options.region;
  status_.run = options.run;
  status_.pid = static_cast<std::uint32_t>(::getpid());
  status_.process = dds::draw_id();
  status_.map_version = launch.regions.version();
  status_.agreement = launch.agreement();
  status_.footprint = launch.regions.region(options.region);
  status_.lookahead = launch.lookahead();
  stop_at_ = options.steps;
}

FenceSettings NodeProcess::fence_settings() const {
  FenceSettings settings;
  settings.region = options_.region;
  settings.regions = static_cast<std::uint32_t>(launch_.regions.size());
  settings.can_be_cut = !participant_->stays_on_this_host();
  settings.never_waits = launch_.time.sync == core::SyncMode::kFreeRunning;
  return settings;
}

/// Signs of all regions. A region whose node was never heard since this process joined DDS (meet_anew) counts as lost.
std::map<core::RegionId, node::PeerSign> NodeProcess::peer_signs() {
  std::map<core::RegionId, node::PeerSign> signs;
  for (std::uint32_t r = 0; r < launch_.regions.size(); ++r) {
    if (core::RegionId{r} != options_.region) signs[core::RegionId{r}].lost = true;
  }
  for (const auto& [region, seen] : control_.statuses()) {
    const bool left = seen.dead || seen.has_ended();
    if (region != options_.region) signs[region] = {seen.lost, left, seen.seen};
  }
  return signs;
}

bool NodeProcess::fence_is_open() { return fence_.open(node_->protocol().intake().dead_regions(), Clock::now()); }

command_line::ExitCode NodeProcess::run() {
  try {
    const command_line::ExitCode code = meet_and_run();
    participant_->flush_delayed();  // this process leaves without destroying its endpoints, so delayed messages would
                                    // never be sent
    log_impairment(*participant_);
    setup::log_refusals(*participant_);
    return code;
  } catch (const std::exception& error) {
    if (phase_ != NodePhase::kListening) {
      phase_ = NodePhase::kRefused;
      publish(error.what());
    }
    throw;
  }
}

command_line::ExitCode NodeProcess::meet_and_run() {
  if (options_.takes_over) return take_over();
  if (!domain_is_free()) return not_begun();
  enter(NodeEvent::kFree);
  publish_map(generation_, first_step());
  publish();
  transport_.emplace(*participant_, transport_settings());
  observers_.emplace(launch_, *participant_, options_.region);
  command_server_.emplace(launch_, *participant_, options_.region, options_.saves);
  programs_.emplace(*participant_);
  open_ros2();
  served_map_ = launch_.regions.version();
  checkpoints_.emplace(*participant_, options_.region);
  if (!meet_neighbours() || !wait_for_start()) return not_begun();
  compare_clocks();
  begin_generation(start_->generation, *start_);
  return run_steps();
}

bool NodeProcess::comes_back_as_spare() const {
  return fence_.closed() && !options_.has_launcher && launch_.survival.on_death == config::OnDeath::kRecover;
}

/// Takes over the region of a dead node. The other nodes wait in a recovery.
command_line::ExitCode NodeProcess::take_over() {
  checkpoints_.emplace(*participant_, options_.region);
  recover("takes the region over");
  if (fence_.closed()) return refuse(fence_.reason());
  if (!node_ && !broken_off_.empty()) return end_without_world();
  return node_ ? run_steps() : not_begun();
}

dds::TransportSettings NodeProcess::transport_settings() {
  dds::TransportSettings settings = neighbour_transport(launch_, options_.region);
  settings.life = life_;
  settings.is_busy = [this](core::RegionId region) {
    const auto seen = control_.statuses().find(region);
    return seen != control_.statuses().end() && long_step(seen->second, Clock::now());
  };
  return settings;
}

command_line::ExitCode NodeProcess::refuse(const std::string& why) {
  spdlog::error("{}", why);
  const bool is_known = phase_ != NodePhase::kListening;  // before that, another process may have the region
  enter(NodeEvent::kRefusal);
  if (is_known) publish(why);
  return command_line::ExitCode::kRefused;
}

command_line::ExitCode NodeProcess::not_begun() {
  if (phase_ == NodePhase::kRefused) return command_line::ExitCode::kRefused;
  const bool is_known = phase_ != NodePhase::kListening;
  enter(NodeEvent::kLast);
  if (is_known) publish();
  return command_line::ExitCode::kOk;
}

void NodeProcess::enter(NodeEvent event) {
  const std::optional<NodePhase> next = next_phase(phase_, event);
  if (!next) throw std::logic_error(fmt::format("node: '{}' while {}", name_of(event), name_of(phase_)));
  phase_ = *next;
}

std::unique_ptr<node::Node> NodeProcess::make_node() {
  node::NodeSetup setup = setup::node_setup(launch_, options_.region, generation_);
  setup.hash_states = options_.report.has_value();
  if (options_.world) command_server_->bring(options_.world->meshes);
  return std::make_unique<node::Node>(setup, launch_.scene, launch_.regions, *transport_);
}

void NodeProcess::begin_generation(core::Generation generation, const messages::RunCommand& begin) {
  core::Inbox mail = node_ ? std::move(node_->mail()) : core::Inbox{};
  generation_ = status_.era = generation;
  checkpoints_->begin_era(generation);
  node_ = make_node();
  node_->accept_early_mail(std::move(mail));
  command_server_->begin_generation(*node_, generation);
  recorder_.reset();  // the old recorder must not write its last rows into the new one's files
  if (options_.report) recorder_.emplace(*options_.report, options_.region);
  pacer_.set_epoch(first_step(), begin.epoch_ns, begin.clock_ahead, node::read_clocks());
  hold_at_.reset();
  awaited_words_.clear();
  paused_ = {};
  begin_with(options_.world ? node_->start(*options_.world) : node_->start());
  began_ = std::max(pacer_.due(first_step()), Clock::now());
}

/// To be called when the first state of a generation is there.
void NodeProcess::begin_with(const node::StepReport& report) {
  run_orders_.clear();
  stops_standing_ = false;
  run_control_limits_.begin(node_->current_step(), Clock::now());
  if (recovers()) host::let_sigterm_ask_to_leave(options_.has_launcher);
  hurry_until_ = 0;
  refusals_noted_ = 0;
  frame_times_.clear();
  saving_.begin(start_->request, generation_, node_->current_step());
  if (launch_.regions.size() > 1) checkpoints_->use_keepers(keepers(), life_);
  observers_->begin_generation(generation_);
  observers_->after_step(*node_, report);
  record(node_->confirmed());
  command_server_->after_step(report);
  saving_.plan_checkpoint(*node_);
}

void NodeProcess::record(std::span<const node::StepReport> reports) {
  for (const node::StepReport& report : reports) {
    note_faults(report);
    unbearable_setpoints_ += report.unbearable;
    if (!report.put_back_from) saving_.note_recorded(report.step);
    const auto times = frame_times_.find(report.step);
    if (recorder_) recorder_->write(report, times != frame_times_.end() ? times->second : records::FrameTimes{});
    if (times != frame_times_.end() && !report.put_back_from) frame_times_.erase(times);
  }
}

command_line::ExitCode NodeProcess::run_steps() {
  for (;;) {
    try {
      run_until_end();
      const bool leaves = leaves_now() || (leaves_by_ && can_leave_to_others());
      return leaves && broken_off_.empty() ? leave_to_successor() : end();
    } catch (const SomebodyDied& died) {
      if (recovers()) {
        recover(died.what());
      } else {
        break_off(died.what());
      }
      if (!node_ && !broken_off_.empty()) return end_without_world();
    }
  }
}

void NodeProcess::run_until_end() {
  while (!finished() && !leaves_now()) {
    leave_if_asked();
    obey_early_commands();
    execute_commands();
    look_for_deaths();
    obey_late_commands();
    serve_clients();
    keep_parts();
    if (reset_if_due() || change_if_due()) continue;
    tell_ros2();
    hear_programs();
    if (!wait_until_due()) continue;  // true: the step is due without waiting
    look_for_deaths();
    compute_step();
    saving_.plan_checkpoint(*node_);
  }
}

/// True when the next state is due, allowed and everything it needs is here. Returns often, so that commands are
/// received.
bool NodeProcess::wait_until_due() {
  const core::Step next = node_->current_step() + 1;
  const auto begin = Clock::now();
  if (hold_at_) hold_at_ = pause_follower_.holds_at(*hold_at_, farthest_paused_step(), begin);
  if (hold_at_ && node_->current_step() >= *hold_at_) {
    if (phase_ != NodePhase::kPaused) enter(NodeEvent::kHeld);
    publish();
    node_->ready();
    observers_->while_paused(*node_);
    // Observers wait for the states of bodies that are under way to this node.
    if (node_->has_all_until(node_->current_step())) {
      control_.wait(20ms);
    } else {
      transport_->wait_for_arrival(2ms);
    }
    fence_is_open();
    paused_ += Clock::now() - begin;
    return false;
  }
  if (phase_ == NodePhase::kPaused) enter(NodeEvent::kGoesOn);
  if (!has_heard_what_steps_name()) {
    control_.wait(20ms);
    return false;
  }
  if (const std::chrono::nanoseconds until = time_until(next); until > 0ns) {
    transport_->wait_for_arrival(std::min<std::chrono::nanoseconds>(until, 20ms));
    node_->ready();
    publish_running();
    return false;
  }
  const bool complete = node_->ready();
  note_refusals();
  if (fence_is_open() && complete) return true;
  transport_->wait_for_arrival(20ms);
  wait_ms_ += milliseconds(Clock::now() - begin);
  note_waiting();
  publish_running();
  return false;
}

/// The latest state in which a node of this world is paused.
core::Step NodeProcess::farthest_paused_step() {
  core::Step farthest = 0;
  for (const auto& [region, seen] : control_.statuses()) {
    const messages::Status& status = seen.status;
    const bool is_paused = status.state == messages::NodeState::kPaused && status.generation == generation_;
    if (is_paused && seen.is_live()) farthest = std::max(farthest, status.step);
  }
  return farthest;
}

void NodeProcess::compute_step() {
  const auto is_gone = [](const auto& entry) { return entry.second.lost && entry.second.has_ended(); };
  if (std::ranges::any_of(control_.statuses(), is_gone)) node_->give_up_redo();
  const auto begin = Clock::now();
  keep_the_end();
  const node::StepReport& report = node_->step();
  control_.note_state();
  programs_->note_state();
  if (report.put_back_from) return note_redo(report);
  saving_.look_at_doubtful(*node_, std::nullopt);
  command_server_->after_step(report);  // before observers_, because observers need the additions
  observers_->after_step(*node_, report);
  run_orders_.insert(run_orders_.end(), report.orders.begin(), report.orders.end());
  for (const core::Order& order : report.orders) {
    if (std::holds_alternative<core::Save>(order.action)) saving_.expect(order);
  }
  const double frame_ms = milliseconds(Clock::now() - begin);
  node_->protocol().report_frame(report.step, frame_ms / 1e3);
  frame_times_[report.step] = {frame_ms, wait_ms_};
  record(node_->confirmed());
  wait_ms_ = 0;
  computed_at_ = Clock::now();
  run_control_limits_.note(report.step, computed_at_);
  waiting_since_.reset();
  waiting_.clear();
  note(report, frame_ms);
  publish_running();
  apply_orders();
}

/// Notes a redo, which all nodes do after the same state. Observers keep the states that they have until the run has
/// computed them again.
void NodeProcess::note_redo(const node::StepReport& report) {
  const core::TogetherPair first = report.put_back_for.empty() ? core::TogetherPair{} : report.put_back_for.front();
  notice_ =
      fmt::format("put back from state {} to {} (redo {}): bodies {} and {}{} have touched on two nodes",
                  *report.put_back_from, report.step, node_->redos(), core::value_of(first.a), core::value_of(first.b),
                  report.put_back_for.size() > 1 ? fmt::format(" and {} more pairs", report.put_back_for.size() - 1)
                                                 : std::string());
  spdlog::info("region {} {}", core::value_of(options_.region), notice_);
  saving_.look_at_doubtful(*node_, report.step);
  note_words_of_saves();
  status_.redos = node_->redos();
  observers_->put_back();
  record(node_->confirmed());
  computed_at_ = Clock::now();
  publish_running();
}

void NodeProcess::execute_commands() {
  for (const messages::RunCommand& command : control_.take_commands()) execute(command);
}

}  // namespace aurasim::process
