#include "launch/launcher.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>

#include "cut/kept_on_disk.h"
#include "cut/saved_world.h"
#include "host/spawn.h"
#include "host/stop_signal.h"
#include "host/terminal.h"
#include "launch/closing_line.h"
#include "launch/merged_report.h"
#include "records/report.h"
#include "setup/guard_log.h"
#include "setup/key_choice.h"
#include "setup/launch_setup.h"

namespace aurasim::launch {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kShowEvery = 250ms;
constexpr auto kSayThatWeWait = 2s;
constexpr int kMostDeaths = 3;  // deaths in a row of one region's nodes, near one state
constexpr auto kPatienceWithDrained = 5s;
constexpr auto kOnePress = 500ms;  // `timeout` and some shells signal a process twice

}  // namespace

Launcher::Launcher(const config::Launch& launch, const setup::LaunchOptions& options)
    : launch_(launch),
      options_(options),
      participant_(setup::with_keys(setup::dds_settings(launch), launch,
                                    setup::member_for(launch, options.keys.as, {security::Role::kOperator}))),
      control_(
          participant_,
          {launch.regions.version(), {}, launch.agreement(), run_, static_cast<std::uint32_t>(launch.regions.size())}) {
  options_.heartbeat = heartbeats_.words();
  hub_.keep(setup::hub_command_line(options_), participant_.settings());
}

Launcher::~Launcher() {
  signal_all(SIGKILL);
  for (Child& child : children_) {
    if (child.running) ::waitpid(child.pid, nullptr, 0);
    if (child.successor != 0) ::waitpid(child.successor, nullptr, 0);
  }
  for (const pid_t spare : spares_) ::waitpid(spare, nullptr, 0);
}

command_line::ExitCode Launcher::run() {
  host::catch_stop_signals();
  start_nodes();
  if (!options_.headless || !options_.recording.empty()) viewer_.start(options_.files, options_.recording);
  auto next_show = Clock::now();
  while (any_running()) {
    control_.wait(20ms);
    hub_.look(Clock::now());
    look_at_nodes();
    hear_commands();
    end_hung_nodes();
    tell_long_steps();
    collect_exits();
    if (!stopping_ && all_go_on()) keep_spares();
    if (has_to_stop() && !stopping_) {
      stopping_ = true;
      stop_all();
    }
    if (Clock::now() < next_show) continue;
    next_show = Clock::now() + (view_.is_terminal() ? kShowEvery : 4 * kShowEvery);
    show();
  }
  for (const pid_t spare : spares_) ::kill(spare, SIGKILL);  // a spare has no work to finish
  for (const pid_t spare : spares_) ::waitpid(spare, nullptr, 0);
  spares_.clear();
  show();
  viewer_.stop();
  hub_.stop();
  return conclude();
}

/// Locks the report folder. Throws when another run writes there, because its records would be lost.
void Launcher::take_report_folder() {
  if (!options_.report) return;
  report_folder_.emplace(*options_.report);
  records::clear_report(*options_.report);
  records::reserve_summary(*options_.report);
}

void Launcher::start_nodes() {
  take_report_folder();
  for (std::uint32_t r = 0; r < launch_.regions.size(); ++r) {
    Child child;
    child.region = core::RegionId{r};
    child.pid = start_node(child.region, setup::Start::kWithOthers);
    children_.push_back(child);
  }
  start_watch_.emplace(children_.size(), std::chrono::seconds(options_.start_time_out_s), Clock::now());
  keep_spares();
}

/// True if no region waits for its node. Spares are not started in a recovery: each new process has to meet all others,
/// and with keys that is more work than the recovery.
bool Launcher::all_go_on() {
  return std::ranges::all_of(children_, [this](const Child& child) {
    if (!child.running) return true;
    const messages::SeenStatus* const seen = said_by(child);
    if (seen == nullptr || child.successor != 0) return !has_begun_;
    const messages::NodeState state = seen->status.state;
    return state != messages::NodeState::kRecovering && state != messages::NodeState::kSpare;
  });
}

void Launcher::keep_spares() {
  std::erase_if(spares_, [](pid_t spare) { return ::waitpid(spare, nullptr, WNOHANG) == spare; });
  while (std::cmp_less(spares_.size(), options_.spares)) {
    spares_.push_back(host::spawn(setup::spare_command_line(launch_, options_, run_)));
  }
}

/// Process that takes the child's region over: a spare, or a new process.
pid_t Launcher::successor_of(const Child& child) {
  for (const messages::Status& spare : control_.spares()) {
    const auto ours = std::ranges::find(spares_, static_cast<pid_t>(spare.pid));
    if (ours == spares_.end()) continue;
    control_.send(steering::about_process(messages::RunCommandKind::kTake, run_, child.region, spare.process));
    const pid_t pid = *ours;
    spares_.erase(ours);
    return pid;
  }
  return start_node(child.region, setup::Start::kTakeOver);
}

pid_t Launcher::start_node(core::RegionId region, setup::Start start) const {
  return host::spawn(setup::node_command_line(launch_, options_, run_, region, start));
}

void Launcher::look_at_nodes() {
  for (const auto& [region, seen] : control_.statuses()) {
    const messages::NodeState state = seen.status.state;
    has_begun_ = has_begun_ || state == messages::NodeState::kRunning || state == messages::NodeState::kPaused ||
                 state == messages::NodeState::kFinished;
  }
  if (has_begun_ || cannot_begin_) return;
  const std::optional<std::string> problem = start_watch_->problem(control_.statuses(), Clock::now());
  cannot_begin_ = problem.has_value();
  if (problem) spdlog::error("{}", *problem);
}

/// Receives commands. A drain may name a process that has just begun and is not known here yet, so it is kept for a
/// while.
void Launcher::hear_commands() {
  const auto now = Clock::now();
  for (messages::RunCommand& command : control_.take_commands()) {
    if (command.kind == messages::RunCommandKind::kDrain) drains_.push_back({std::move(command), now});
  }
  if (stopping_) drains_.clear();
  std::erase_if(drains_, [&](const Drain& drain) {
    return begin_drain(drain.command) || now > drain.heard + kPatienceWithDrained;
  });
}

/// Gives a node that is to leave a successor first. False if no child is the named process.
bool Launcher::begin_drain(const messages::RunCommand& drain) {
  for (Child& child : children_) {
    const messages::SeenStatus* const seen = said_by(child);
    if (seen == nullptr || seen->status.process != drain.process || !child.running) continue;
    if (child.successor == 0) child.successor = successor_of(child);
    return true;
  }
  return false;
}

void Launcher::collect_exits() {
  for (Child& child : children_) {
    int status = 0;
    if (child.successor != 0 && ::waitpid(child.successor, &status, WNOHANG) == child.successor) child.successor = 0;
    if (!child.running || ::waitpid(child.pid, &status, WNOHANG) != child.pid) continue;
    note_exit(child, status);
    if (has_finished(child)) end_successor(child);
    if (child.successor != 0) {
      if (!child.died) tell_lost(child);
      child.pid = std::exchange(child.successor, 0);
      child.running = true;
      child.died = false;
    } else if (can_be_replaced(child)) {
      if (somebody_knows_the_world()) {
        replace(child);
      } else {
        must_not_go_on_ = true;
        spdlog::error("{}", cut::world_is_lost(cut::folders_of_run(launch_, options_.save, run_),
                                               {launch_.world_identity(), {run_}, cut::launch_command(launch_)}));
      }
    }
  }
}

/// True if the child has ended because the run has, and has not left its region to another process.
bool Launcher::has_finished(const Child& child) {
  const messages::SeenStatus* const seen = said_by(child);
  return child.exit_code == 0 && seen != nullptr && seen->status.state == messages::NodeState::kFinished;
}

void Launcher::end_successor(Child& child) {
  if (child.successor == 0) return;
  ::kill(child.successor, SIGKILL);  // a spare has no work to finish
  ::waitpid(child.successor, nullptr, 0);
  child.successor = 0;
}

/// Publishes that a child is lost, because DDS would need a second to notice.
void Launcher::tell_lost(const Child& child) {
  const messages::SeenStatus* const seen = said_by(child);
  if (seen == nullptr) return;
  const std::uint64_t process = seen->status.process;
  control_.hold_for_dead(process);
  control_.send(steering::about_process(messages::RunCommandKind::kLost, run_, child.region, process));
}

/// The child's status. Null if it has none yet; its region's status may still be of the process before.
const messages::SeenStatus* Launcher::said_by(const Child& child) {
  const auto& statuses = control_.statuses();
  const auto seen = statuses.find(child.region);
  const bool is_its_own = seen != statuses.end() && seen->second.status.pid == static_cast<std::uint32_t>(child.pid);
  return is_its_own ? &seen->second : nullptr;
}

void Launcher::note_exit(Child& child, int status) {
  child.running = false;
  child.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (child.told_to_end && child.exit_code == 128 + SIGINT) child.exit_code = 0;  // signalled before its handler
  const bool refused = child.exit_code == static_cast<int>(command_line::ExitCode::kRefused);
  child.died = command_line::is_death(child.exit_code);
  if (child.died) {
    spdlog::error("the node of region {} died (exit code {}){}", core::value_of(child.region), child.exit_code,
                  has_begun_ ? "" : " before the run had begun: the launcher ends the other nodes");
    tell_lost(child);
    if (has_begun_ && launch_.survival.on_death == config::OnDeath::kStop) break_off("survival.on_death is stop");
  }
  must_not_go_on_ = must_not_go_on_ || child.exit_code == static_cast<int>(command_line::ExitCode::kBrokenOff);
  // Without all nodes the run cannot start, and the others need not wait for their time-out.
  cannot_begin_ = cannot_begin_ || refused || (!has_begun_ && child.exit_code != 0);
}

/// Ends the run before its time, and names the newest saved world on this host.
void Launcher::break_off(const std::string& why) {
  must_not_go_on_ = true;
  spdlog::error("the run ends: {}. {}", why,
                cut::say_newest_saved(cut::folders_of_run(launch_, options_.save, run_),
                                      {launch_.world_identity(), {run_}, cut::launch_command(launch_)}));
}

/// True if the others wait for a process that takes the child's region over.
bool Launcher::can_be_replaced(const Child& child) const {
  const bool all_wait = std::ranges::all_of(
      children_, [](const Child& other) { return other.running || other.died; });  // and none has finished
  return child.died && has_begun_ && all_wait && !stopping_ && !has_to_stop() && children_.size() > 1 &&
         launch_.survival.on_death == config::OnDeath::kRecover;
}

/// True if any child knows the world. Otherwise all have only come to take regions over.
bool Launcher::somebody_knows_the_world() {
  return std::ranges::any_of(children_, [this](const Child& child) {
    const messages::SeenStatus* const seen = said_by(child);
    return child.running && seen != nullptr && seen->status.state != messages::NodeState::kSpare;
  });
}

void Launcher::replace(Child& child) {
  const core::Step step = farthest_step();
  const bool at_the_same_place = std::abs(step - child.died_at) <= launch_.checkpoint_steps();
  child.deaths = at_the_same_place ? child.deaths + 1 : 1;
  child.died_at = step;
  if (child.deaths > kMostDeaths) {
    return break_off(
        fmt::format("the node of region {} has died {} times in a row near state {}, and is not started again",
                    core::value_of(child.region), child.deaths, child.died_at));
  }
  child.pid = successor_of(child);
  child.running = true;
  child.died = false;
  spdlog::info("the node of region {} is started again: process {}", core::value_of(child.region), child.pid);
}

/// The farthest state in the nodes' statuses.
core::Step Launcher::farthest_step() {
  core::Step step = 0;
  for (const auto& [region, seen] : control_.statuses()) step = std::max(step, seen.status.step);
  return step;
}

/// True if the user asks to stop, the terminal is closed, or the run cannot begin or go on.
bool Launcher::has_to_stop() const { return host::stop_requested() || !is_seen_ || cannot_begin_ || must_not_go_on_; }

bool Launcher::any_running() const {
  return std::any_of(children_.begin(), children_.end(), [](const Child& c) { return c.running; });
}

void Launcher::signal_all(int signal) {
  for (const pid_t spare : spares_) ::kill(spare, signal);
  for (Child& child : children_) {
    if (child.successor != 0) ::kill(child.successor, signal);
    if (!child.running) continue;
    child.told_to_end = child.told_to_end || signal == SIGINT;
    ::kill(child.pid, signal);
  }
}

/// Stops all nodes at the same state, so that every body can be accounted for. Nodes that do not react get signals.
void Launcher::stop_all() {
  steering::RunSteering steering(launch_, control_);
  if (has_begun_ && steering.find_run(0ms)) {
    steering.send(messages::RunCommandKind::kStop);
  } else {
    signal_all(SIGINT);
  }
  const auto begin = Clock::now();
  std::vector<process::NodeEnding> endings(children_.size(), process::NodeEnding(begin, children_.size()));
  int presses = host::stop_requests();
  bool said = false;
  while (any_running()) {
    control_.wait(20ms);
    collect_exits();
    const auto now = Clock::now();
    if (now - begin < kOnePress) presses = host::stop_requests();
    if (host::stop_requests() > presses) signal_all(SIGKILL);
    for (std::size_t i = 0; i < children_.size(); ++i) urge(children_[i], endings[i]);
    if (said || now - begin < kSayThatWeWait || !any_running()) continue;
    said = true;
    spdlog::warn("waiting for the nodes of regions [{}] to end; Ctrl-C once more kills them",
                 fmt::join(running_regions(), ", "));
  }
}

void Launcher::urge(Child& child, process::NodeEnding& ending) {
  if (!child.running) return;
  const auto& statuses = control_.statuses();
  const auto seen = statuses.find(child.region);
  const process::Urge urge = ending.urge(Clock::now(), seen == statuses.end() ? nullptr : &seen->second);
  if (urge == process::Urge::kNone) return;
  child.told_to_end = true;
  ::kill(child.pid, urge == process::Urge::kKill ? SIGKILL : SIGINT);
}

std::vector<std::uint32_t> Launcher::running_regions() const {
  std::vector<std::uint32_t> regions;
  for (const Child& child : children_) {
    if (child.running) regions.push_back(core::value_of(child.region));
  }
  return regions;
}

void Launcher::show() {
  viewer_.look();
  setup::log_new_refusals(participant_);
  if (options_.headless) return;
  is_seen_ = view_.show(live_table(control_.statuses(), view_.size(), Clock::now()) + viewer_.said()) && is_seen_;
}

command_line::ExitCode Launcher::conclude() {
  setup::log_refusals(participant_);
  const bool recording_broke_off = viewer_.has_ended_early() && !options_.recording.empty();
  command_line::ExitCode code = recording_broke_off ? command_line::ExitCode::kFailed : command_line::ExitCode::kOk;
  for (const Child& child : children_) {
    if (child.died) code = command_line::ExitCode::kFailed;
    if (!child.died && child.exit_code != 0 && code == command_line::ExitCode::kOk)
      code = static_cast<command_line::ExitCode>(child.exit_code);
  }
  if (!options_.report) {
    host::print(closing_line(control_.statuses(), children_.size(), has_begun_, launch_.step_s()));
    return code;
  }
  if (code == command_line::ExitCode::kRefused || !records::has_records(*options_.report)) {
    spdlog::warn("there is no report, because the run has not begun");
    records::clear_report(*options_.report);
    return code;
  }
  return report_and_count(code);
}

command_line::ExitCode Launcher::report_and_count(command_line::ExitCode so_far) {
  records::RunFacts facts;
  facts.regions = children_.size();
  facts.step_s = launch_.step_s();
  for (const Child& child : children_) {
    if (child.died) facts.died.push_back(child.region);
  }
  return merge_and_print(*options_.report, facts, so_far);
}

}  // namespace aurasim::launch
