// What the nodes do when one of them has died: all wait until a process has taken its region over, and agree on the
// state to go back to (docs/design.md, "When a node dies"). How they go back is in node_process_restore.cpp.
#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
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
/// Time for which a stop does not break off a recovery. One that is about to succeed ends first, and all stop together
/// soon after it.
constexpr auto kShortStand = 5s;

}  // namespace

void NodeProcess::recover(const std::string& why) {
  spdlog::warn("region {} stands at state {}: {}", core::value_of(options_.region),
               node_ ? node_->current_step() : first_step(), why);
  begin_to_recover();
  while (!host::stop_requested() && !fence_.closed() && broken_off_.empty()) {
    enter(node_ ? NodeEvent::kDeath : NodeEvent::kJoins);
    stands_in_ = std::max(generation_, restoring_);
    is_going_back_ = false;
    try {
      if (!agree_on_restore()) return;
      go_back(*restore_);
      return;
    } catch (const SomebodyDied& again) {
      spdlog::warn("region {}: {}, once more", core::value_of(options_.region), again.what());
    }
  }
}

/// Begins to wait for a recovery. A change of the run that had begun is dropped; its client has to ask again.
void NodeProcess::begin_to_recover() {
  recovering_since_ = Clock::now();
  recovery_.begin(recovering_since_);
  stops_standing_ = false;
  fence_.watch_closely();
  if (before_change_) {
    launch_ = std::move(before_change_->launch);
    options_.world = std::move(before_change_->world);
    before_change_.reset();
  }
  run_orders_.clear();
  change_.reset();
  records_.forget_frames();
}

/// Waits until all nodes agree on a state to go back to. False when the run ends, or this node has to leave it.
bool NodeProcess::agree_on_restore() {
  while (!restore_ || restore_->generation <= std::max(generation_, restoring_)) {
    if (!broken_off_.empty()) return false;
    if (host::stop_requested() || (stops_standing_ && Clock::now() > recovering_since_ + kShortStand)) return false;
    leave_if_asked();
    if (leaves_by_ && Clock::now() > *leaves_by_) return false;
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
    note_unheard(nodes);
    publish(what_recovery_waits_for(acts.vacant));
    if (acts.meets_anew &&
        dds::all_links_are_up(dds::interfaces_of_this_host(), endpoints_.participant().settings().interfaces)) {
      meet_anew();
    }
    stand_in(acts.stand_ins);
    for (const core::RegionId region : acts.call_spares) call_spare(region);
    if (may_go_on && node_) lead_recovery();
    execute_commands();
    control().wait(kInRecovery);
  }
  asks_for_.clear();
  return true;
}

/// Publishes the regions that this node does not receive from, at once when they change. The others wait for a node
/// that does not receive from all.
void NodeProcess::note_unheard(const SeenNodes& nodes) {
  status_.note_unheard(unheard_regions(nodes, options_.region, static_cast<std::uint32_t>(launch_.regions.size())));
}

/// Leaves DDS and joins it again as a new participant, with the world that this node has (Recovery::meets_anew).
void NodeProcess::meet_anew() {
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
  return {nodes,
          leaving_,
          status_.content().process,
          node_ != nullptr,
          may_go_on,
          fence_.is_cut_off(),
          node_ ? node_->current_step() : first_step()};
}

/// The statuses of all nodes, with this node's own as the others see it.
SeenNodes NodeProcess::nodes_and_self() {
  SeenNodes nodes = control().statuses();
  nodes[options_.region].status = status_.content();
  return nodes;
}

std::string NodeProcess::what_recovery_waits_for(const std::vector<core::RegionId>& vacant) {
  if (fence_.is_cut_off()) return "hears too few of the others, and waits for them";
  if (!asks_for_.empty()) return asks_for_;
  std::vector<std::uint32_t> regions;
  for (const core::RegionId region : vacant) regions.push_back(core::value_of(region));
  if (!regions.empty()) return fmt::format("waits for whoever takes over regions [{}]", fmt::join(regions, ", "));
  for (const core::RegionId region : status_.content().dead) regions.push_back(core::value_of(region));
  if (!regions.empty()) return fmt::format("does not hear regions [{}], which others hear", fmt::join(regions, ", "));
  return "waits until all others stand";
}

/// Ends the run because no process has come for these regions, after all attempts. All nodes end with the same reason.
void NodeProcess::give_up(const std::vector<core::RegionId>& vacant) {
  for (const core::RegionId region : vacant) {
    control().send(steering::about_process(messages::RunCommandKind::kEnd, options_.run, region, 0));
  }
  std::vector<std::uint32_t> regions;
  for (const core::RegionId region : vacant) regions.push_back(core::value_of(region));
  break_off(fmt::format("nobody takes over regions [{}], whose nodes have died", fmt::join(regions, ", ")));
}

/// Ends the run on this node before its time, and names the newest saved world.
void NodeProcess::break_off(const std::string& why) {
  if (!broken_off_.empty()) return;
  broken_off_ = why;
  spdlog::error("region {}: the run ends in state {}: {}. {}", core::value_of(options_.region),
                node_ ? node_->current_step() : first_step(), why,
                cut::say_newest_saved(saving_.folders(), saving_.saved_by()));
}

/// Sends the restore command once each region has a process. The lowest region that knows the world sends it.
void NodeProcess::lead_recovery() {
  const SeenNodes nodes = nodes_and_self();
  recovery_.note_kept(nodes, status_.content().era);
  std::optional<RestorePlan> plan = plan_restore(nodes, launch_.regions.size());
  if (!plan || plan->lead != options_.region) return;
  messages::RunCommand restore = plan->command;
  restore.generation = std::max(restore.generation, std::max(generation_, restoring_) + 1);
  if (restore.count == 1 && !may_begin_again(restore.era)) return;
  if (restore.count == 1) restore.at_step = first_step();
  restore.run = options_.run;
  restore.region = options_.region;
  const node::Instant now = node::read_clocks();
  restore.epoch_ns = now.wall_ns + std::chrono::nanoseconds(pacer_.due(restore.at_step) - now.steady).count();
  restore.rate = pacer_.rate();
  publish_map(restore.generation, restore.at_step);
  restore.request = control().send(restore);
  restore_ = restore;
  repeat_commands(restore);
}

/// True if the run may begin again from the first state because no state is kept whole. If no later state was ever kept
/// whole, nothing is lost. Otherwise a user has to decide, because the missing part may be on a host that is down.
bool NodeProcess::may_begin_again(core::Generation era) {
  if (recovery_.may_begin_again(era)) return true;
  if (reset_) {
    spdlog::warn("region {}: all begin again from state {}, as they were told to", core::value_of(options_.region),
                 first_step());
    reset_.reset();
    return true;
  }
  const std::string asks = fmt::format(
      "nobody keeps all parts of a state, though state {} was kept. Start the processes that had them again, or begin "
      "again from state {} with `aurasim send reset`. {}",
      *recovery_.kept(), first_step(), cut::say_newest_saved(saving_.folders(), saving_.saved_by()));
  if (asks != asks_for_) spdlog::error("region {} stands: {}", core::value_of(options_.region), asks);
  asks_for_ = asks;
  return false;
}

/// Receives a restore command. It names the processes that go on, so this process may be left out of the run.
void NodeProcess::hear_of_restore(const messages::RunCommand& restore) {
  if (restore.members.size() != launch_.regions.size()) return;
  const core::Generation begun = node_ ? generation_ : 0;
  const core::Generation known = std::max({generation_, restoring_, restore_ ? restore_->generation : 0});
  const RestoreMeaning meaning = meaning_of(restore, options_.region, status_.content().process, begun, known);
  if (meaning == RestoreMeaning::kGoBack) restore_ = with_clock_of(restore.region, restore);
  if (meaning == RestoreMeaning::kLeftOut) recovery_.note_left_out(restore);
  if (meaning == RestoreMeaning::kReplaced && node_) give_way(restore.at_step);
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

/// Sends pause and reset commands again. A process that takes a region over has not received the pause, and the other
/// nodes would drop the reset.
void NodeProcess::repeat_commands(const messages::RunCommand& restore) {
  messages::RunCommand command;
  command.generation = restore.generation;
  command.run = options_.run;
  const auto repeat = [&](messages::RunCommandKind kind, core::Step at_step) {
    command.kind = kind;
    command.at_step = at_step;
    command.request = 0;
    control().send(command);
  };
  if (reset_) repeat(messages::RunCommandKind::kReset, std::max(reset_->at_step, restore.at_step));
  if (hold_at_) repeat(messages::RunCommandKind::kPause, *hold_at_);
  if (stop_at_) repeat(messages::RunCommandKind::kStop, *stop_at_);
}

}  // namespace aurasim::process
