#include "process/recovering_phase.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "config/launch_variants.h"
#include "cut/saved_world.h"
#include "dds/link_mtu.h"
#include "host/stop_signal.h"
#include "process/restore_plan.h"
#include "process/world_gathering.h"
#include "steering/run_steering.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kInRecovery = 5ms;
constexpr auto kPatienceWithParts = 10s;

}  // namespace

void RecoveringPhase::recover(const std::string& why) {
  spdlog::warn("region {} stands at state {}: {}", core::value_of(run_.options.region), run_.present_step(), why);
  begin_to_recover();
  while (!host::stop_requested() && !run_.fence.closed() && !run_.restoration.is_broken_off()) {
    run_.enter(run_.node ? NodeEvent::kDeath : NodeEvent::kJoins);
    run_.restoration.begin_attempt(run_.generation);
    try {
      if (agree_on_restore()) go_back();
      return;
    } catch (const SomebodyDied& again) {
      spdlog::warn("region {}: {}, once more", core::value_of(run_.options.region), again.what());
    }
  }
}

/// Begins to wait for a recovery. A change of the run that had begun is dropped; its client has to ask again.
void RecoveringPhase::begin_to_recover() {
  const auto now = Clock::now();
  run_.restoration.begin(now);
  run_.recovery.begin(now);
  run_.fence.watch_closely();
  if (auto before = run_.changes.drop()) {
    run_.launch = std::move(before->launch);
    run_.options.world = std::move(before->world);
  }
  run_.records.forget_frames();
}

/// Waits until all nodes agree on a state to go back to. False when the run ends, or this node has to leave it.
bool RecoveringPhase::agree_on_restore() {
  while (!run_.restoration.is_agreed(run_.generation)) {
    if (run_.restoration.is_broken_off()) return false;
    if (host::stop_requested() || run_.restoration.is_stopped(Clock::now())) return false;
    succession_.leave_if_asked();
    if (succession_.leaves_in_vain()) return false;
    if (run_.node) run_.node->ready();
    const bool may_go_on = !run_.node || run_.fence_is_open();
    if (run_.fence.closed()) return false;
    const SeenNodes nodes = run_.nodes_and_self();
    if (!run_.node && has_to_leave_recovery(nodes)) return false;
    const RecoveryActs acts = run_.recovery.look(run_.recovery_view(nodes, may_go_on), Clock::now());
    if (acts.replaced_in && run_.node) {
      run_.give_way(*acts.replaced_in);
      return false;
    }
    if (acts.gives_up) {
      give_up(acts.vacant);
      return false;
    }
    run_.status.note_unreachable(
        unreachable_regions(nodes, run_.options.region, static_cast<std::uint32_t>(run_.launch.regions.size())));
    run_.publish(what_recovery_waits_for(run_.fence.is_cut_off(), run_.restoration.question(), acts.vacant,
                                         run_.status.content().dead));
    execute(acts);
    if (may_go_on && run_.node) lead_recovery();
    executor_.execute_commands();
    run_.control().wait(kInRecovery);
  }
  run_.restoration.forget_question();
  return true;
}

/// Executes what this node has to do for regions without a node, and joins DDS anew where some others do not
/// receive from it.
void RecoveringPhase::execute(const RecoveryActs& acts) {
  const auto& interfaces = run_.endpoints.participant().settings().interfaces;
  if (acts.meets_anew && dds::all_links_are_up(dds::interfaces_of_this_host(), interfaces)) join_anew();
  for (const core::RegionId region : acts.stand_ins) {
    spdlog::warn("nobody has taken region {} over: this host does, beside region {}", core::value_of(region),
                 core::value_of(run_.options.region));
    succession_.spawn_successor(region);
  }
  for (const core::RegionId region : acts.call_spares) succession_.call_spare(region);
}

/// Leaves DDS and joins it again as a new participant, with the world that this node has (Recovery::meets_anew).
void RecoveringPhase::join_anew() {
  spdlog::warn(
      "region {}: some other nodes do not receive from this node, or it receives from too few of them: it leaves DDS "
      "and joins it again",
      core::value_of(run_.options.region));
  run_.endpoints.join_anew(run_.transport_settings());
  if (run_.node) run_.publish_map(run_.generation, run_.first_step());
  run_.publish();
}

/// True if this process has come to take a region over and is not needed. Throws when no process knows the world.
bool RecoveringPhase::has_to_leave_recovery(const SeenNodes& nodes) {
  if (run_.recovery.is_not_needed(nodes, Clock::now())) return true;
  if (run_.recovery.nobody_knows_the_world(nodes, Clock::now()))
    throw std::runtime_error(cut::world_is_lost(run_.saving.folders(), run_.saving.saved_by()));
  return false;
}

/// Ends the run because no process has come for these regions, after all attempts. All nodes end with the same reason.
void RecoveringPhase::give_up(const std::vector<core::RegionId>& vacant) {
  for (const core::RegionId region : vacant) {
    run_.control().send(steering::about_process(messages::RunCommandKind::kEnd, run_.options.run, region, 0));
  }
  run_.break_off(nobody_takes_over(vacant));
}

/// Sends the restore command once each region has a process. The lowest region that knows the world sends it.
void RecoveringPhase::lead_recovery() {
  const SeenNodes nodes = run_.nodes_and_self();
  run_.recovery.note_kept(nodes, run_.status.content().era);
  const std::optional<RestorePlan> plan = plan_restore(nodes, run_.launch.regions.size());
  if (!plan || plan->lead != run_.options.region) return;
  messages::RunCommand restore = plan->command;
  restore.generation = std::max(restore.generation, run_.restoration.newest(run_.generation) + 1);
  if (restore.count == 1 && !may_begin_again(restore.era)) return;
  if (restore.count == 1) restore.at_step = run_.first_step();
  restore.epoch_ns = run_.schedule.epoch_of(restore.at_step, node::read_clocks());
  run_.send_restore(restore);
}

/// True if the run may begin again from the first state because no state is kept whole. If no later state was ever kept
/// whole, nothing is lost. Otherwise a user has to decide, because the missing part may be on a host that is down.
bool RecoveringPhase::may_begin_again(core::Generation era) {
  if (run_.recovery.may_begin_again(era)) return true;
  if (run_.schedule.has_reset()) {
    spdlog::warn("region {}: all nodes begin again from state {}, because a reset command asks for it",
                 core::value_of(run_.options.region), run_.first_step());
    run_.schedule.take_reset();
    return true;
  }
  const std::string question = fmt::format(
      "nobody keeps all parts of a state, though state {} was kept. Start the processes that had them again, or begin "
      "again from state {} with `aurasim send reset`. {}",
      *run_.recovery.kept(), run_.first_step(), cut::say_newest_saved(run_.saving.folders(), run_.saving.saved_by()));
  if (run_.restoration.ask(question))
    spdlog::error("region {} stands: {}", core::value_of(run_.options.region), question);
  return false;
}

/// Goes back to the state that the newest restore names. Throws SomebodyDied when a node dies meanwhile.
void RecoveringPhase::go_back() {
  run_.restoration.go_back();
  const messages::RunCommand restore = *run_.restoration.restore();
  take_map_of(restore);
  WorldGathering gathering({run_.launch, run_.options, run_.saving, run_.checkpoints(), run_.node.get()}, restore);
  auto deadline = Clock::now() + kPatienceWithParts;
  gathering.send_parts();
  while (!gathering.has_all_parts()) wait_in_recovery(deadline, "the parts of the world");
  gathering.send_orders();
  while (!gathering.has_all_orders()) wait_in_recovery(deadline, "the orders that others know");
  const core::WorldCut world = gathering.take_world();
  run_.start.await(restore.generation);
  deadline = Clock::now() + kPatienceWithParts;
  run_.begin_to_connect(run_.transport_settings());
  while (const char* const missing = run_.go_on_connecting()) wait_in_recovery(deadline, missing);
  run_.begin_restored(restore, world, gathering.parts());
  run_.restoration.finish();
}

/// Takes the scene and the regions that the run goes on with from the published map, and the exchange from the other
/// nodes' statuses.
void RecoveringPhase::take_map_of(const messages::RunCommand& restore) {
  const messages::WorldMap* map = nullptr;
  const auto deadline = Clock::now() + kPatienceWithParts;
  while (map == nullptr) {
    for (const auto& [version, known] : run_.control().maps()) {
      const bool agrees = known.agreement == run_.status.content().agreement;
      if (known.generation == restore.generation && agrees) map = &known;
    }
    if (map == nullptr) wait_in_recovery(deadline, "the map");
  }
  for (run_.take_exchange_of_others(); run_.launch.exchange == config::Exchange::kAuto;
       run_.take_exchange_of_others()) {
    wait_in_recovery(deadline, "the exchange that the others have chosen");
  }
  if (map->scene != run_.launch.scene.name) run_.launch = config::with_scene(run_.launch, map->scene);
  if (map->map_version != run_.launch.regions.version()) run_.launch = config::with_regions(run_.launch, map->regions);
  run_.status.use_regions(run_.launch);
  run_.control().use_map(run_.launch.regions.version());
  run_.endpoints.open_ros2();
  run_.endpoints.serve_map();
}

void RecoveringPhase::wait_in_recovery(Clock::time_point deadline, const char* for_what) {
  if (host::stop_requested()) throw SomebodyDied("the process was asked to stop");
  if (run_.fence.closed()) throw SomebodyDied(run_.fence.reason());
  if (run_.restoration.is_broken_off()) throw SomebodyDied(run_.restoration.why_broken_off());
  if (Clock::now() > deadline) throw SomebodyDied(fmt::format("waited in vain for {}", for_what));
  executor_.execute_commands();
  run_.look_for_deaths();
  run_.publish();
  run_.control().wait(kInRecovery);
}

}  // namespace aurasim::process
