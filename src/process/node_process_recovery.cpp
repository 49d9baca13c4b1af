// What the nodes do when one of them has died: all wait until a process has taken its region over, and agree on the
// state to go back to (docs/design.md, "When a node dies"). How they go back is in node_process_restore.cpp; the
// decisions are in recovery.h, restoration.h and restore_plan.h.
#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cut/saved_world.h"
#include "dds/link_mtu.h"
#include "host/stop_signal.h"
#include "process/node_process.h"
#include "process/restore_plan.h"
#include "steering/run_steering.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kInRecovery = 5ms;

}  // namespace

/// Why this node must not compute its next state (why_stand).
std::optional<std::string> NodeProcess::death() {
  if (launch_.regions.size() == 1) return std::nullopt;
  // In any other case node_ is from before the death, and its silent neighbours are known already.
  const bool is_running = restoration_.computes_in(generation_) && node_ && life_of_node_ == life_;
  std::vector<core::RegionId> silent;
  if (is_running) silent = node_->protocol().intake().dead_regions();
  return why_stand(control().statuses(), restoration_.own_world(options_.region, generation_, std::move(silent)));
}

/// To be called while all wait for each other. Throws SomebodyDied if a node has died.
void NodeProcess::look_for_deaths() {
  if (const auto why = death()) throw SomebodyDied(*why);
}

void NodeProcess::recover(const std::string& why) {
  spdlog::warn("region {} stands at state {}: {}", core::value_of(options_.region), present_step(), why);
  begin_to_recover();
  while (!host::stop_requested() && !fence_.closed() && !restoration_.is_broken_off()) {
    enter(node_ ? NodeEvent::kDeath : NodeEvent::kJoins);
    restoration_.begin_attempt(generation_);
    try {
      if (agree_on_restore()) go_back();
      return;
    } catch (const SomebodyDied& again) {
      spdlog::warn("region {}: {}, once more", core::value_of(options_.region), again.what());
    }
  }
}

/// Begins to wait for a recovery. A change of the run that had begun is dropped; its client has to ask again.
void NodeProcess::begin_to_recover() {
  const auto now = Clock::now();
  restoration_.begin(now);
  recovery_.begin(now);
  fence_.watch_closely();
  if (auto before = changes_.drop()) {
    launch_ = std::move(before->launch);
    options_.world = std::move(before->world);
  }
  records_.forget_frames();
}

/// Waits until all nodes agree on a state to go back to. False when the run ends, or this node has to leave it.
bool NodeProcess::agree_on_restore() {
  while (!restoration_.is_agreed(generation_)) {
    if (restoration_.is_broken_off()) return false;
    if (host::stop_requested() || restoration_.is_stopped(Clock::now())) return false;
    leave_if_asked();
    if (leaving_.is_overdue(Clock::now())) return false;
    if (node_) node_->ready();
    const bool may_go_on = !node_ || fence_is_open();
    if (fence_.closed()) return false;
    const SeenNodes nodes = nodes_and_self();
    if (!node_ && has_to_leave_recovery(nodes)) return false;
    const RecoveryActs acts = recovery_.look(recovery_view(nodes, may_go_on), Clock::now());
    if (acts.replaced_in && node_) {
      give_way(*acts.replaced_in);
      return false;
    }
    if (acts.gives_up) {
      give_up(acts.vacant);
      return false;
    }
    status_.note_unheard(unheard_regions(nodes, options_.region, static_cast<std::uint32_t>(launch_.regions.size())));
    publish(what_recovery_waits_for(fence_.is_cut_off(), restoration_.question(), acts.vacant, status_.content().dead));
    execute(acts);
    if (may_go_on && node_) lead_recovery();
    execute_commands();
    control().wait(kInRecovery);
  }
  restoration_.forget_question();
  return true;
}

/// Executes what this node has to do for regions without a node, and joins DDS anew where some others do not hear it.
void NodeProcess::execute(const RecoveryActs& acts) {
  const auto& interfaces = endpoints_.participant().settings().interfaces;
  if (acts.meets_anew && dds::all_links_are_up(dds::interfaces_of_this_host(), interfaces)) join_anew();
  for (const core::RegionId region : acts.stand_ins) {
    spdlog::warn("nobody has taken region {} over: this host does, beside region {}", core::value_of(region),
                 core::value_of(options_.region));
    spawn_successor(region);
  }
  for (const core::RegionId region : acts.call_spares) call_spare(region);
}

/// Leaves DDS and joins it again as a new participant, with the world that this node has (Recovery::meets_anew).
void NodeProcess::join_anew() {
  spdlog::warn("region {}: some others do not hear this node, or it hears too few of them: it joins DDS anew",
               core::value_of(options_.region));
  endpoints_.join_anew(transport_settings());
  if (node_) publish_map(generation_, first_step());
  publish();
}

/// True if this process has come to take a region over and is not needed. Throws when no process knows the world.
bool NodeProcess::has_to_leave_recovery(const SeenNodes& nodes) {
  if (recovery_.is_not_needed(nodes, Clock::now())) return true;
  if (recovery_.nobody_knows_the_world(nodes, Clock::now()))
    throw std::runtime_error(cut::world_is_lost(saving_.folders(), saving_.saved_by()));
  return false;
}

RecoveryView NodeProcess::recovery_view(const SeenNodes& nodes, bool may_go_on) const {
  return {
      nodes,         leaving_.processes(), status_.content().process, node_ != nullptr, may_go_on, fence_.is_cut_off(),
      present_step()};
}

/// The statuses of all nodes, with this node's own as the others see it.
SeenNodes NodeProcess::nodes_and_self() {
  SeenNodes nodes = control().statuses();
  nodes[options_.region].status = status_.content();
  return nodes;
}

/// Ends the run because no process has come for these regions, after all attempts. All nodes end with the same reason.
void NodeProcess::give_up(const std::vector<core::RegionId>& vacant) {
  for (const core::RegionId region : vacant) {
    control().send(steering::about_process(messages::RunCommandKind::kEnd, options_.run, region, 0));
  }
  break_off(nobody_takes_over(vacant));
}

/// Ends the run on this node before its time, and names the newest saved world.
void NodeProcess::break_off(const std::string& why) {
  if (!restoration_.break_off(why)) return;
  spdlog::error("region {}: the run ends in state {}: {}. {}", core::value_of(options_.region), present_step(), why,
                cut::say_newest_saved(saving_.folders(), saving_.saved_by()));
}

/// Sends the restore command once each region has a process. The lowest region that knows the world sends it.
void NodeProcess::lead_recovery() {
  const SeenNodes nodes = nodes_and_self();
  recovery_.note_kept(nodes, status_.content().era);
  const std::optional<RestorePlan> plan = plan_restore(nodes, launch_.regions.size());
  if (!plan || plan->lead != options_.region) return;
  messages::RunCommand restore = plan->command;
  restore.generation = std::max(restore.generation, restoration_.newest(generation_) + 1);
  if (restore.count == 1 && !may_begin_again(restore.era)) return;
  if (restore.count == 1) restore.at_step = first_step();
  restore.epoch_ns = schedule_.epoch_of(restore.at_step, node::read_clocks());
  send_restore(restore);
}

/// Sends a restore command to all nodes and accepts it here, and sends the commands that it would undo once more.
void NodeProcess::send_restore(messages::RunCommand restore) {
  restore.run = options_.run;
  restore.region = options_.region;
  restore.rate = schedule_.rate();
  publish_map(restore.generation, restore.at_step);
  restore.request = control().send(restore);
  restoration_.use(restore);
  for (const messages::RunCommand& command : schedule_.commands_to_repeat(restore)) control().send(command);
}

/// True if the run may begin again from the first state because no state is kept whole. If no later state was ever kept
/// whole, nothing is lost. Otherwise a user has to decide, because the missing part may be on a host that is down.
bool NodeProcess::may_begin_again(core::Generation era) {
  if (recovery_.may_begin_again(era)) return true;
  if (schedule_.has_reset()) {
    spdlog::warn("region {}: all begin again from state {}, as they were told to", core::value_of(options_.region),
                 first_step());
    schedule_.take_reset();
    return true;
  }
  const std::string question = fmt::format(
      "nobody keeps all parts of a state, though state {} was kept. Start the processes that had them again, or begin "
      "again from state {} with `aurasim send reset`. {}",
      *recovery_.kept(), first_step(), cut::say_newest_saved(saving_.folders(), saving_.saved_by()));
  if (restoration_.ask(question)) spdlog::error("region {} stands: {}", core::value_of(options_.region), question);
  return false;
}

/// Executes a restore command. It names the processes that go on, so this process may be left out of the run.
void NodeProcess::execute_restore(const messages::RunCommand& restore) {
  if (restore.members.size() != launch_.regions.size()) return;
  const core::Generation begun = node_ ? generation_ : 0;
  switch (restoration_.meaning(restore, options_.region, status_.content().process, generation_, begun)) {
    case RestoreMeaning::kNothing:
      break;
    case RestoreMeaning::kGoBack:
      restoration_.use(with_clock_of(control().statuses(), restore.region, restore));
      break;
    case RestoreMeaning::kLeftOut:
      recovery_.note_left_out(restore);
      break;
    case RestoreMeaning::kReplaced:
      if (node_) give_way(restore.at_step);
      break;
  }
}

/// Closes the fence, because another process has this region since state `step`.
void NodeProcess::give_way(core::Step step) {
  fence_.close(
      fmt::format("another process has taken over region {} in state {}", core::value_of(options_.region), step));
  throw_away_after(step);
}

/// Drops the states after `step` that this process has computed and recorded alone. The run's world went on without
/// them.
void NodeProcess::throw_away_after(core::Step step) {
  if (node_->current_step() > step) {
    spdlog::warn("region {}: states {} to {} of this process are thrown away", core::value_of(options_.region),
                 step + 1, node_->current_step());
  }
  if (records_.is_replaced()) return records_.close();
  record_after(step);
}

}  // namespace aurasim::process
