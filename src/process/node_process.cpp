#include "process/node_process.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "dds/random_id.h"
#include "host/stop_signal.h"
#include "process/long_step.h"
#include "setup/launch_setup.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

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

messages::Status identity_of_node(const config::Launch& launch, const NodeOptions& options) {
  messages::Status status;
  status.region = options.region;
  status.run = options.run;
  status.pid = static_cast<std::uint32_t>(::getpid());
  status.process = dds::draw_id();
  status.map_version = launch.regions.version();
  status.agreement = launch.agreement();
  status.footprint = launch.regions.region(options.region);
  status.lookahead = launch.lookahead();
  return status;
}

double milliseconds(Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

}  // namespace

NodeProcess::NodeProcess(const config::Launch& launch, const NodeOptions& options)
    : launch_(launch),
      options_(options),
      endpoints_(launch_, options_),
      fence_(fence_settings(), [this] { return endpoints_.peer_signs(); }),
      saving_(launch_, options_),
      records_(options.report, options.region),
      notices_(options.region, node::read_clocks()),
      status_(identity_of_node(launch, options), Clock::now()),
      schedule_(launch.step_s(), launch.time.pace == config::Pace::kWall, options.steps),
      start_(options.region, launch.regions.size()),
      leaving_(options.region, status_.content().process),
      recovery_(recovery_settings(launch, options, !endpoints_.stays_on_this_host())) {}

FenceSettings NodeProcess::fence_settings() const {
  FenceSettings settings;
  settings.region = options_.region;
  settings.regions = static_cast<std::uint32_t>(launch_.regions.size());
  settings.can_be_cut = !endpoints_.stays_on_this_host();
  settings.never_waits = launch_.time.sync == core::SyncMode::kFreeRunning;
  return settings;
}

bool NodeProcess::fence_is_open() { return fence_.open(node_->protocol().intake().dead_regions(), Clock::now()); }

command_line::ExitCode NodeProcess::run() {
  try {
    const command_line::ExitCode code = meet_and_run();
    endpoints_.flush();
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
  endpoints_.open(transport_settings());
  if (!meet_neighbours() || !wait_for_start()) return not_begun();
  for (const std::string& text : wrong_clocks(control().statuses(), endpoints_.stays_on_this_host())) {
    spdlog::warn("{}", text);
  }
  begin_generation(start_.start()->generation, *start_.start());
  return run_steps();
}

bool NodeProcess::comes_back_as_spare() const {
  return fence_.closed() && !options_.has_launcher && launch_.survival.on_death == config::OnDeath::kRecover;
}

/// Takes over the region of a dead node. The other nodes wait in a recovery.
command_line::ExitCode NodeProcess::take_over() {
  endpoints_.open_checkpoints();
  recover("takes the region over");
  if (fence_.closed()) return refuse(fence_.reason());
  if (!node_ && restoration_.is_broken_off()) return end_without_world();
  return node_ ? run_steps() : not_begun();
}

dds::TransportSettings NodeProcess::transport_settings() {
  dds::TransportSettings settings = neighbour_transport(launch_, options_.region);
  settings.life = life_;
  settings.is_busy = [this](core::RegionId region) {
    const auto seen = control().statuses().find(region);
    return seen != control().statuses().end() && long_step(seen->second, Clock::now());
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
  if (options_.world) endpoints_.commands().bring(options_.world->meshes);
  return std::make_unique<node::Node>(setup, launch_.scene, launch_.regions, transport());
}

void NodeProcess::begin_generation(core::Generation generation, const messages::RunCommand& begin) {
  core::Inbox mail = node_ ? std::move(node_->mail()) : core::Inbox{};
  generation_ = status_.content().era = generation;
  checkpoints().begin_era(generation);
  node_ = make_node();
  node_->accept_early_mail(std::move(mail));
  endpoints_.commands().begin_generation(*node_, generation);
  records_.begin();
  schedule_.begin_world(first_step(), begin, node::read_clocks());
  setpoints_.begin_world();
  begin_with(options_.world ? node_->start(*options_.world) : node_->start());
  schedule_.note_begun(first_step(), Clock::now());
}

/// To be called when the first state of a generation is there.
void NodeProcess::begin_with(const node::StepReport& report) {
  changes_.begin_world();
  restoration_.begin_world();
  commands_.begin(node_->current_step(), Clock::now());
  if (recovers()) host::let_sigterm_ask_to_leave(options_.has_launcher);
  notices_.begin_refusals();
  records_.forget_frames();
  saving_.begin(start_.start()->request, generation_, node_->current_step());
  if (launch_.regions.size() > 1) checkpoints().use_keepers(keepers(), life_);
  endpoints_.observers().begin_generation(generation_);
  endpoints_.observers().after_step(*node_, report);
  record(node_->confirmed());
  endpoints_.commands().after_step(report);
  saving_.plan_checkpoint(*node_);
}

void NodeProcess::record(std::span<const node::StepReport> reports) {
  for (const node::StepReport& report : reports) {
    notices_.note_removals(report.removals);
    setpoints_.note_unbearable(report.unbearable);
    if (!report.put_back_from) saving_.note_recorded(report.step);
    records_.write(report);
  }
}

command_line::ExitCode NodeProcess::run_steps() {
  for (;;) {
    try {
      run_until_end();
      const bool leaves = leaves_now() || (leaving_.has_begun() && can_leave_to_others());
      return leaves && !restoration_.is_broken_off() ? leave_to_successor() : end();
    } catch (const SomebodyDied& died) {
      if (recovers()) {
        recover(died.what());
      } else {
        break_off(died.what());
      }
      if (!node_ && restoration_.is_broken_off()) return end_without_world();
    }
  }
}

void NodeProcess::run_until_end() {
  while (!finished() && !leaves_now()) {
    leave_if_asked();
    execute_early_commands();
    execute_commands();
    look_for_deaths();
    execute_late_commands();
    serve_clients();
    keep_parts();
    if (reset_if_due() || change_if_due()) continue;
    endpoints_.publish_ros2(*node_, generation_);
    take_setpoints();
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
  if (schedule_.holds_at()) schedule_.follow(farthest_pause(control().statuses(), generation_), begin);
  if (schedule_.is_held_in(node_->current_step())) {
    wait_in_pause();
    schedule_.note_pause(Clock::now() - begin);
    return false;
  }
  if (phase_ == NodePhase::kPaused) enter(NodeEvent::kGoesOn);
  if (!has_awaited_setpoints()) {
    control().wait(20ms);
    return false;
  }
  if (const std::chrono::nanoseconds until = schedule_.time_until(next, node::read_clocks()); until > 0ns) {
    transport().wait_for_arrival(std::min<std::chrono::nanoseconds>(until, 20ms));
    node_->ready();
    publish_running();
    return false;
  }
  const bool complete = node_->ready();
  status_.content().refused = transport().refused();
  notices_.note_refusals(node_->protocol().intake().refusals());
  if (fence_is_open() && complete) return true;
  transport().wait_for_arrival(20ms);
  records_.note_wait(milliseconds(Clock::now() - begin));
  note_waiting();
  publish_running();
  return false;
}

/// Waits a moment in the state in which the run is paused.
void NodeProcess::wait_in_pause() {
  if (phase_ != NodePhase::kPaused) enter(NodeEvent::kHeld);
  publish();
  node_->ready();
  endpoints_.observers().while_paused(*node_);
  // Observers wait for the states of bodies that are under way to this node.
  if (node_->has_all_until(node_->current_step())) {
    control().wait(20ms);
  } else {
    transport().wait_for_arrival(2ms);
  }
  fence_is_open();
}

void NodeProcess::compute_step() {
  const auto is_gone = [](const auto& entry) { return entry.second.lost && entry.second.has_ended(); };
  if (std::ranges::any_of(control().statuses(), is_gone)) node_->give_up_redo();
  const auto begin = Clock::now();
  keep_the_end();
  const node::StepReport& report = node_->step();
  control().note_state();
  endpoints_.programs().note_state();
  if (report.put_back_from) return note_redo(report);
  saving_.look_at_doubtful(*node_, std::nullopt);
  endpoints_.commands().after_step(report);  // before observers_, because observers need the additions
  endpoints_.observers().after_step(*node_, report);
  changes_.add(report.orders);
  for (const core::Order& order : report.orders) {
    if (std::holds_alternative<core::Save>(order.action)) saving_.expect(order);
  }
  const double frame_ms = milliseconds(Clock::now() - begin);
  node_->protocol().report_frame(report.step, frame_ms / 1e3);
  records_.note_frame(report.step, frame_ms);
  record(node_->confirmed());
  const auto now = Clock::now();
  schedule_.note_computed(now);
  commands_.note(report.step, now);
  notices_.note_computed();
  status_.note_step(report, frame_ms, now);
  publish_running();
  take_reached_changes();
}

/// Notes a redo, which all nodes do after the same state. Observers keep the states that they have until the run has
/// computed them again.
void NodeProcess::note_redo(const node::StepReport& report) {
  const core::TogetherPair first = report.put_back_for.empty() ? core::TogetherPair{} : report.put_back_for.front();
  const std::string news =
      fmt::format("put back from state {} to {} (redo {}): bodies {} and {}{} have touched on two nodes",
                  *report.put_back_from, report.step, node_->redos(), core::value_of(first.a), core::value_of(first.b),
                  report.put_back_for.size() > 1 ? fmt::format(" and {} more pairs", report.put_back_for.size() - 1)
                                                 : std::string());
  spdlog::info("region {} {}", core::value_of(options_.region), news);
  notices_.note_news(news);
  saving_.look_at_doubtful(*node_, report.step);
  note_words_of_saves();
  status_.content().redos = node_->redos();
  endpoints_.observers().put_back();
  record(node_->confirmed());
  schedule_.note_computed(Clock::now());
  publish_running();
}

/// Gives the setpoints that have come to the node; they take effect in the next state. To be called before each state,
/// and often in between. Every node receives all setpoints.
void NodeProcess::take_setpoints() {
  setpoints_.take(endpoints_.take_setpoints(generation_), endpoints_.refused_setpoints(), node_->current_step(),
                  [this](const core::Setpoints& setpoints) { return node_->hear(setpoints); });
}

/// True if all setpoints that step commands name have been received. No node computes the state before.
bool NodeProcess::has_awaited_setpoints() {
  return setpoints_.has_all_awaited(
      [this](const core::ProgramWord& word) { return endpoints_.programs().has_heard(word); },
      node_->current_step() + 1, Clock::now());
}

/// Logs the regions that this node waits for, if it has waited long.
void NodeProcess::note_waiting() {
  const auto now = Clock::now();
  if (!notices_.waits_for_long(now)) return;
  const core::Step next = node_->current_step() + 1;
  std::vector<MissingRegion> missing;
  for (const core::RegionId region : node_->protocol().missing(next)) {
    const auto other = control().statuses().find(region);
    const bool is_known = other != control().statuses().end();
    missing.push_back({region, is_known ? long_step(other->second, now) : std::nullopt, status_.refused_of(region)});
  }
  notices_.note_missing(next, missing, now);
}

}  // namespace aurasim::process
