#include "cli/node_process.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "cli/launch_setup.h"
#include "cli/stop_signal.h"
#include "core/command.h"
#include "node/durations.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kStatusPeriod = 100ms;
constexpr auto kLinger = 1500ms;
constexpr auto kListenFirst = 500ms;  // announcements come every 50 ms at first

dds::Durations summary_of(std::vector<double>& values) {
  return {node::percentile(values, 0.5), node::percentile(values, 0.99), node::percentile(values, 1)};
}

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

double milliseconds(Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

}  // namespace

dds::TransportSettings neighbour_transport(const config::Launch& launch, core::RegionId region) {
  dds::TransportSettings settings;
  settings.region = region;
  settings.neighbours = launch.regions.neighbours(region, listening_distance_m(launch));
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
      participant_(dds_settings(launch, options.region)),
      control_(participant_, {launch.regions.version(), options.region}),
      fence_(launch, participant_, control_, options.region),
      pacer_(launch.step_s(), launch.time.pace == config::Pace::kWall) {
  status_.region = options.region;
  status_.pid = static_cast<std::uint32_t>(::getpid());
  status_.map_version = launch.regions.version();
  status_.agreement = launch.agreement();
  status_.footprint = launch.regions.region(options.region);
  status_.lookahead = launch.lookahead();
  stop_at_ = options.steps;
}

ExitCode NodeProcess::run() {
  try {
    const ExitCode code = meet_and_run();
    participant_.flush_delayed();  // whoever leaves silently destroys nothing, and its last words would wait for ever
    log_impairment(participant_);
    return code;
  } catch (const std::exception& error) {
    publish(dds::NodeState::kFailed, error.what());
    throw;
  }
}

ExitCode NodeProcess::meet_and_run() {
  if (!domain_is_free()) return stop_requested() ? ExitCode::kOk : ExitCode::kRefused;
  control_.publish_map(world_map(launch_));
  publish(dds::NodeState::kStarting);
  transport_.emplace(participant_, neighbour_transport(launch_, options_.region));
  observers_.emplace(launch_, participant_, options_.region);
  command_server_.emplace(launch_, participant_, options_.region);
  if (!meet_neighbours() || !wait_for_start()) return stop_requested() ? ExitCode::kOk : ExitCode::kRefused;
  begin_generation(start_->generation, start_->epoch_ns);
  return run_steps();
}

ExitCode NodeProcess::refuse(const std::string& why) {
  spdlog::error("{}", why);
  if (transport_) publish(dds::NodeState::kFailed, why);  // before that, the region may be another process's
  return ExitCode::kRefused;
}

/// Another map, scene or setting in the same domain: the two runs would tear each other's worlds apart.
bool NodeProcess::another_run_is_here() {
  for (const auto& [version, map] : control_.maps()) {
    if (map.agreement == status_.agreement) continue;
    refuse(fmt::format(
        "DDS domain {} already has a run that does not agree with this one: scene '{}', {} regions, map {:016x}, "
        "agreement {:016x}; this is scene '{}', {} regions, map {:016x}, agreement {:016x}. Use another dds.domain.",
        launch_.dds.domain, map.scene, map.regions.size(), map.map_version, map.agreement, launch_.scene.name,
        launch_.regions.size(), status_.map_version, status_.agreement));
    return true;
  }
  return false;
}

/// Another process that is this region: the same launch twice, by mistake.
bool NodeProcess::this_region_is_taken() {
  for (const auto& [region, seen] : control_.statuses()) {
    const dds::Status& other = seen.status;
    if (region != options_.region || other.pid == status_.pid || !seen.is_live()) continue;
    if (other.agreement != status_.agreement) continue;  // its map says more
    refuse(fmt::format("region {} already has a node in DDS domain {}: process {}, step {}. Use another dds.domain.",
                       core::value_of(region), launch_.dds.domain, other.pid, other.step));
    return true;
  }
  return false;
}

/// Listens before it publishes: a node's endpoints would disturb a run that is already here.
bool NodeProcess::domain_is_free() {
  const auto begin = Clock::now();
  const auto strangers = [this] {
    const auto& statuses = control_.statuses();
    return std::any_of(statuses.begin(), statuses.end(), [this](const auto& entry) {
      return entry.second.is_live() && entry.second.status.agreement != status_.agreement;
    });
  };
  // Whoever has a status has a map, which is on its way.
  while (Clock::now() < begin + (strangers() ? 6 * kListenFirst : kListenFirst)) {
    if (stop_requested() || another_run_is_here() || this_region_is_taken()) return false;
    control_.wait(20ms);
  }
  return true;
}

bool NodeProcess::meet_neighbours() {
  const auto deadline = Clock::now() + options_.start_time_out;
  while (!transport_->all_matched()) {
    if (stop_requested() || another_run_is_here()) return false;
    if (Clock::now() > deadline) {
      try {
        transport_->wait_until_matched(0ns);
      } catch (const dds::NeighboursMissing& missing) {
        refuse(fmt::format("after {} s: {}", options_.start_time_out.count(), missing.what()));
        return false;
      }
    }
    control_.wait(50ms);
  }
  return !another_run_is_here();
}

/// The node of region 0 starts the run once every region waits for it.
void NodeProcess::start_when_all_wait() {
  if (options_.region != core::RegionId{0} || start_) return;
  std::size_t waiting = 0;
  for (const auto& [region, seen] : control_.statuses()) {
    waiting += !seen.lost && seen.status.agreement == status_.agreement &&
               seen.status.state == dds::NodeState::kWaiting && seen.status.generation == waits_to_start_ &&
               region != options_.region;
  }
  if (waiting + 1 < launch_.regions.size()) return;
  dds::RunCommand start;
  start.kind = dds::RunCommandKind::kStart;
  start.generation = waits_to_start_;
  start.epoch_ns = node::wall_clock_ns() + 500'000'000;
  start.request = control_.send(start);
  start_ = start;
}

bool NodeProcess::wait_for_start() {
  publish(dds::NodeState::kWaiting);
  const auto deadline = Clock::now() + options_.start_time_out;
  while (!start_) {
    if (stop_requested() || another_run_is_here()) return false;
    if (Clock::now() > deadline) {
      std::vector<std::uint32_t> absent;
      for (std::uint32_t r = 0; r < launch_.regions.size(); ++r) {
        if (!control_.statuses().contains(core::RegionId{r})) absent.push_back(r);
      }
      refuse(fmt::format("the run has not started in {} s; regions that have not reported: [{}]",
                         options_.start_time_out.count(), fmt::join(absent, ", ")));
      return false;
    }
    publish(dds::NodeState::kWaiting);
    start_when_all_wait();
    execute_commands();
    control_.wait(50ms);
  }
  return true;
}

void NodeProcess::begin_generation(core::Generation generation, std::int64_t epoch_ns) {
  core::Inbox mail = node_ ? std::move(node_->mail()) : core::Inbox{};
  generation_ = generation;
  node::NodeSetup setup = node_setup(launch_, options_.region, generation);
  setup.hash_states = options_.report.has_value();
  node_ = std::make_unique<node::Node>(setup, launch_.scene, launch_.regions, *transport_);
  node_->accept_early_mail(std::move(mail));
  command_server_->begin_generation(*node_, generation);
  run_orders_.clear();
  recorder_.reset();  // or it would write the rest of its rows into the files of the next
  if (options_.report) recorder_ = std::make_unique<node::Recorder>(*options_.report, options_.region);
  pacer_.set_epoch(0, epoch_ns);
  hold_at_.reset();
  paused_ = {};
  const node::StepReport& report = node_->start();
  observers_->begin_generation(generation);
  observers_->after_step(*node_, report);
  if (recorder_) recorder_->write(report, {}, *node_);
  const auto ahead = std::chrono::nanoseconds(std::max<std::int64_t>(0, epoch_ns - node::wall_clock_ns()));
  began_ = Clock::now() + ahead;
}

bool NodeProcess::finished() const {
  return stop_requested() || (stop_at_ && node_->current_step() >= *stop_at_) || fence_.closed();
}

ExitCode NodeProcess::run_steps() {
  while (!finished()) {
    execute_commands();
    serve_clients();
    reset_if_due();
    change_if_due();
    if (!wait_until_due()) continue;
    compute_step();
  }
  const double factor = real_time_factor();
  const bool fenced = fence_.closed();
  if (fenced) spdlog::error("{}", fence_.reason());
  publish(fenced ? dds::NodeState::kFailed : dds::NodeState::kFinished, fence_.reason());
  observers_->while_paused(*node_);
  // Whoever leaves from now on has finished, too: that is no death.
  const std::vector<core::RegionId> dead = node_->protocol().intake().dead_regions();
  if (!fenced) linger();
  if (recorder_ && !fenced) recorder_->write_settling(node_->settle());
  if (recorder_) recorder_->finish(*node_, {factor, fenced ? "fenced" : "finished", dead});
  return fenced ? ExitCode::kFenced : ExitCode::kOk;
}

/// True when the next state is due, allowed and everything it needs is here. Returns often, so that commands are heard.
bool NodeProcess::wait_until_due() {
  const core::Step next = node_->current_step() + 1;
  const auto begin = Clock::now();
  if (hold_at_ && node_->current_step() >= *hold_at_) {
    publish(dds::NodeState::kPaused);
    observers_->while_paused(*node_);
    control_.wait(20ms);
    node_->ready();
    fence_.open(node_->protocol());
    paused_ += Clock::now() - begin;
    return false;
  }
  const std::chrono::nanoseconds until = pacer_.until(next);
  if (until > 0ns) {
    transport_->wait_for_arrival(std::min<std::chrono::nanoseconds>(until, 20ms));
    node_->ready();
    return false;
  }
  const bool complete = node_->ready();
  if (fence_.open(node_->protocol()) && complete) return true;
  transport_->wait_for_arrival(20ms);
  wait_ms_ += milliseconds(Clock::now() - begin);
  publish_running();
  return false;
}

void NodeProcess::compute_step() {
  const auto begin = Clock::now();
  const node::StepReport& report = node_->step();
  observers_->after_step(*node_, report);
  command_server_->after_step(report);
  run_orders_.insert(run_orders_.end(), report.orders.begin(), report.orders.end());
  const double frame_ms = milliseconds(Clock::now() - begin);
  node_->protocol().report_frame(report.step, frame_ms / 1e3);
  if (recorder_) recorder_->write(report, {frame_ms, wait_ms_}, *node_);
  wait_ms_ = 0;
  note(report, frame_ms);
  publish_running();
  apply_orders();
}

void NodeProcess::note(const node::StepReport& report, double frame_ms) {
  if (Clock::now() - window_.begin > 1s) window_ = {};
  window_.frame.push_back(frame_ms);
  window_.physics.push_back(1e3 * report.durations.physics_s);
  window_.protocol.push_back(1e3 * report.durations.protocol_s);
  window_.transport.push_back(1e3 * report.durations.transport_s);
  status_.bodies = report.bodies;
  status_.awake = report.awake;
  status_.foreign_auras = report.foreign_auras;
  status_.largest_cluster = report.largest_cluster;
  status_.hand_offs_out += report.departures.size();
  status_.hand_offs_in += report.arrivals.size();
}

void NodeProcess::publish_running() {
  if (Clock::now() - last_published_ < kStatusPeriod) return;
  const core::ViolationLog& log = node_->protocol().violations();
  status_.violations = {log.count(core::ViolationKind::kSpeed), log.count(core::ViolationKind::kLatency),
                        log.count(core::ViolationKind::kFrame), log.count(core::ViolationKind::kPromise),
                        log.count(core::ViolationKind::kSpan)};
  status_.frame = summary_of(window_.frame);
  status_.physics = summary_of(window_.physics);
  status_.protocol = summary_of(window_.protocol);
  status_.transport = summary_of(window_.transport);
  status_.real_time_factor = real_time_factor();
  status_.dead = node_->protocol().intake().dead_regions();
  publish(dds::NodeState::kRunning);
}

void NodeProcess::publish(dds::NodeState state, const std::string& text) {
  const auto now = Clock::now();
  if (state == status_.state && now - last_published_ < kStatusPeriod) return;
  last_published_ = now;
  status_.state = state;
  status_.text = text;
  status_.generation = generation_;
  status_.step = node_ ? node_->current_step() : 0;
  control_.publish_status(status_);
}

double NodeProcess::real_time_factor() const {
  const double wall_s = std::chrono::duration<double>(Clock::now() - began_ - paused_).count();
  return wall_s > 0 ? static_cast<double>(node_->current_step()) * launch_.step_s() / wall_s : 1;
}

void NodeProcess::execute_commands() {
  for (const dds::RunCommand& command : control_.take_commands()) execute(command);
}

void NodeProcess::execute(const dds::RunCommand& command) {
  using Kind = dds::RunCommandKind;
  if (command.kind == Kind::kStart) {
    if (!start_ && command.generation == waits_to_start_) start_ = command;
    return;
  }
  if (command.generation != generation_ || !node_) return;  // for a run that is over
  switch (command.kind) {
    case Kind::kStart:
      break;
    case Kind::kPause:
      hold_at_ = command.at_step;
      break;
    case Kind::kStep:
      if (hold_at_) {
        pacer_.set_epoch(*hold_at_ + 1, command.epoch_ns);
        hold_at_ = *hold_at_ + command.count;
      }
      break;
    case Kind::kResume:
      if (hold_at_) pacer_.set_epoch(*hold_at_ + 1, command.epoch_ns);
      hold_at_.reset();
      break;
    case Kind::kReset:
      reset_ = command;
      break;
    case Kind::kStop:
      stop_at_ = std::min(stop_at_.value_or(command.at_step), command.at_step);
      break;
  }
}

void NodeProcess::reset_if_due() {
  if (!reset_ || node_->current_step() < reset_->at_step) return;
  const dds::RunCommand reset = *reset_;
  reset_.reset();
  begin_generation(reset.generation + 1, reset.epoch_ns);
}

/// The others may still need what was published last, and we their acknowledgements.
void NodeProcess::linger() {
  const auto deadline = Clock::now() + kLinger;
  const auto all_done = [this] {
    const auto& statuses = control_.statuses();
    return node_->ready_to_settle() && std::all_of(statuses.begin(), statuses.end(), [](const auto& entry) {
             return entry.second.lost || entry.second.status.state == dds::NodeState::kFinished;
           });
  };
  while (Clock::now() < deadline && !all_done()) control_.wait(10ms);
}

}  // namespace aurasim::cli
